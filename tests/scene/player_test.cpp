// What the player takes, how near it has to be, and how it leaves the hand.

#include "scene/play/player.h"

#include <cmath>
#include <memory>

#include <gmock/gmock.h>

#include "devices/base/sources.h"
#include "scene/record/details.h"
#include "scene/record/events.h"
#include "tests/scene/session_fixture.h"

namespace headpin::scene {
namespace {

using test::of_kind;
using test::Outcome;
using test::play;
using test::the_ball;

devices::TrackerSample hand_sample(Time time, const Vec3& p_TS) {
  devices::TrackerSample hand;
  hand.device_time = time;
  hand.station = devices::kHandStation;
  hand.X_TS.p = p_TS;
  return hand;
}

/// A hand that goes straight through p at 0 s.
std::vector<devices::Sample> hand_along(const Vec3& p, const Vec3& v, Time step, Time end) {
  std::vector<devices::Sample> samples;
  for (Time t{}; t <= end; t += step) samples.emplace_back(hand_sample(t, p + seconds(t) * v));
  return samples;
}

void pull_trigger(std::vector<devices::Sample>& samples, Time down, Time up, Time known = {}) {
  samples.emplace_back(devices::MouseSample{.device_time = down, .trigger = true});
  samples.emplace_back(devices::MouseSample{.device_time = up, .host_time = known});
}

/// What a hand at rest does that pulls the trigger once.
Outcome reach_out(const Scenario& scenario, const Vec3& p_WH) {
  auto samples = hand_along(p_WH, Vec3::Zero(), Time{20'000}, Time{200'000});
  samples.emplace_back(devices::MouseSample{.device_time = Time{100'000}, .trigger = true});
  return play(scenario, samples, 0.2);
}

void expect_reach(const Scenario& scenario, const Vec3& p_WH, double gap, const char* body) {
  const Outcome found = reach_out(scenario, p_WH);
  const bool within = gap <= scenario.hand.reach;
  ASSERT_EQ(of_kind(found, "grab").size(), within ? 1u : 0u) << body << " " << gap;
  const auto events = of_kind(found, within ? "grab" : "missed_grab");
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0]->bodies.front(), body);
  if (!within) {
    EXPECT_NEAR(events[0]->value, gap, 1e-9);
  }
}

// The gap to a ball is one to its surface, that to a skittle one to the cylinder around it.
TEST(Reach, IsFromTheSurfaceOfABallAndFromTheCylinderAroundASkittle) {
  Scenario scenario;
  const Stage stage = make_stage(scenario);
  const double ball = scenario.ball.radius;
  const Vec3 foot(0.0, scenario.lane.head_pin, 0.0);
  for (const double gap : {0.05, scenario.hand.reach - 0.001, scenario.hand.reach + 0.001, 0.3}) {
    expect_reach(scenario, scenario.ball.home + Vec3(0.0, 0.0, ball + gap), gap, "ball");
    expect_reach(scenario, scenario.ball.home + (ball + gap) * Vec3(0.6, -0.8, 0.0), gap, "ball");
    for (const double z : {0.1, 0.3}) {
      const Vec3 beside = foot + Vec3(0.0, -(stage.widest_skittle + gap), z);
      expect_reach(scenario, beside, gap, "skittle 1");
    }
    const Vec3 above = foot + Vec3(0.0, 0.0, scenario.skittle.height + stage.widest_skittle + gap);
    expect_reach(scenario, above, gap, "skittle 1");
  }
}

TEST(Reach, IncludesItsLimit) {
  Scenario scenario;
  scenario.ball.radius = scenario.hand.reach = 0.125;
  scenario.ball.home = Vec3(-1.0, -0.5, 1.0);
  expect_reach(scenario, scenario.ball.home + Vec3(0.0, -0.25, 0.0), 0.125, "ball");
}

// Trials are replayed by that.
TEST(Reach, OfTwoThatAreEquallyNearTakesTheOneThatWasSetUpLast) {
  Scenario scenario;
  scenario.ball.home = Vec3(-1.0, -0.5, 1.0);
  Stage stage = make_stage(scenario);
  const engine::BodyId second = add_ball(stage, Vec3(-0.5, -0.5, 1.0));
  auto samples = hand_along(Vec3(-0.75, -0.5, 1.0), Vec3::Zero(), Time{20'000}, Time{200'000});
  samples.emplace_back(devices::MouseSample{.device_time = Time{100'000}, .trigger = true});
  Session session = make_session(std::make_shared<const Stage>(std::move(stage)));
  devices::ReplaySource source(samples);
  while (session.now() < Time{200'000}) advance(session, source);
  ASSERT_TRUE(session.player.held);
  EXPECT_EQ(session.player.held->body, second);
}

/// The ball is taken at 0.1 s and let go at 0.5 s by a hand that goes along v.
struct Carrying {
  Scenario scenario;
  Vec3 v = Vec3::Zero();
  Time step{10'000}, last{500'000};  ///< of the hand's samples

  Outcome outcome(double until_s, Time up = Time{500'000}, Time known = {}) {
    const Vec3 start = scenario.ball.home - scenario.hand.grip - 0.1 * v;
    auto samples = hand_along(start, v, step, last);
    pull_trigger(samples, Time{100'000}, up, known);
    return play(scenario, samples, until_s);
  }
};

Motion told_motion(const Outcome& outcome) {
  const auto events = of_kind(outcome, "release");
  if (events.size() != 1) return {};
  return motion_of(events[0]->detail).value_or(Motion{});
}

TEST(Grip, ChangesAtTheTicksOfGrabAndRelease) {
  Carrying carrying;
  EXPECT_EQ(carrying.outcome(0.3).session.player.grip_changed, Time{100'000});
  EXPECT_EQ(carrying.outcome(0.7).session.player.grip_changed, Time{500'000});
}

// What is not measured makes no throw: neither a velocity nor a spin.
TEST(ABallLeavesTheHand, AtRestWhereTheMotionIsImpossible) {
  for (const bool spins : {false, true}) {
    Carrying carrying;
    carrying.v = Vec3(0.0, 1.0, 0.0);
    if (spins) carrying.scenario.hand.spin = Vec3(0.0, 0.0, 20.0);
    const double tick = 1.0 / 240.0;
    EXPECT_EQ(the_ball(carrying.outcome(0.5)).w_WB.z(), spins ? 20.0 : 0.0);
    carrying.last = Time{300'000};
    const Outcome lost = carrying.outcome(0.5);
    EXPECT_EQ(told_motion(lost).known, Known::impossible);
    EXPECT_EQ(the_ball(lost).w_WB.z(), 0.0);
    EXPECT_LT(the_ball(lost).v_WB.norm(), 9.82 * tick);
  }
}

// Two samples that are exactly the longest window apart are a line; a microsecond more, and there is none.
TEST(ABallLeavesTheHand, AsALineOfTwoSamplesUpToTheLongestWindow) {
  for (const Time step : {Time{120'000}, Time{120'001}}) {
    Carrying carrying;
    carrying.v = Vec3(0.0, 1.0, 0.0);
    carrying.scenario.hand.release_at = ReleaseAt::sample;
    carrying.scenario.hand.release_window_s = 0.06;
    carrying.scenario.hand.release_window_most_s = 0.12;
    carrying.scenario.hand.reach = 1.0;
    carrying.step = step;
    for (const Time up :
         {Time{200'000}, Time{500'000}}) {  // after the first two samples, and after more
      const Outcome found = carrying.outcome(0.52, up);
      ASSERT_EQ(of_kind(found, "release").size(), 1u);
      EXPECT_NEAR(of_kind(found, "release")[0]->value, step == Time{120'000} ? 1.0 : 0.0, 1e-9);
    }
  }
}

// A device that tells poses 25 ms ahead has told the one 10 ms after the trigger in any case: the motion is
// interpolated. The latency of 8 ms is left to those that tell what was.
TEST(ABallLeavesTheHand, ByThePosesThatAreToldAhead) {
  for (const double predicted_s : {0.0, 0.025}) {
    Carrying carrying;
    carrying.v = Vec3(0.0, 1.0, 0.0);
    carrying.scenario.rig.predicted_s = predicted_s;
    carrying.last = Time{600'000};
    const Time up{495'000};
    const Vec3 start = carrying.scenario.ball.home - carrying.scenario.hand.grip - 0.1 * carrying.v;
    auto samples = hand_along(start, carrying.v, Time{10'000}, Time{600'000});
    for (devices::Sample& sample : samples) {
      auto& hand = std::get<devices::TrackerSample>(sample);
      hand.sent_time = std::max(Time{1}, hand.device_time - microseconds(predicted_s));
    }
    pull_trigger(samples, Time{100'000}, up);
    const Motion found = told_motion(play(carrying.scenario, samples, 0.6));
    EXPECT_EQ(found.known, predicted_s > 0.0 ? Known::tracked : Known::extrapolated);
    EXPECT_NEAR(found.V_WB.v.y(), 1.0, 1e-9);
  }
}

// A sample that arrives within the tick of the trigger, but after it, still places the ball.
TEST(ABallLeavesTheHand, FromBetweenTheSamplesThatItsTickKnows) {
  Carrying carrying;
  carrying.v = Vec3(0.0, 1.0, 0.0);
  const Outcome found = carrying.outcome(0.51, Time{499'000});
  ASSERT_EQ(of_kind(found, "release").size(), 1u);
  EXPECT_NEAR(of_kind(found, "release")[0]->p_W.y(), carrying.scenario.ball.home.y() + 0.399, 1e-9);
}

// Rules 12: a ball whose trigger came late has fallen since then, by all of that time and not by a tick less.
TEST(ABallLeavesTheHand, AndFallsFromTheTriggerOnHoweverLateThatIsKnown) {
  for (const int late_ms : {5, 50, 100, 300}) {
    Carrying carrying;
    carrying.scenario.ball.home = Vec3(-1.0, -1.0, 1.2);
    carrying.last = Time{900'000};
    const Time known = Time{500'000} + Time{1'000 * late_ms};
    const Outcome found = carrying.outcome(seconds(known), Time{500'000}, known);
    ASSERT_EQ(of_kind(found, "release").size(), 1u) << late_ms;
    const double fallen_s = seconds(found.session.now()) - 0.5;
    EXPECT_NEAR(the_ball(found).v_WB.z(), -9.81 * fallen_s, 1e-3) << late_ms;
    EXPECT_NEAR(the_ball(found).X_WB.p.z(), 1.2 - 4.905 * fallen_s * fallen_s, 1e-3) << late_ms;
  }
}

// The ceiling stops a ball that is thrown straight up, and it falls from there.
TEST(ABallLeavesTheHand, AndDoesNotFlyThroughTheCeilingWhileItIsNotKnown) {
  Carrying carrying;
  carrying.v = Vec3(0.0, 0.0, 8.0);
  const Scenario& scenario = carrying.scenario;
  carrying.scenario.ball.home = Vec3(-1.0, -1.0, 0.3);
  const Time up{200'000}, known{700'000};
  carrying.last = up;
  const Outcome found = carrying.outcome(0.7, up, known);
  ASSERT_EQ(of_kind(found, "release").size(), 1u);
  const double g = 9.81, z = 0.3 + 0.8, top = scenario.room.height - scenario.ball.radius;
  const double speed = 8.0, hit_s = (speed - std::sqrt(speed * speed - 2.0 * g * (top - z))) / g;
  const double falls_s = 0.5 - hit_s;
  EXPECT_NEAR(the_ball(found).v_WB.z(), -g * falls_s, 2.0 * g / 240.0);
  EXPECT_NEAR(the_ball(found).X_WB.p.z(), top - 0.5 * g * falls_s * falls_s, 0.03);
}

// Onto the lane, over its edge, and into the gutter: as a ball whose release was known in time, where nothing bounces.
TEST(ABallLeavesTheHand, AndGoesAroundWhatIsInItsWayWhileItIsNotKnown) {
  Carrying carrying;
  carrying.v = Vec3(1.5, 0.0, 0.0);
  carrying.scenario.lane.gutter_width = 0.24;
  carrying.scenario.lane.gutter_depth = 0.1;
  carrying.scenario.ball.home = Vec3(-0.15, 1.0, 0.15);
  set_elasticity(carrying.scenario.material, 0.0);
  set_friction(carrying.scenario.material, 0.0);
  const Time up{200'000}, known{640'000};
  carrying.last = up;
  const Outcome late = carrying.outcome(0.64, up, known), timely = carrying.outcome(0.64, up);
  const Vec3 p = the_ball(timely).X_WB.p;
  EXPECT_LT(p.z(), carrying.scenario.ball.radius - 0.02);
  EXPECT_LT((the_ball(late).X_WB.p - p).norm(), 0.01);
}

TEST(ThePlayer, ForgetsPosesThatAreOlderThanASecond) {
  std::vector<devices::Sample> samples;
  for (int i = 0; i <= 180; ++i) {
    samples.emplace_back(hand_sample(tick_time(i, 60), Vec3(0.0, 0.0, 1.0)));
    devices::TrackerSample head = hand_sample(tick_time(i, 60), Vec3(0.0, 0.0, 1.7));
    head.station = devices::kHeadStation;
    samples.emplace_back(head);
  }
  const Outcome found = play(Scenario{}, samples, 3.0);
  for (const devices::PoseTrack* track : {&found.session.player.head, &found.session.player.hand}) {
    EXPECT_THAT(track->samples().size(), testing::AllOf(testing::Ge(60u), testing::Le(62u)));
  }
}

// scenario.h: the axis of the spin turns to the left, seen from above, the velocity to the right; then the spin about
// the way is added.
TEST(AChangedRelease, TurnsTheAxisOfTheSpin) {
  engine::State state;
  state.v_WB = Vec3(0.0, 6.0, 0.0);
  state.w_WB = Vec3(0.0, 10.0, 3.0);
  const engine::State left = changed(state, {.rotation_deg = 90.0}, 0.027);
  EXPECT_LT((left.w_WB - Vec3(-10.0, 0.0, 3.0)).norm(), 1e-12);
  EXPECT_EQ(left.v_WB, state.v_WB);
  const engine::State right = changed(
      state, {.direction_deg = 90.0, .revs = 2.0, .rotation_deg = -90.0, .spin = 5.0}, 0.027);
  EXPECT_LT((right.v_WB - Vec3(6.0, 0.0, 0.0)).norm(), 1e-12);
  EXPECT_LT((right.w_WB - Vec3(25.0, 0.0, 6.0)).norm(), 1e-12);
}

}  // namespace
}  // namespace headpin::scene
