#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "scene/record/file.h"
#include "scene/scenario/scenario.h"

/// A recorded trial, ready to be simulated again.
namespace headpin::scene {

struct Recorded {
  TrialFile file;
  Scenario scenario;             ///< the trial's own, read; whoever replays it may change it
  std::int64_t recorded_hz = 0;  ///< ticks per second when it was recorded

  /// The number of ticks of a replay under `scenario`, or at another rate: tick_count().
  std::int64_t ticks() const { return ticks(scenario.rates.physics_hz); }
  std::int64_t ticks(std::int64_t rate_hz) const;
};

/// @param longest_gap  see read_trial
/// @throws std::runtime_error     naming the file, for one that cannot be read or holds no samples
/// @throws std::invalid_argument  as parse_scenario
Recorded load_trial(const std::string& path, Time longest_gap = devices::kLongestGap);
/// The same from the bytes of a log, which must outlive it.
///
/// @param name  for messages
Recorded load_trial(std::span<const std::uint8_t> bytes, const std::string& name,
                    Time longest_gap = devices::kLongestGap);

/// The number of the first tick that is not before `end`.
std::int64_t ticks_until(Time end, std::int64_t rate_hz);

/// The number of ticks up to the last sample, to the last recorded tick, or to where an event says that the
/// session ended, whichever is latest.
///
/// @param rate_hz      of the simulation
/// @param recorded_hz  of the trial, where it is another one
std::int64_t tick_count(const TrialSummary& trial, std::int64_t rate_hz, std::int64_t recorded_hz);
std::int64_t tick_count(const TrialSummary& trial, std::int64_t rate_hz);

/// The time of the last of these ticks, at the rate of the recording.
Time end_of(const TrialSummary& trial, std::int64_t recorded_hz);

/// The place of the tracked space after walking with the thumb buttons, at each tick in which it
/// changes.
///
/// @return  p_WP, oldest first; the first entry is for time 0
/// @throws std::runtime_error  as load_trial, and when the file is another by now
std::vector<Stamped<Vec3>> walk_of(const TrialFile& trial, const Scenario& scenario);

/// The same as a function of time, for TableRows. It gives nothing if the trial's scenario
/// cannot be read.
///
/// @param path  name of the trial, for messages
/// @throws std::runtime_error  as walk_of
std::function<std::optional<Vec3>(Time)> walk_in_time(const TrialFile& trial,
                                                      const std::string& path);

/// The first tick at which a replay knows a pose of the head; one after the last if none does.
///
/// @throws std::runtime_error  as walk_of
std::int64_t first_tick_with_head(const TrialFile& trial, const Scenario& scenario);

/// X_WD at the first good sample of the head, which is used until then.
///
/// @throws std::runtime_error  without one
Pose first_head_pose(const TrialFile& trial, const Rig& rig);

}  // namespace headpin::scene
