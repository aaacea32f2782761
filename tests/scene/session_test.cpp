#include "scene/play/session.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/lcm/link.h"
#include "devices/lcm/source.h"
#include "devices/trial/log.h"
#include "devices/trial/sources.h"
#include "scene/play/events.h"
#include "scene/play/release_timing.h"
#include "scene/play/run.h"
#include "scene/play/score.h"
#include "scene/stage/bodies.h"
#include "scene/stage/read_scenario.h"
#include "scene/watch/recorded.h"
#include "tests/support/folder.h"

namespace headpin::scene {
namespace {

/// A hand that takes the ball from its stand at 0.1 s, swings it evenly faster along +y from 0.2 s,
/// and lets go at 0.7 s over the foul line, a hand's height above the lane, at 6 m/s.
std::vector<devices::Sample> straight_throw(const Scenario& scenario, double v_end = 6.0) {
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

/// A ball at the end of the tick in which it was let go.
struct LetGo {
  engine::State ball;
  double flown = 0.0;  ///< up to the tick [s]
  double speed = 0.0;  ///< as noted
};

/// @param shift  of all samples against the ticks
LetGo let_go(Scenario scenario, bool falls_at_once, Time shift) {
  scenario.hand.falls_at_once = falls_at_once;
  std::vector<devices::Sample> samples = straight_throw(scenario);
  for (devices::Sample& sample : samples) {
    std::visit([&](auto& one) { one.device_time += shift; }, sample);
  }
  const Time released = tick_time(42, 60) + shift;
  devices::ReplaySource source(samples);
  Session session = make_session(scenario);
  while (session.tick < 1000) {
    advance(session, source);
    for (const devices::Event& event : session.events) {
      if (event.kind != kind::release) continue;
      const bool at_trigger = scenario.hand.release_at == "trigger";
      EXPECT_EQ(event.time, at_trigger ? released : session.now());
      return {session.world.states[session.stage->balls.front()], seconds(session.now() - released),
              event.value};
    }
  }
  ADD_FAILURE() << "nothing was let go";
  return {};
}

// Free fall from the moment of the release: gravity has acted for the time up to the tick, not for a
// whole one. Trials of before went on from there for a tick more.
TEST(Release, BetweenTwoTicksFallsFromThereOnWhereAsked) {
  Scenario scenario;
  const double dt = 1.0 / static_cast<double>(scenario.rates.physics_hz);
  const Vec3 g = make_stage(scenario).world.parameters.gravity_W;
  for (const Time shift : {Time{0}, Time{1000}, Time{2500}, Time{4000}}) {
    for (const char* release_at : {"trigger", "sample"}) {
      scenario.hand.release_at = release_at;
      const bool old = scenario.hand.release_at == "sample";
      const LetGo later = let_go(scenario, false, shift), at_once = let_go(scenario, true, shift);
      const double f = at_once.flown;
      EXPECT_NEAR(f, shift == Time{} ? 0.0 : dt - seconds(shift), 1e-6);
      const Vec3 faster = (old ? f : f - dt) * g;
      const Vec3 lower = (old ? 0.5 * f * f + f * dt : 0.5 * (f * f - dt * dt)) * g;
      EXPECT_LT((at_once.ball.v_WB - later.ball.v_WB - faster).norm(), 1e-12) << shift.count();
      EXPECT_LT((at_once.ball.X_WB.p - later.ball.X_WB.p - lower).norm(), 1e-12) << shift.count();
      EXPECT_EQ(at_once.speed, later.speed);  // when it was let go
    }
  }
}

struct Outcome {
  Session session;
  std::vector<devices::Event> events;
  std::vector<std::uint64_t> hashes;
};

Outcome play(const Scenario& scenario, const std::vector<devices::Sample>& samples,
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

std::vector<const devices::Event*> of_kind(const Outcome& outcome, const std::string& kind) {
  std::vector<const devices::Event*> found;
  for (const devices::Event& event : outcome.events) {
    if (event.kind == kind) found.push_back(&event);
  }
  return found;
}

const engine::State& the_ball(const Outcome& outcome) {
  return outcome.session.world.states[outcome.session.stage->balls.front()];
}

TEST(SessionTest, BallLeavesTheHandWithTheHandsVelocityAndSkittlesFall) {
  const Scenario scenario;
  const Outcome outcome = play(scenario, straight_throw(scenario), 4.0);
  ASSERT_EQ(of_kind(outcome, "grab").size(), 1u);
  ASSERT_EQ(of_kind(outcome, "release").size(), 1u);
  const Score total = score(outcome.events);
  EXPECT_NEAR(*total.release_speed, 6.0, 0.01);  // a parabola follows it exactly
  ASSERT_EQ(of_kind(outcome, "first_contact").size(), 1u);
  EXPECT_GT(total.skittles_down, 3);
  EXPECT_EQ(of_kind(outcome, "skittle_down").size(), static_cast<std::size_t>(total.skittles_down));
  EXPECT_LT(of_kind(outcome, "first_contact")[0]->tick, of_kind(outcome, "skittle_down")[0]->tick);
}

// The hand dips 0.35 m below where it lets go: the ball would be 0.1 m below the lane.
TEST(SessionTest, ACarriedBallStaysOnTheLaneThatTheHandGoesThrough) {
  const Scenario scenario;
  std::vector<devices::Sample> samples = straight_throw(scenario);
  for (devices::Sample& sample : samples) {
    auto* const pose = std::get_if<devices::TrackerSample>(&sample);
    if (!pose || pose->station != devices::kHandStation) continue;
    if (seconds(pose->device_time) > 0.4) pose->X_TS.p.z() -= 0.35;
  }
  Session session = make_session(scenario);
  devices::ReplaySource source(samples);
  const engine::BodyId ball = session.stage->balls.front();
  const double radius = session.world.bodies[ball].shape->bounding_radius;
  double lowest = 1.0, highest = 0.0;
  while (seconds(session.now()) < 2.0) {
    advance(session, source);
    const engine::State& s = session.world.states[ball];
    if (seconds(session.now()) > 0.5) {
      lowest = std::min(lowest, s.X_WB.p.z());
      highest = std::max(highest, s.X_WB.p.z());
    }
  }
  EXPECT_NEAR(lowest, radius, 1e-4);
  EXPECT_LE(highest, radius + 1e-3);  // let go there, it is not thrown up
  EXPECT_GT(session.world.states[ball].v_WB.y(), 2.0);
}

TEST(SessionTest, SkittlesStandUntilTheyAreStruck) {
  for (const std::string shape : {"true", "ellipsoid"}) {
    Scenario scenario;
    scenario.collision.shape = shape;
    const std::vector<devices::Sample> samples = straight_throw(scenario);
    Outcome outcome{make_session(scenario), {}, {}};
    devices::ReplaySource source(samples);
    const engine::World before = outcome.session.world;
    bool struck = false;
    while (!struck && seconds(outcome.session.now()) < 3.0) {
      advance(outcome.session, source);
      struck = std::ranges::any_of(outcome.session.events, [](const devices::Event& e) {
        return e.kind == "first_contact";
      });
      if (struck) break;
      for (const engine::BodyId skittle : outcome.session.stage->skittles) {
        EXPECT_EQ(outcome.session.world.states[skittle].X_WB.p, before.states[skittle].X_WB.p);
      }
    }
    EXPECT_TRUE(struck) << shape;
  }
}

TEST(SessionTest, TwoRunsAreEqualToTheBit) {
  const Scenario scenario;
  const auto samples = straight_throw(scenario);
  EXPECT_EQ(play(scenario, samples, 3.0).hashes, play(scenario, samples, 3.0).hashes);
}

/// What an observer sees of a session: its samples and its hashes.
struct Recording : Observer {
  void tick(const Session& session) override {
    samples.insert(samples.end(), session.samples.begin(), session.samples.end());
    hashes.push_back(engine::state_hash(session.world));
  }
  std::vector<devices::Sample> samples;
  std::vector<std::uint64_t> hashes;
};

/// A live source: what a publisher sends over LCM as it becomes due.
struct Published : devices::Source {
  explicit Published(const std::vector<devices::Sample>& samples) : publisher(samples) {}
  void poll(Time now, std::vector<devices::Sample>& out) override {
    std::vector<devices::Sample> due;
    publisher.poll(now, due);
    for (const devices::Sample& sample : due) link.publish(sample);
    live.poll(now, out);
  }
  bool exhausted() const override { return publisher.exhausted(); }

  devices::ReplaySource publisher;
  devices::LcmLink link{"memq://"};
  devices::LcmSource live{link};
};

TEST(SessionTest, ALiveSourceAndItsRecordingMakeTheSameGame) {
  const Scenario scenario;
  const auto seen_of = [&](devices::Source& source) {
    Session session = make_session(scenario);
    Recording seen;
    NoPace pace;
    Observer* const observers[] = {&seen};
    run(session, source, pace, observers, [](const Session& s) { return seconds(s.now()) >= 3.0; });
    return seen;
  };
  Published published(straight_throw(scenario));
  const Recording live = seen_of(published);
  EXPECT_EQ(live.samples.size(), straight_throw(scenario).size());
  devices::ReplaySource recording(live.samples);
  const Recording replayed = seen_of(recording);
  EXPECT_EQ(replayed.samples.size(), live.samples.size());
  EXPECT_EQ(replayed.hashes, live.hashes);
  EXPECT_EQ(live.hashes.size(), 720u);
}

TEST(SessionTest, OtherMaterialsMakeAnotherGame) {
  Scenario rough, smooth;
  set_elasticity(smooth.material, 1.0);
  set_friction(smooth.material, 0.0);
  const auto samples = straight_throw(rough);
  EXPECT_NE(play(rough, samples, 3.0).hashes.back(), play(smooth, samples, 3.0).hashes.back());
}

TEST(SessionTest, TheBallStaysOnItsStandUntilAHandWithinReachTakesIt) {
  Scenario scenario;
  auto samples = straight_throw(scenario);
  scenario.ball.home.x() += 1.0;  // out of reach of that hand
  const Outcome outcome = play(scenario, samples, 2.0);
  EXPECT_TRUE(of_kind(outcome, "grab").empty());
  EXPECT_EQ(the_ball(outcome).X_WB.p, scenario.ball.home);
}

TEST(SessionTest, TheTrackersFrameMakesNoDifference) {
  // The same throw, told in a frame that stands and is turned otherwise.
  const Scenario plain;
  const auto samples = straight_throw(plain);
  Scenario turned = plain;
  turned.rig.X_WT = {rotation(Vec3(0.3, -1.1, 2.0)), Vec3(0.5, -1.0, 2.0)};
  auto told = samples;
  for (devices::Sample& sample : told) {
    if (auto* tracker = std::get_if<devices::TrackerSample>(&sample)) {
      tracker->X_TS = turned.rig.X_WT.inverse() * tracker->X_TS;
    }
  }
  const Outcome a = play(plain, samples, 1.0), b = play(turned, told, 1.0);
  EXPECT_NEAR((the_ball(a).X_WB.p - the_ball(b).X_WB.p).norm(), 0.0, 1e-9);
}

TEST(SessionTest, ALatePoseIsReadBetweenSamples) {
  Scenario scenario;
  scenario.rig.delay_s = 0.02;
  Session session = make_session(scenario);
  std::vector<devices::Sample> samples;
  for (int i = 0; i < 20; ++i) {
    devices::TrackerSample head;
    head.device_time = Time{14'000 * i};
    head.station = devices::kHeadStation;
    head.X_TS.p = Vec3(seconds(head.device_time), 0.0, 0.0);  // 1 m/s
    samples.push_back(head);
  }
  devices::ReplaySource source(samples);
  while (seconds(session.now()) < 0.2) advance(session, source);
  EXPECT_NEAR(head_pose(session)->p.x(), seconds(session.now()) - 0.02, 1e-12);
}

/// The samples of a throw, its ball taken from `home` and its head pin at `x`.
std::vector<devices::Sample> throw_from(const Scenario& scenario, const Vec3& home, double x,
                                        Time later) {
  Scenario there = scenario;
  there.ball.home = home;
  auto samples = straight_throw(there);
  for (devices::Sample& sample : samples) {
    std::visit([&](auto& s) { s.device_time += later; }, sample);
    auto* hand = std::get_if<devices::TrackerSample>(&sample);
    if (hand && hand->device_time > later + Time{150'000}) hand->X_TS.p.x() += x;
  }
  return samples;
}

// Bodies are told by their roles, so nothing needs to know how many there are.
TEST(SessionTest, TwoBallsAndTwoRacksAreThrownOneAfterTheOther) {
  Scenario scenario;
  scenario.room.width = 12.0;
  auto stage = std::make_shared<Stage>(make_stage(scenario));
  const Vec3 second_home = scenario.ball.home + Vec3(4.0, 0.0, 0.0);
  const engine::BodyId second_ball = add_ball(*stage, second_home);
  add_rack(*stage, {4.0, scenario.lane.head_pin});
  ASSERT_EQ(stage->skittles.size(), 20u);
  EXPECT_EQ(body_names(*stage)[second_ball], "ball 2");

  std::vector<devices::Sample> samples = throw_from(scenario, scenario.ball.home, 0.0, Time{});
  const Time later{4'000'000};
  const auto second = throw_from(scenario, second_home, 4.0, later);
  samples.insert(samples.end(), second.begin(), second.end());
  Outcome outcome{make_session(stage), {}, {}};
  devices::ReplaySource source(samples);
  while (seconds(outcome.session.now()) < 8.0) {
    advance(outcome.session, source);
    outcome.events.insert(outcome.events.end(), outcome.session.events.begin(),
                          outcome.session.events.end());
  }
  ASSERT_EQ(of_kind(outcome, "grab").size(), 2u);
  EXPECT_EQ(of_kind(outcome, "grab")[0]->bodies, std::vector<std::string>{"ball"});
  EXPECT_EQ(of_kind(outcome, "grab")[1]->bodies, std::vector<std::string>{"ball 2"});
  std::array<int, 2> down{};
  for (const devices::Event* event : of_kind(outcome, "skittle_down")) {
    ++down[event->p_W.x() > 2.0];
  }
  EXPECT_GT(down[0], 3);
  EXPECT_GT(down[1], 3);
}

// A run costs no mass properties: it copies the stage's world, and comes to the same bits.
TEST(SessionTest, RunsOfOneStageAreEqualAndLeaveItAsItWas) {
  const auto stage = std::make_shared<const Stage>(make_stage(Scenario{}));
  const std::uint64_t before = engine::state_hash(stage->world);
  std::array<std::uint64_t, 2> hashes{};
  for (std::uint64_t& hash : hashes) {
    Session session = make_session(stage);
    devices::ReplaySource source(straight_throw(stage->scenario));
    while (seconds(session.now()) < 2.0) advance(session, source);
    hash = engine::state_hash(session.world);
  }
  EXPECT_EQ(hashes[0], hashes[1]);
  EXPECT_NE(hashes[0], before);
  EXPECT_EQ(engine::state_hash(stage->world), before);
}

TEST(SessionTest, ASampleInTheWorldsFrameNeedsNoTransmitterAndAnotherFrameIsRefused) {
  Scenario scenario;
  scenario.rig.X_WT.p = Vec3(5.0, 6.0, 7.0);
  devices::TrackerSample head;
  head.station = static_cast<std::int32_t>(scenario.rig.head_station);
  head.X_TS.p = Vec3(1.0, 2.0, 3.0);
  head.frame = "P";
  Session session = make_session(scenario);
  devices::ReplaySource source({head});
  advance(session, source);
  EXPECT_EQ(head_pose(session)->p, head.X_TS.p);

  head.frame = "lab";
  devices::ReplaySource foreign({head});
  try {
    advance(session, foreign);
    FAIL() << "taken";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("'lab'"));
  }
}

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
  scenario.walk.along = "hand";
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
  devices::TrialHeader header;
  header.scenario = to_toml(scenario);
  const TemporaryFolder folder;
  const std::string path = (folder.path() / "walk.lcmlog").string();
  devices::Recorder recorder(path, header);
  for (const devices::Sample& sample : Walker{}.samples()) recorder.write(sample);
  recorder.close();
  const auto walk = walk_of(devices::TrialFile(path), scenario);
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
  for (const devices::Event* event : of_kind(pushed, "skittle_down")) {
    down.push_back(event->bodies.front());
  }
  EXPECT_THAT(down, testing::IsSupersetOf({"skittle 1", "skittle 5"}));  // in its way
  ASSERT_FALSE(of_kind(pushed, "hand_touch").empty());
  const devices::Event& first = *of_kind(pushed, "hand_touch").front();
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

TEST(ReleaseTimingTest, TellsHowLongBeforeTheFastestMomentTheBallWasLetGo) {
  // The hand is ever faster until it stops at 0.72 s; the last sample before that is the 43rd.
  struct Case {
    const char* release_at;
    Time fastest;
    double speed;
    Time within;
    double speed_within;
  };
  // The cubic rounds the corner where the hand stops at once.
  for (const Case& c : {Case{"sample", tick_time(43, 60), 12.0 * (43.0 / 60.0 - 0.2), Time{}, 1e-4},
                        Case{"trigger", Time{720'000}, 12.0 * 0.52, Time{12'000}, 0.15}}) {
    Scenario scenario;
    scenario.hand.release_at = c.release_at;
    scenario.hand.release_window_s = scenario.hand.release_at == "sample" ? 0.06 : 0.12;
    scenario.hand.release_window_most_s = 2.0 * scenario.hand.release_window_s;
    const auto samples = straight_throw(scenario);
    devices::TrialHeader header;
    header.scenario = to_toml(scenario);
    const TemporaryFolder folder;
    const std::string path = (folder.path() / "throw.lcmlog").string();
    devices::Recorder recorder(path, header);
    devices::write(recorder, samples, play(scenario, samples, 1.0).events);
    recorder.close();
    const std::vector<ReleaseTiming> found = release_timings(devices::TrialFile(path), scenario);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].release, Time{700'000});
    EXPECT_LE(std::abs((found[0].fastest - c.fastest).count()), c.within.count());
    EXPECT_NEAR(found[0].fastest_speed, c.speed, c.speed_within);
  }
}

TEST(SessionTest, TheRigSaysWhatIsWornWhere) {
  Scenario scenario;
  scenario.rig.head_station = 4;
  devices::TrackerSample on_one, on_four;
  on_one.station = 1;
  on_four.station = 4;
  on_four.X_TS.p = Vec3(1.0, 2.0, 3.0);
  Session session = make_session(scenario);
  devices::ReplaySource source({on_one, on_four});
  advance(session, source);
  EXPECT_EQ(head_pose(session)->p, on_four.X_TS.p);
}

TEST(SkittleBody, WeighsWhatItsScenarioSaysAndBalancesWhereAPinDoes) {
  const Scenario scenario;
  const auto [body, centre_height] = skittle_body(scenario);
  EXPECT_NEAR(body.mass, 1.588, 1e-12);
  EXPECT_NEAR(centre_height, 0.1474, 0.01);  // of a pin's profile; ours are primitives
  EXPECT_NEAR(body.inertia(0, 0), 1.344e-2, 0.1 * 1.344e-2);
  EXPECT_NEAR(body.inertia(2, 2), 1.97e-3, 0.1 * 1.97e-3);
  Scenario ellipsoid = scenario;
  ellipsoid.collision.shape = "ellipsoid";
  EXPECT_EQ(skittle_body(ellipsoid).centre_height, centre_height);
  ellipsoid.skittle.ellipsoid_weighed = "itself";
  EXPECT_NEAR(skittle_body(ellipsoid).centre_height, 0.5 * 0.381, 1e-9);
}

TEST(RoomFixtures, NothingGetsOutOfTheRoom) {
  // Balls thrown every which way from over the deck, with nothing lost at any surface.
  Scenario scenario;
  scenario.lane.kick_backs = true;
  scenario.lane.masking_panel = true;
  set_elasticity(scenario.material, 1.0);
  set_friction(scenario.material, 0.0);
  engine::World world = engine::make_world(world_parameters(scenario));
  for (const Fixture& fixture : room_fixtures(scenario)) {
    engine::add_body(world, fixture.body, {fixture.X_WB, Vec3::Zero(), Vec3::Zero()});
  }
  const engine::BodyId ball = engine::add_body(world, ball_body(scenario),
                                               {.X_WB = {Quat::Identity(), Vec3(0.0, 6.5, 0.4)}});
  int met_kick_back = 0, met_ceiling = 0;
  for (int i = 0; i < 60; ++i) {
    const SinCos turn = sin_cos(0.1047 * i);
    engine::set_state(world, ball,
                      {{Quat::Identity(), Vec3(0.0, 6.5, 0.4)},
                       Vec3(9.0 * turn.cos, 9.0 * turn.sin, i % 2 == 0 ? 1.0 : 8.0),
                       Vec3::Zero()});
    for (int k = 0; k < 240; ++k) {
      engine::step(world);
      const Vec3& p = world.states[ball].X_WB.p;
      ASSERT_LT(std::abs(p.x()), 0.5 * scenario.room.width);
      ASSERT_LT(p.y(), scenario.room.ahead);
      ASSERT_GT(p.z(), 0.5 * scenario.ball.radius);
      ASSERT_LT(p.z(), scenario.room.height);
      for (const engine::ContactEvent& e : world.events) {
        met_kick_back += world.bodies[e.b].name.ends_with("kick-back");
        met_ceiling += world.bodies[e.b].name == "ceiling";
      }
    }
  }
  EXPECT_GT(met_kick_back, 20);
  EXPECT_GT(met_ceiling, 10);
}

std::set<std::string> names_of(const std::vector<Fixture>& fixtures) {
  std::set<std::string> names;
  for (const Fixture& fixture : fixtures) names.insert(fixture.body.name);
  return names;
}

// The paper tells of a room and a game of bowling: of no panel, kick-backs or gutters.
TEST(RoomFixtures, OfThePapersRoomAreFloorWallsAndCeiling) {
  EXPECT_EQ(names_of(room_fixtures(Scenario{})),
            (std::set<std::string>{"lane", "left wall", "right wall", "wall behind", "wall ahead",
                                   "ceiling"}));
}

// Whatever the defaults are, a trial of before these keys has the room it was made in.
TEST(RoomFixtures, OfATrialFromBeforeTheirKeysAreThoseOfThen) {
  const devices::Trial trial =
      devices::read_trial(HEADPIN_SOURCE_DIR "/tests/scene/trials/rules-1.lcmlog");
  const Scenario scenario = scenario_of_trial(trial.header.scenario, "rules-1.lcmlog");
  EXPECT_EQ(names_of(room_fixtures(scenario)),
            (std::set<std::string>{"lane", "left wall", "right wall", "wall behind", "wall ahead",
                                   "left kick-back", "right kick-back", "masking panel"}));
  EXPECT_EQ(scenario.lane.gutter_width, 0.235);
}

}  // namespace
}  // namespace headpin::scene
