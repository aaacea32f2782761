// What a player does in a session beside a throw: walks, touches, takes skittles.

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/base/sources.h"
#include "scene/play/score.h"
#include "scene/play/session.h"
#include "scene/record/log.h"
#include "scene/stage/read_scenario.h"
#include "scene/watch/recorded.h"
#include "tests/scene/session_fixture.h"
#include "tests/support/folder.h"

namespace headpin::scene {
namespace {

using test::of_kind;
using test::Outcome;
using test::play;
using test::straight_throw;
using test::the_ball;

// Walking needs them; they are known at their tick, live and replayed.
TEST(SessionTest, ThumbsReachThePlayerAsTheTriggerDoes) {
  const auto mouse = [](int ms, bool left, bool right) {
    return devices::MouseSample{
        .device_time = Time{1000 * ms}, .left_thumb = left, .right_thumb = right};
  };
  Scenario scenario;
  scenario.rig.delay_s = 0.02;
  Session session = make_session(scenario);
  devices::ReplaySource source(
      {mouse(50, true, false), mouse(100, true, true), mouse(150, false, false)});
  while (seconds(session.now()) < 0.3) {
    advance(session, source);
    const double t = seconds(session.now()) - scenario.rig.delay_s;
    EXPECT_EQ(session.player.left_thumb, t >= 0.05 && t < 0.15) << t;
    EXPECT_EQ(session.player.right_thumb, t >= 0.1 && t < 0.15) << t;
  }
}

/// A head that stands and looks somewhere, thumbs that are pressed from 0.1 s on.
struct Walker {
  Vec3 p_PD = Vec3(0.2, -1.5, 1.7);
  Quat q_PD = rotation(Vec3(0.5 * std::numbers::pi, 0.0, 0.0));  // looks along y
  bool left = true, right = false;
  double until_s = 1.1;  ///< the thumbs

  std::vector<devices::Sample> samples() const {
    std::vector<devices::Sample> all;
    for (int i = 0; i <= 180; ++i) {
      devices::TrackerSample head;
      head.device_time = tick_time(i, 60);
      head.X_TS = {q_PD, p_PD};
      all.emplace_back(head);
    }
    all.emplace_back(devices::MouseSample{
        .device_time = Time{100'000}, .left_thumb = left, .right_thumb = right});
    all.emplace_back(devices::MouseSample{.device_time = microseconds(until_s)});
    return all;
  }
  Vec3 goes(const Scenario& scenario) const {
    Session session = play(scenario, samples(), 2.9).session;
    EXPECT_TRUE(session.player.walk.v_WP.isZero(0.0));
    return head_pose(session)->p - p_PD;
  }
};

TEST(SessionTest, ThumbsWalkAlongTheGaze) {
  Scenario scenario;
  // Up to speed, on for a second in all, and to rest: speed times that second.
  const double way = scenario.walk.speed * 1.0, tick = scenario.walk.speed / 240.0;
  Walker walker;
  const Vec3 ahead = walker.goes(scenario);
  EXPECT_NEAR(ahead.y(), way, 2.0 * tick);
  EXPECT_NEAR(std::hypot(ahead.x(), ahead.z()), 0.0, 1e-12);

  const double yaw = 0.4;  // to the left
  walker.q_PD = rotation(Vec3(0.0, 0.0, yaw)) * walker.q_PD;
  const Vec3 left = walker.goes(scenario);
  EXPECT_NEAR(std::atan2(-left.x(), left.y()), yaw, 1e-9);
  EXPECT_NEAR(left.norm(), way, 2.0 * tick);

  walker.q_PD = walker.q_PD * rotation(Vec3(-1.2, 0.0, 0.0));  // and down
  EXPECT_LT((walker.goes(scenario) - left).norm(), 1e-9);

  std::swap(walker.left, walker.right);
  EXPECT_LT((walker.goes(scenario) + left).norm(), 1e-9);

  walker.left = walker.right = true;
  EXPECT_EQ(walker.goes(scenario).norm(), 0.0);
  walker.right = false;
  scenario.walk.speed = 0.0;
  EXPECT_EQ(walker.goes(scenario).norm(), 0.0);
}

TEST(SessionTest, ThumbsWalkWhereTheHandPointsWhenAskedTo) {
  Scenario scenario;
  scenario.walk.along = WalkAlong::hand;
  const Walker walker;  // looks along y
  std::vector<devices::Sample> samples = walker.samples();
  const auto goes = [&] { return play(scenario, samples, 2.9).session.player.walk.p_WP; };
  EXPECT_EQ(goes(), Vec3(Vec3::Zero())) << "no hand, no way";
  const double yaw = 0.4;  // to the left
  for (int i = 0; i <= 180; ++i) {
    devices::TrackerSample hand;
    hand.device_time = tick_time(i, 60);
    hand.station = devices::kHandStation;
    hand.X_TS = {rotation(Vec3(0.0, 0.0, yaw)) * walker.q_PD, Vec3(0.4, -1.1, 1.2)};
    samples.emplace_back(hand);
  }
  const Vec3 way = goes();
  EXPECT_NEAR(std::atan2(-way.x(), way.y()), yaw, 1e-9);
  EXPECT_NEAR(way.norm(), scenario.walk.speed * 1.0, 2.0 * scenario.walk.speed / 240.0);
}

// Up to speed, on, and to rest: speed times the second that the thumb is down.
TEST(SessionTest, AnExportKnowsWhereTheWalkHadTheTrackedSpace) {
  const Scenario scenario;
  TrialHeader header;
  header.scenario = to_toml(scenario);
  const TemporaryFolder folder;
  const std::string path = (folder.path() / "walk.lcmlog").string();
  Recorder recorder(path, header);
  for (const devices::Sample& sample : Walker{}.samples()) recorder.write(sample);
  recorder.close();
  const auto walk = walk_of(TrialFile(path), scenario);
  ASSERT_GT(walk.size(), 100u);
  EXPECT_EQ(walk.front().value, Vec3::Zero());
  EXPECT_NEAR(seconds(walk[1].time), 0.1, 2.0 / 240.0);
  EXPECT_NEAR(walk.back().value.y(), scenario.walk.speed * 1.0, 2.0 * scenario.walk.speed / 240.0);
  const double stops = scenario.walk.speed / scenario.walk.acceleration;
  // Within two ticks, each told to the microsecond.
  EXPECT_NEAR(seconds(walk.back().time), 1.1 + stops, 2.0 / 240.0 + 2e-6);
}

TEST(SessionTest, WallsStopAWalkerAndNotTheHeadThatLeans) {
  const Scenario scenario;
  const Room& room = scenario.room;
  Walker walker;
  walker.until_s = 2.5;
  walker.p_PD = Vec3(0.5, -2.4, 1.7);
  walker.q_PD = rotation(Vec3(0.0, 0.0, -0.5 * std::numbers::pi)) * walker.q_PD;  // to the right
  const Vec3 beside = walker.p_PD + walker.goes(scenario);
  EXPECT_NEAR(beside.x(), 0.5 * room.width - scenario.walk.clearance, 0.01);
  EXPECT_LE(beside.x(), 0.5 * room.width - scenario.walk.clearance);
  // Along the wall it goes on.
  walker.q_PD = rotation(Vec3(0.0, 0.0, 0.5)) * walker.q_PD;
  const Vec3 along = walker.p_PD + walker.goes(scenario);
  EXPECT_NEAR(along.x(), beside.x(), 0.01);
  EXPECT_GT(along.y(), walker.p_PD.y() + 0.5);
  // A head that leans nearer stays there, and may walk back.
  walker.p_PD.x() = 0.5 * room.width - 0.1;
  walker.until_s = 1.1;
  EXPECT_EQ(walker.goes(scenario).x(), 0.0);
  std::swap(walker.left, walker.right);
  EXPECT_LT(walker.goes(scenario).x(), -0.5);
}

TEST(SessionTest, WhatAWalkerLetsGoFliesOnAsFastAsTheWalk) {
  const Scenario scenario;
  Walker walker;
  walker.until_s = 3.0;
  std::vector<devices::Sample> samples = walker.samples();
  for (int i = 0; i <= 180; ++i) {  // a hand at rest in the tracked space, by the ball's stand
    devices::TrackerSample hand;
    hand.device_time = tick_time(i, 60);
    hand.station = devices::kHandStation;
    hand.X_TS.p = scenario.ball.home - scenario.hand.grip;
    samples.emplace_back(hand);
  }
  samples.emplace_back(
      devices::MouseSample{.device_time = Time{101'000}, .left_thumb = true, .trigger = true});
  samples.emplace_back(
      devices::MouseSample{.device_time = Time{1'500'000}, .left_thumb = true, .trigger = false});
  const Outcome outcome = play(scenario, samples, 1.6);
  ASSERT_EQ(of_kind(outcome, "release").size(), 1u);
  EXPECT_NEAR(of_kind(outcome, "release").front()->value, scenario.walk.speed, 1e-9);
  // It went where the hand went, within a tick: from the stand, as far as the walk until then.
  EXPECT_NEAR(the_ball(outcome).X_WB.p.y(),
              scenario.ball.home.y() + outcome.session.player.walk.p_WP.y(),
              1.01 * scenario.walk.speed / 240.0);
}

/// A hand that goes evenly from one place to another, palm down, fingers along y.
std::vector<devices::Sample> hand_moves(const Vec3& from, const Vec3& to, double begin_s,
                                        double end_s) {
  std::vector<devices::Sample> samples;
  for (int i = 0; i <= 600; ++i) {
    devices::TrackerSample hand;
    hand.device_time = tick_time(i, 240);
    hand.sequence = i;
    hand.station = devices::kHandStation;
    const double share =
        std::clamp((seconds(hand.device_time) - begin_s) / (end_s - begin_s), 0.0, 1.0);
    hand.X_TS = {rotation(Vec3(0.5 * std::numbers::pi, 0.0, 0.0)), from + share * (to - from)};
    samples.emplace_back(hand);
  }
  return samples;
}

TEST(SessionTest, AHandThroughTheRackKnocksItOverAndTouchesAreEvents) {
  Scenario scenario;
  const double head_pin = scenario.lane.head_pin;
  const auto through =
      hand_moves(Vec3(0.02, head_pin - 0.5, 0.25), Vec3(0.02, head_pin + 1.0, 0.25), 0.2, 1.2);
  const Outcome pushed = play(scenario, through, 2.4);
  std::vector<std::string> down;
  for (const Event* event : of_kind(pushed, "skittle_down")) {
    down.push_back(event->bodies.front());
  }
  EXPECT_THAT(down, testing::IsSupersetOf({"skittle 1", "skittle 5"}));  // in its way
  ASSERT_FALSE(of_kind(pushed, "hand_touch").empty());
  const Event& first = *of_kind(pushed, "hand_touch").front();
  EXPECT_THAT(first.bodies, testing::UnorderedElementsAre("hand", "skittle 1"));
  EXPECT_NEAR(first.value, 1.5, 0.2);  // as fast as the hand goes
  EXPECT_NEAR(first.p_W.y(), head_pin, 0.1);
  EXPECT_TRUE(of_kind(pushed, "first_contact").empty());  // that is the ball's

  scenario.hand.solid = false;
  const Outcome passed = play(scenario, through, 2.4);
  EXPECT_TRUE(of_kind(passed, "skittle_down").empty());
  EXPECT_TRUE(of_kind(passed, "hand_touch").empty());
}

TEST(SessionTest, AHandDoesNotBatTheBallItLetGo) {
  Scenario solid, ghost;
  ghost.hand.solid = false;
  const Outcome a = play(solid, straight_throw(solid), 2.5);
  const Outcome b = play(ghost, straight_throw(ghost), 2.5);
  EXPECT_EQ(the_ball(a).X_WB.p, the_ball(b).X_WB.p);
  EXPECT_TRUE(of_kind(a, "hand_touch").empty());
  EXPECT_EQ(of_kind(a, "skittle_down").size(), of_kind(b, "skittle_down").size());
  // Clear of the ball, it is a body again.
  EXPECT_FALSE(a.session.player.leaving);
  EXPECT_GT(a.session.world.states[*a.session.stage->hand].X_WB.p.z(), 0.0);
}

TEST(SessionTest, ASkittleIsTakenCarriedAndSetDown) {
  Scenario scenario;
  const Vec3 spot(0.0, scenario.lane.head_pin, 0.0);
  const Vec3 beside = spot + Vec3(0.0, -0.22, 0.15);  // within reach, the fingers clear of it
  auto samples = hand_moves(beside, beside + Vec3(0.0, -1.0, 0.5), 0.4, 1.4);
  samples.emplace_back(devices::MouseSample{.device_time = Time{300'000}, .trigger = true});
  samples.emplace_back(devices::MouseSample{.device_time = Time{2'000'000}, .trigger = false});
  const Outcome taken = play(scenario, samples, 1.9);
  ASSERT_EQ(of_kind(taken, "grab").size(), 1u);
  EXPECT_EQ(of_kind(taken, "grab").front()->bodies, std::vector<std::string>{"skittle 1"});
  const engine::BodyId head = taken.session.stage->skittles.front();
  const Vec3 there = beside + Vec3(0.0, -1.0, 0.5) +
                     rotation(Vec3(0.5 * std::numbers::pi, 0.0, 0.0)) * scenario.hand.grip;
  EXPECT_LT((taken.session.world.states[head].X_WB.p - there).norm(), 1e-9);
  EXPECT_TRUE(of_kind(taken, "skittle_down").empty());  // taken is not fallen
  const Outcome dropped = play(scenario, samples, 2.45);
  ASSERT_EQ(of_kind(dropped, "release").size(), 1u);
  EXPECT_NEAR(of_kind(dropped, "release").front()->value, 0.0, 1e-9);
  EXPECT_FALSE(score(dropped.events).release_speed);  // a ball's
  EXPECT_LT(dropped.session.world.states[head].X_WB.p.z(), there.z() - 0.2);

  scenario.hand.takes_skittles = false;
  EXPECT_EQ(of_kind(play(scenario, samples, 0.5), "missed_grab").size(), 1u);
}

}  // namespace
}  // namespace headpin::scene
