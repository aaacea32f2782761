#include "scene/recorded.h"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "devices/log.h"
#include "devices/sources.h"
#include "scene/player.h"

namespace headpin::scene {

Recorded load_trial(const std::string& path, Time longest_gap) {
  Recorded recorded{devices::read_trial(path, longest_gap), {}};
  recorded.scenario = scenario_of_trial(recorded.trial.header.scenario, path);
  if (recorded.trial.samples.empty()) {
    throw std::runtime_error(path + ": expected samples of a tracker, found none");
  }
  return recorded;
}

std::int64_t tick_count(const devices::Trial& trial, std::int64_t rate_hz) {
  Time end{};
  for (const devices::Sample& sample : trial.samples) end = std::max(end, available(sample));
  std::int64_t ticks = end.count() / 1'000'000 * rate_hz;
  while (tick_time(ticks, rate_hz) < end) ++ticks;
  if (!trial.states.empty()) ticks = std::max(ticks, trial.states.back().tick);
  return ticks;
}

Pose first_head_pose(const devices::Trial& trial, const Rig& rig) {
  for (const devices::Sample& sample : trial.samples) {
    const auto* tracker = std::get_if<devices::TrackerSample>(&sample);
    if (tracker && tracker->station == rig.head_station && tracker->good()) {
      return sensor_in_world(*tracker, rig) * rig.X_SD;
    }
  }
  throw std::runtime_error(
      fmt::format("expected samples of the head (station {}), found none", rig.head_station));
}

}  // namespace headpin::scene
