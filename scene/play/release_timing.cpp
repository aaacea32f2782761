#include "scene/play/release_timing.h"

#include <algorithm>
#include <span>

#include "scene/play/hand.h"
#include "scene/play/player.h"
#include "scene/play/release.h"
#include "scene/play/score.h"
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

/// Whether a trial has a press of a thumb button, with which one walks.
bool walks(const TrialFile& trial) {
  bool found = false;
  trial.walk([&](const TrialFile::Item& item) {
    const auto* sample = std::get_if<devices::Sample>(&item);
    const auto* mouse = sample ? std::get_if<devices::MouseSample>(sample) : nullptr;
    found = mouse && (mouse->left_thumb || mouse->right_thumb);
    return !found;
  });
  return found;
}

/// v_WP, the velocity of walking, at the ticks around these times at which it is another.
std::vector<Stamped<Vec3>> walk_around(const TrialFile& trial, const Scenario& scenario,
                                       const std::vector<Time>& times) {
  std::vector<Stamped<Vec3>> all = {{Time{}, Vec3::Zero()}};
  if (!walks(trial)) return all;
  const Time around = kAround + tick_time(1, scenario.rates.physics_hz);
  const Time until = std::min(*std::ranges::max_element(times) + around, trial.summary().end);
  TrialPlayer source(trial);
  Player player;
  std::vector<devices::Sample> samples;
  for (std::int64_t tick = 1;; ++tick) {
    const Time time = tick_time(tick, scenario.rates.physics_hz);
    if (time > until) return all;
    const Time measured = time - microseconds(scenario.rig.delay_s);
    samples.clear();
    source.poll(time, samples);
    follow(player, samples, scenario, measured);
    forget(player, measured);
    const bool matters = std::ranges::any_of(
        times, [&](Time t) { return time >= t - around && time <= t + around; });
    if (matters && player.walk.v_WP != all.back().value) all.push_back({time, player.walk.v_WP});
  }
}

/// What the fastest release of a trial is found from.
struct Throwing {
  const Scenario& scenario;
  Track hand;                       ///< X_PH
  std::vector<Stamped<Vec3>> walk;  ///< v_WP, as walk_around() has it

  /// Speed of a ball that leaves at a time a hand that moves so in the tracked space: as release() in player.cpp.
  double speed(const Vec3& v_PB, Time at) const {
    // The tick that makes a release at this time is the first one not before it.
    const std::int64_t hz = scenario.rates.physics_hz;
    const Time tick = at + tick_time(1, hz) - Time{1};
    const auto later = std::ranges::upper_bound(walk, tick, {}, &Stamped<Vec3>::time);
    const Vec3 v_WP = later == walk.begin() ? Vec3(Vec3::Zero()) : std::prev(later)->value;
    return scenario.release.speed * (v_PB + v_WP).norm();
  }
};

/// The fastest of the samples around a release.
ReleaseTiming at_samples(const Throwing& throwing, Time time) {
  const Scenario& scenario = throwing.scenario;
  const Track& track = throwing.hand;
  const ReleaseWindow window = release_window(scenario.hand);
  ReleaseTiming timing{.release = time};
  for (std::size_t i = 1; i < track.size(); ++i) {
    // Poses are used `rig.delay_s` after they were measured.
    const Time at = track[i].time + microseconds(scenario.rig.delay_s);
    if (at < time - kAround || at > time + kAround) continue;
    if (track[i - 1].time < track[i].time - window.longest()) continue;
    const double speed = throwing.speed(
        release_velocity(std::span(track).first(i + 1), scenario.hand.grip, window).v, at);
    if (speed > timing.fastest_speed) timing = {time, at, speed};
  }
  return timing;
}

/// The fastest of the milliseconds around a release at which the hand was tracked, each with the
/// samples that a release at that time uses.
ReleaseTiming at_milliseconds(const Throwing& throwing, Time time) {
  const Scenario& scenario = throwing.scenario;
  const Track& track = throwing.hand;
  const Rig& rig = scenario.rig;
  const ReleaseWindow window = release_window(scenario.hand);
  ReleaseTiming timing{.release = time};
  for (Time at = time - kAround; at <= time + kAround; at += Time{1000}) {
    const Time measured = at - microseconds(rig.delay_s);
    if (motion_at(track, measured, scenario.hand.grip, window).known != Known::tracked) continue;
    const Time last = told_until(measured, rig.delay_s + rig.predicted_s);
    const auto end = std::ranges::upper_bound(track, last, {}, &Stamped<Pose>::time);
    const std::span told(track.begin(), end);
    const double speed =
        throwing.speed(motion_at(told, measured, scenario.hand.grip, window).V_WB.v, at);
    if (speed > timing.fastest_speed) timing = {time, at, speed};
  }
  return timing;
}

}  // namespace

std::vector<ReleaseTiming> release_timings(const TrialFile& trial, const Scenario& scenario) {
  std::vector<Time> times;
  for (const Event& event : trial.summary().events) {
    if (event.kind == kind::release && is_of_ball(event)) times.push_back(event.time);
  }
  if (times.empty()) return {};
  const ReleaseWindow window = release_window(scenario.hand);
  const Throwing throwing{
      scenario,
      hand_around(trial, scenario.rig, times,
                  kAround + microseconds(scenario.rig.delay_s) + window.longest()),
      walk_around(trial, scenario, times)};
  std::vector<ReleaseTiming> found;
  for (const Time time : times) {
    const ReleaseTiming timing = scenario.hand.release_at == ReleaseAt::trigger
                                     ? at_milliseconds(throwing, time)
                                     : at_samples(throwing, time);
    if (timing.fastest_speed > 0.0) found.push_back(timing);
  }
  return found;
}

}  // namespace headpin::scene
