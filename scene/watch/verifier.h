#pragma once

#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "scene/play/run.h"
#include "scene/record/file.h"

namespace headpin::scene {

/// Compares a state with a recorded one of the same tick: every bit of every body.
/// @return  the body that differs; empty if only parts differ that the log does not store; nothing
///          if equal
std::optional<std::string> first_different_body(const TickState& a, const TickState& b,
                                                std::span<const std::string> names);

/// The bodies that two sessions have in common, by name, and those that only one of them has.
struct SharedBodies {
  std::vector<std::string> names;
  std::vector<std::size_t> in_a, in_b;  ///< their numbers, as `names`
  std::vector<std::string> only_in_a, only_in_b;

  bool all() const { return only_in_a.empty() && only_in_b.empty(); }
};
SharedBodies shared_bodies(std::span<const std::string> a, std::span<const std::string> b);

/// Like first_different_body, for the common bodies.
std::optional<std::string> first_different_body(const TickState& a, const TickState& b,
                                                const SharedBodies& shared);

/// A run differs from the recording.
struct Differs : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Compares a run with the recorded states of a trial.
class Verifier : public Observer {
 public:
  /// @param trial     its name, for errors
  /// @param recorded  with the states beside it; must outlive this
  /// @throws std::runtime_error  when there are none
  Verifier(std::string trial, TrialPlayer& recorded, const Session& session);

  /// @throws Differs  naming the trial, the tick, and the first body that differs
  void tick(const Session& session) override;

  /// Compares what is known at the end: the game hash and the number of states. A complete recording may
  /// end before its last samples; an incomplete one has lost states.
  ///
  /// @return  ticks up to the end of the recording that have no state in it
  /// @throws Differs             when the game hash differs
  /// @throws std::runtime_error  when states are missing, except for that of the tick in which a
  ///                             recording was cut off
  std::int64_t finish(const TrialSummary& trial, const Session& session) const;

  std::int64_t compared() const { return compared_; }  ///< ticks found equal

 private:
  std::string trial_;
  TrialPlayer& recorded_;
  std::vector<std::string> names_;
  TickState state_;
  std::int64_t first_;  ///< tick before the first compared one
  std::int64_t compared_ = 0;
};

}  // namespace headpin::scene
