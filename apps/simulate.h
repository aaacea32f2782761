#pragma once

#include <functional>
#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "devices/trial.h"
#include "scene/session.h"

/// Runs a trial's samples through a session, as every command that replays does.
namespace headpin::apps {

/// Reads a trial and its scenario.
/// @throws std::runtime_error  naming the file, for one that cannot be read or holds no samples
struct LoadedTrial {
  devices::Trial trial;
  scene::Scenario scenario;
};
LoadedTrial load_trial(const std::string& path);

/// Runs from the first tick to the one at which the last sample is known, or to the last one the
/// trial recorded, whichever is later.
///
/// @param each_tick  called after every tick
void simulate(scene::Session& session, const devices::Trial& trial,
              const std::function<void(const scene::Session&)>& each_tick);

/// How many ticks `simulate` makes of a trial.
std::int64_t tick_count(const devices::Trial& trial, const scene::Scenario& scenario);

/// Compares a state with a recorded one of the same tick: every bit of every body.
/// @return  the body that differs, empty when only what the log leaves out does; nothing when equal
std::optional<std::string> first_different_body(const devices::TickState& a,
                                                const devices::TickState& b,
                                                const std::vector<std::string>& names);

/// Holds a run against the states that a trial recorded.
class Verifier {
 public:
  /// @param trial  must outlive it
  /// @throws std::runtime_error  when the trial holds no states
  Verifier(const devices::Trial& trial, const scene::Session& session);

  /// @throws std::runtime_error  naming the tick, and the first body that differs
  void compare(const devices::TickState& state);

  std::int64_t compared() const { return compared_; }  ///< ticks found equal

 private:
  const std::vector<devices::TickState>& states_;
  std::vector<std::string> names_;
  std::size_t next_ = 0;
  std::int64_t compared_ = 0;
};

/// Elasticity or friction of all objects: a number where they agree, else one per object.
nlohmann::json common_value(const scene::Materials& materials,
                            double scene::Material::*coefficient);

}  // namespace headpin::apps
