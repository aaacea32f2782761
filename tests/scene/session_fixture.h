#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "devices/base/sample.h"
#include "devices/base/sources.h"
#include "scene/play/session.h"

/// Sessions that are fed the samples of a throw.
namespace headpin::scene::test {

/// A hand that takes the ball from its stand at 0.1 s, swings it evenly faster along +y from 0.2 s,
/// and lets go at 0.7 s over the foul line, a hand's height above the lane, at 6 m/s.
inline std::vector<devices::Sample> straight_throw(const Scenario& scenario, double v_end = 6.0) {
  std::vector<devices::Sample> samples;
  const Vec3 p_WR(0.0, 0.0, 0.25);  // of the ball at release
  const double swing_s = 0.5, a = v_end / swing_s;
  for (int i = 0; i <= 180; ++i) {
    const Time time = tick_time(i, 60);
    const double t = seconds(time) - 0.2;
    Vec3 p_WB = p_WR - Vec3(0.0, 0.5 * a * swing_s * swing_s, 0.0);
    if (t > 0.0)
      p_WB = p_WR +
             Vec3(0.0, 0.5 * a * (std::min(t, 0.52) * std::min(t, 0.52) - swing_s * swing_s), 0.0);
    if (seconds(time) < 0.15) p_WB = scenario.ball.home;
    devices::TrackerSample hand;
    hand.device_time = time;
    hand.sequence = i;
    hand.station = devices::kHandStation;
    hand.X_TS.p = p_WB - scenario.hand.grip;
    samples.push_back(hand);
    devices::TrackerSample head = hand;
    head.station = devices::kHeadStation;
    head.X_TS.p = Vec3(-0.2, -0.4, 1.7);
    samples.push_back(head);
    if (i == 6) samples.emplace_back(devices::MouseSample{.device_time = time, .trigger = true});
    if (i == 42) samples.emplace_back(devices::MouseSample{.device_time = time, .trigger = false});
  }
  return samples;
}

struct Outcome {
  Session session;
  std::vector<Event> events;
  std::vector<std::uint64_t> hashes;
};

inline Outcome play(const Scenario& scenario, const std::vector<devices::Sample>& samples,
                    double until_s) {
  Outcome outcome{make_session(scenario), {}, {}};
  devices::ReplaySource source(samples);
  while (seconds(outcome.session.now()) < until_s) {
    advance(outcome.session, source);
    outcome.events.insert(outcome.events.end(), outcome.session.events.begin(),
                          outcome.session.events.end());
    outcome.hashes.push_back(engine::state_hash(outcome.session.world));
  }
  return outcome;
}

inline std::vector<const Event*> of_kind(const Outcome& outcome, const std::string& kind) {
  std::vector<const Event*> found;
  for (const Event& event : outcome.events) {
    if (event.kind == kind) found.push_back(&event);
  }
  return found;
}

inline const engine::State& the_ball(const Outcome& outcome) {
  return outcome.session.world.states[outcome.session.stage->balls.front()];
}

}  // namespace headpin::scene::test
