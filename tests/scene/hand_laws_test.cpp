// What holds of whatever the hand takes, carries and lets go.

#include <cmath>
#include <functional>
#include <memory>

#include <gmock/gmock.h>

#include "base/random.h"
#include "devices/base/sources.h"
#include "scene/play/session.h"
#include "scene/record/events.h"
#include "scene/stage/room.h"
#include "tests/support/scale.h"

namespace headpin::scene {
namespace {

using HandAt = std::function<Vec3(double)>;

/// Samples of a hand, 60 a second, where the ball's centre is `where` in it.
std::vector<devices::Sample> hand_path(const Scenario& scenario, double end_s,
                                       const HandAt& where) {
  std::vector<devices::Sample> samples;
  for (int i = 0; tick_time(i, 60) <= microseconds(end_s); ++i) {
    devices::TrackerSample hand;
    hand.device_time = tick_time(i, 60);
    hand.sequence = i;
    hand.station = devices::kHandStation;
    hand.X_TS.p = where(seconds(hand.device_time)) - scenario.hand.grip;
    samples.emplace_back(hand);
  }
  return samples;
}

void add_trigger(std::vector<devices::Sample>& samples, double time_s, bool down) {
  samples.emplace_back(devices::MouseSample{.device_time = microseconds(time_s), .trigger = down});
}

struct Handled {
  Session session;
  std::vector<Event> releases, grabs;
};

Handled handle(const Scenario& scenario, const std::vector<devices::Sample>& samples, double end_s,
               const std::function<void(const Session&)>& each = {}) {
  Handled handled{make_session(scenario), {}, {}};
  devices::ReplaySource source(samples);
  while (handled.session.now() < microseconds(end_s)) {
    advance(handled.session, source);
    for (const Event& event : handled.session.events) {
      if (event.kind == kind::release) handled.releases.push_back(event);
      if (event.kind == kind::grab) handled.grabs.push_back(event);
    }
    if (each) each(handled.session);
  }
  return handled;
}

TEST(HandLaws, AStillHandReleasesAtZeroSpeed) {
  const Scenario scenario;
  auto samples = hand_path(scenario, 1.0, [&](double) { return scenario.ball.home; });
  add_trigger(samples, 0.3, true);
  add_trigger(samples, 0.7, false);
  const Handled handled = handle(scenario, samples, 0.71);
  ASSERT_EQ(handled.releases.size(), 1u);
  EXPECT_EQ(handled.releases[0].value, 0.0);
}

// The slope at the end of a parabola through a circle: over the window it turns by w T = 0.24, so the
// fit errs by less than its square over six of the speed, along and across.
TEST(HandLaws, AHandOnACircleReleasesAlongTheTangentAtItsSpeed) {
  const Scenario scenario;
  const double radius = 0.5, rate = 4.0, stops = 0.6;
  const Vec3 centre(0.0, -0.5, 1.0);
  const auto on_circle = [&](double t) {
    const double angle = rate * std::max(0.0, t - stops);
    return Vec3(centre + radius * Vec3(0.0, -std::sin(angle), -std::cos(angle)));
  };
  Scenario there = scenario;
  there.ball.home = on_circle(0.0);
  for (const double at : {0.9, 1.037, 1.3}) {
    auto samples = hand_path(there, 1.6, on_circle);
    add_trigger(samples, 0.3, true);
    add_trigger(samples, at, false);
    const Handled handled = handle(there, samples, at + 0.003);
    ASSERT_EQ(handled.releases.size(), 1u) << at;
    const double speed = radius * rate, turned = rate * there.hand.release_window_s;
    EXPECT_NEAR(handled.releases[0].value, speed, speed * turned * turned / 6.0) << at;
    const double angle = rate * (at - stops);
    const Vec3 tangent(0.0, -std::cos(angle), std::sin(angle));
    const Vec3 v = handled.session.world.states[handled.session.stage->balls.front()].v_WB;
    // The sample before the trigger is up to 16.7 ms old, in which the tangent turns by 0.067.
    EXPECT_GT(v.normalized().dot(tangent), std::cos(0.067 + turned * turned / 3.0)) << at;
  }
}

// The hand is lost for a while as the ball is let go, and comes back far from where it was.
TEST(HandLaws, ADropOutAtTheReleaseDoesNotFlingTheBall) {
  Scenario scenario;
  const double speed = 2.0;
  const auto forward = [&](double t) {
    return Vec3(scenario.ball.home + Vec3(0.0, speed * std::max(0.0, t - 0.5), 0.0));
  };
  for (const double lost_s : {0.05, 0.1, 0.15, 0.4}) {
    for (const bool reported : {false, true}) {
      std::vector<devices::Sample> samples;
      for (devices::Sample& sample : hand_path(scenario, 1.6, forward)) {
        auto& hand = std::get<devices::TrackerSample>(sample);
        const double t = seconds(hand.device_time);
        const bool lost = t > 1.0 - lost_s && t <= 1.0;
        if (lost && !reported) continue;
        if (lost) {
          hand.status = 'x';
          hand.X_TS.p += Vec3(3.0, -2.0, 5.0);  // what a unit says of a receiver it has lost
        }
        samples.push_back(sample);
      }
      add_trigger(samples, 0.3, true);
      add_trigger(samples, 1.002, false);
      const Handled handled = handle(scenario, samples, 1.1);
      ASSERT_EQ(handled.releases.size(), 1u) << lost_s;
      EXPECT_LE(handled.releases[0].value, 1.05 * speed) << lost_s << reported;
    }
  }
}

// A hand that goes wherever it likes, through floor, walls and what hangs from them.
TEST(HandLaws, NothingCarriedIsEverBelowTheLaneOrBehindAWall) {
  const Scenario scenario;
  const Room& room = scenario.room;
  const double r = scenario.ball.radius, slack = 1e-3;
  const std::vector<Block> blocks = front_blocks(room_measures(scenario));
  for (std::uint64_t seed = 1; seed <= (kThorough ? 3 : 1); ++seed) {
    Random random(seed);
    std::vector<Vec3> stops = {scenario.ball.home, scenario.ball.home};
    for (int i = 0; i < 12; ++i) {
      stops.emplace_back(random.uniform(-3.5, 3.5), random.uniform(-4.5, 9.0),
                         random.uniform(-1.5, 2.0));
    }
    auto samples = hand_path(scenario, 13.0, [&](double t) {
      const auto i = std::min(static_cast<std::size_t>(t), stops.size() - 2);
      return Vec3(stops[i] + (t - static_cast<double>(i)) * (stops[i + 1] - stops[i]));
    });
    add_trigger(samples, 0.5, true);
    int carried = 0;
    handle(scenario, samples, 13.0, [&](const Session& session) {
      if (!session.player.held) return;
      ++carried;
      const Vec3& p = session.world.states[session.player.held->body].X_WB.p;
      EXPECT_GE(p.z(), r - slack) << session.tick;
      EXPECT_LE(std::abs(p.x()), 0.5 * room.width - r + slack) << session.tick;
      EXPECT_GE(p.y(), -room.behind + r - slack) << session.tick;
      EXPECT_LE(p.y(), room.ahead - r + slack) << session.tick;
      for (const Block& block : blocks) {
        const Vec3 nearest = p.cwiseMax(block.low_W).cwiseMin(block.high_W);
        EXPECT_GE((p - nearest).norm(), r - slack) << session.tick << " " << block.name;
      }
    });
    EXPECT_GT(carried, 12 * 240);
  }
}

TEST(HandLaws, TwoBallsCannotBeTakenAtOnce) {
  const Scenario scenario;
  Stage stage = make_stage(scenario);
  const Vec3 beside = scenario.ball.home + Vec3(2.0 * scenario.ball.radius + 0.01, 0.0, 0.0);
  const engine::BodyId second = add_ball(stage, beside);
  const Vec3 between = 0.5 * (scenario.ball.home + beside);
  auto samples = hand_path(scenario, 2.0, [&](double) { return between; });
  for (const double t : {0.3, 0.5, 0.7}) add_trigger(samples, t, true);  // down again without an up
  Session session = make_session(std::make_shared<const Stage>(std::move(stage)));
  devices::ReplaySource source(samples);
  int grabs = 0;
  while (session.now() < Time{1'500'000}) {
    advance(session, source);
    grabs += static_cast<int>(std::ranges::count(session.events, kind::grab, &Event::kind));
    int carried = 0;  // away from its stand
    for (const engine::BodyId ball : session.stage->balls) {
      carried += session.world.states[ball].X_WB.p != session.stage->world.states[ball].X_WB.p;
    }
    EXPECT_LE(carried, 1);
  }
  EXPECT_EQ(grabs, 1);
  ASSERT_TRUE(session.player.held);
  EXPECT_TRUE(session.player.held->body == second ||
              session.player.held->body == session.stage->balls.front());
}

}  // namespace
}  // namespace headpin::scene
