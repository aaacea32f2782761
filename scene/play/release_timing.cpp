#include "scene/play/release_timing.h"

#include <algorithm>
#include <span>

#include "scene/play/hand.h"
#include "scene/play/player.h"
#include "scene/play/release.h"
#include "scene/record/events.h"

namespace headpin::scene {

namespace {

constexpr Time kAround{500'000};

using Track = std::vector<Stamped<Pose>>;

/// X_PH of the samples that are needed for a release at one of these times.
Track hand_around(const TrialFile& trial, const Rig& rig, const std::vector<Time>& times,
                  Time before) {
  Track track;
  trial.walk([&](const TrialFile::Item& item) {
    const auto* sample = std::get_if<devices::Sample>(&item);
    const auto* hand = sample ? std::get_if<devices::TrackerSample>(sample) : nullptr;
    if (!hand || hand->station != rig.hand_station || !hand->places_hand()) return true;
    const Time time = hand->device_time;
    const bool matters = std::ranges::any_of(
        times, [&](Time t) { return time >= t - before && time <= t + kAround; });
    const bool later = track.empty() || time > track.back().time;
    if (matters && later) track.push_back({time, sensor_in_space(*hand, rig) * rig.X_SH});
    return true;
  });
  return track;
}

/// The fastest of the samples around a release.
ReleaseTiming at_samples(const Track& track, Time time, const Scenario& scenario) {
  const ReleaseWindow window = release_window(scenario.hand);
  ReleaseTiming timing{.release = time};
  for (std::size_t i = 1; i < track.size(); ++i) {
    // Poses are used `rig.delay_s` after they were measured.
    const Time at = track[i].time + microseconds(scenario.rig.delay_s);
    if (at < time - kAround || at > time + kAround) continue;
    if (track[i - 1].time < track[i].time - window.longest()) continue;
    const double speed =
        release_velocity(std::span(track).first(i + 1), scenario.hand.grip, window).v.norm();
    if (speed > timing.fastest_speed) timing = {time, at, speed};
  }
  return timing;
}

/// The fastest of the milliseconds around a release at which the hand was tracked, each with the
/// samples that a release at that time uses.
ReleaseTiming at_milliseconds(const Track& track, Time time, const Scenario& scenario) {
  const Rig& rig = scenario.rig;
  const ReleaseWindow window = release_window(scenario.hand);
  ReleaseTiming timing{.release = time};
  for (Time at = time - kAround; at <= time + kAround; at += Time{1000}) {
    const Time measured = at - microseconds(rig.delay_s);
    if (motion_at(track, measured, scenario.hand.grip, window).known != Known::tracked) continue;
    const Time last = told_until(measured, rig.delay_s + rig.predicted_s);
    const auto end = std::ranges::upper_bound(track, last, {}, &Stamped<Pose>::time);
    const double speed =
        motion_at(std::span(track.begin(), end), measured, scenario.hand.grip, window)
            .V_WB.v.norm();
    if (speed > timing.fastest_speed) timing = {time, at, speed};
  }
  return timing;
}

}  // namespace

std::vector<ReleaseTiming> release_timings(const TrialFile& trial, const Scenario& scenario) {
  std::vector<Time> times;
  for (const Event& event : trial.summary().events) {
    if (event.kind == kind::release) times.push_back(event.time);
  }
  if (times.empty()) return {};
  const ReleaseWindow window = release_window(scenario.hand);
  const Track track = hand_around(trial, scenario.rig, times,
                                  kAround + microseconds(scenario.rig.delay_s) + window.longest());
  std::vector<ReleaseTiming> found;
  for (const Time time : times) {
    const ReleaseTiming timing = scenario.hand.release_at == ReleaseAt::trigger
                                     ? at_milliseconds(track, time, scenario)
                                     : at_samples(track, time, scenario);
    if (timing.fastest_speed > 0.0) found.push_back(timing);
  }
  return found;
}

}  // namespace headpin::scene
