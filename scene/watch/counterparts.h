#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "scene/watch/recorded.h"

/// Finds the throws of one session in another one, which has the same hand movements under another
/// condition.
namespace headpin::scene {

/// A ball that was thrown.
struct ThrownBall {
  int number = 0;       ///< in its session, from 1
  std::string version;  ///< red or blue; empty where there are none
  Time time{};          ///< when it was let go
  std::int64_t tick = 0;
  std::optional<int> felled;  ///< as the rules counted it; nothing where they did not
};

/// The throws of a session, in their order.
std::vector<ThrownBall> thrown(std::span<const Event> events);

/// Whether a trial has the events of its session; one with only samples does not.
bool says_events(const TrialSummary& trial);

/// The events of a recorded session that tell its throws: those of its trial or, if it has only samples,
/// those of a simulation under the recorded condition, which ends when no ball can be thrown or counted
/// any more.
///
/// @param each_tick  called before each tick that is simulated for that
std::vector<Event> events_of(const TrialFile& file, const Scenario& scenario,
                             const std::function<void()>& each_tick = {});
inline std::vector<Event> events_of(const Recorded& recorded,
                                    const std::function<void()>& each_tick = {}) {
  return events_of(recorded.file, recorded.scenario, each_tick);
}

/// A throw that the other session does not have, with the reason.
struct Unpaired {
  ThrownBall thrown;
  std::string why;  ///< "not thrown: ...", "thrown and not counted"
};

/// The throws of `a` without a counterpart in `b`: no ball was released at that time in that
/// version, or the rules counted it only in `a`.
std::vector<Unpaired> without_counterpart(std::span<const Event> a, std::span<const Event> b);

nlohmann::json to_json(const std::vector<Unpaired>& unpaired);

/// The simulated trial, and what `--set` says, as in `--json`.
nlohmann::json whose(const std::string& path, const TrialSummary& trial,
                     const std::vector<std::string>& set);

/// The throws of a recorded session that its replay does not have, and the reverse, as in `--json`.
///
/// @param as_recorded  the trial's own scenario
/// @param same         whether the replay was under the recorded condition
/// @param again        events of the replay
/// @param each_tick    as for events_of
nlohmann::json compared_throws(const TrialFile& file, const Scenario& as_recorded, bool same,
                               std::span<const Event> again,
                               const std::function<void()>& each_tick);

/// One of them: "throw 7 (red, 63.200 s): not thrown: the hand closed on nothing".
std::string unpaired_in_words(const nlohmann::json& unpaired);

}  // namespace headpin::scene
