#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "devices/trial/file.h"
#include "scene/scenario/scenario.h"

/// A recorded trial, ready to be simulated again.
namespace headpin::scene {

struct Recorded {
  devices::TrialFile file;
  Scenario scenario;  ///< the trial's own, read
};

/// @param longest_gap  see devices::read_trial
/// @throws std::runtime_error     naming the file, for one that cannot be read or holds no samples
/// @throws std::invalid_argument  as parse_scenario
Recorded load_trial(const std::string& path, Time longest_gap = devices::kLongestGap);
/// The same from the bytes of a log, which must outlive it.
///
/// @param name  for messages
Recorded load_trial(std::span<const std::uint8_t> bytes, const std::string& name,
                    Time longest_gap = devices::kLongestGap);

/// Ticks from the first one to that at which the last sample is known, or to the last one the trial
/// recorded, whichever is later.
///
/// @param rate_hz  of the simulation
std::int64_t tick_count(const devices::TrialSummary& trial, std::int64_t rate_hz);

/// Where a walk by the thumbs has the tracked space, from the time of each tick in which that changes.
///
/// @return  p_WP, oldest first; where it was at 0 comes first
/// @throws std::runtime_error  as load_trial, and when the file is another by now
std::vector<Stamped<Vec3>> walk_of(const devices::TrialFile& trial, const Scenario& scenario);

/// X_WD where the first good sample of the head finds it: where it is taken to be until then.
///
/// @throws std::runtime_error  without one
Pose first_head_pose(const devices::TrialFile& trial, const Rig& rig);

}  // namespace headpin::scene
