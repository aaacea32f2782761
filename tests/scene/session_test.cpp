#include "scene/play/session.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/base/sources.h"
#include "devices/lcm/link.h"
#include "devices/lcm/source.h"
#include "scene/play/release_timing.h"
#include "scene/play/run.h"
#include "scene/play/score.h"
#include "scene/record/events.h"
#include "scene/record/log.h"
#include "scene/stage/read_scenario.h"
#include "tests/scene/session_fixture.h"
#include "tests/support/folder.h"

namespace headpin::scene {
namespace {

using test::of_kind;
using test::Outcome;
using test::play;
using test::straight_throw;
using test::the_ball;

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
    for (const Event& event : session.events) {
      if (event.kind != kind::release) continue;
      const bool at_trigger = scenario.hand.release_at == ReleaseAt::trigger;
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
    for (const ReleaseAt release_at : {ReleaseAt::trigger, ReleaseAt::sample}) {
      scenario.hand.release_at = release_at;
      const bool old = release_at == ReleaseAt::sample;
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
  for (const SkittleShape shape : {SkittleShape::parts, SkittleShape::ellipsoid}) {
    Scenario scenario;
    scenario.collision.shape = shape;
    const std::vector<devices::Sample> samples = straight_throw(scenario);
    Outcome outcome{make_session(scenario), {}, {}};
    devices::ReplaySource source(samples);
    const engine::World before = outcome.session.world;
    bool struck = false;
    while (!struck && seconds(outcome.session.now()) < 3.0) {
      advance(outcome.session, source);
      struck = std::ranges::any_of(outcome.session.events,
                                   [](const Event& e) { return e.kind == "first_contact"; });
      if (struck) break;
      for (const engine::BodyId skittle : outcome.session.stage->skittles) {
        EXPECT_EQ(outcome.session.world.states[skittle].X_WB.p, before.states[skittle].X_WB.p);
      }
    }
    EXPECT_TRUE(struck) << name_of(shape);
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
  devices::Clocks clocks;
  devices::LcmSource live{link, clocks};
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
  for (const Event* event : of_kind(outcome, "skittle_down")) {
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

TEST(SessionTest, ASampleIsInTheTransmittersFrameAndAnotherIsRefused) {
  Scenario scenario;
  scenario.rig.X_WT.p = Vec3(5.0, 6.0, 7.0);
  devices::TrackerSample head;
  head.station = static_cast<std::int32_t>(scenario.rig.head_station);
  head.X_TS.p = Vec3(1.0, 2.0, 3.0);
  Session session = make_session(scenario);
  devices::ReplaySource source({head});
  advance(session, source);
  EXPECT_EQ(head_pose(session)->p, Vec3(6.0, 8.0, 10.0));

  head.frame = "lab";
  devices::ReplaySource foreign({head});
  try {
    advance(session, foreign);
    FAIL() << "taken";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("'lab'"));
  }
}

TEST(ReleaseTimingTest, TellsHowLongBeforeTheFastestMomentTheBallWasLetGo) {
  // The hand is ever faster until it stops at 0.72 s; the last sample before that is the 43rd.
  struct Case {
    ReleaseAt release_at;
    Time fastest;
    double speed;
    Time within;
    double speed_within;
  };
  // A release knows no sample after it: it follows the corner where the hand stops at once too late.
  for (const Case& c :
       {Case{ReleaseAt::sample, tick_time(43, 60), 12.0 * (43.0 / 60.0 - 0.2), Time{}, 1e-4},
        Case{ReleaseAt::trigger, Time{720'000}, 12.0 * 0.52, Time{30'000}, 12.0 * 0.03}}) {
    Scenario scenario;
    scenario.hand.release_at = c.release_at;
    scenario.hand.release_window_s = scenario.hand.release_at == ReleaseAt::sample ? 0.06 : 0.12;
    scenario.hand.release_window_most_s = 2.0 * scenario.hand.release_window_s;
    const auto samples = straight_throw(scenario);
    TrialHeader header;
    header.scenario = to_toml(scenario);
    const TemporaryFolder folder;
    const std::string path = (folder.path() / "throw.lcmlog").string();
    Recorder recorder(path, header);
    write(recorder, samples, play(scenario, samples, 1.0).events);
    recorder.close();
    const std::vector<ReleaseTiming> found = release_timings(TrialFile(path), scenario);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].release, Time{700'000});
    EXPECT_LE(std::abs((found[0].fastest - c.fastest).count()), c.within.count());
    EXPECT_NEAR(found[0].fastest_speed, c.speed, c.speed_within);
  }
}

/// The fastest release of a straight throw; with `walks`, by someone who walks down the lane.
double fastest_of(double times_speed, bool walks) {
  Scenario scenario;
  scenario.hand.release_at = ReleaseAt::trigger;
  scenario.release.speed = times_speed;
  auto samples = straight_throw(scenario);
  for (devices::Sample& sample : samples) {
    if (auto* mouse = std::get_if<devices::MouseSample>(&sample)) mouse->left_thumb = walks;
    auto* tracker = std::get_if<devices::TrackerSample>(&sample);
    if (!tracker || tracker->station != devices::kHeadStation) continue;
    tracker->X_TS.q = rotation(Vec3(0.5 * std::numbers::pi, 0.0, 0.0));  // looks along +y
  }
  const TemporaryFolder folder;
  const std::string path = (folder.path() / "throw.lcmlog").string();
  TrialHeader header;
  header.scenario = to_toml(scenario);
  Recorder recorder(path, header);
  write(recorder, samples, play(scenario, samples, 1.0).events);
  recorder.close();
  const std::vector<ReleaseTiming> found = release_timings(TrialFile(path), scenario);
  return found.empty() ? 0.0 : found.front().fastest_speed;
}

TEST(ReleaseTimingTest, CountsTheWalkAndTheScenariosChangeOfTheSpeed) {
  const double own = fastest_of(1.0, false), walk = Scenario{}.walk.speed;
  EXPECT_GT(walk, 0.5);
  EXPECT_NEAR(fastest_of(1.3, false), 1.3 * own, 1e-9);
  EXPECT_NEAR(fastest_of(1.0, true), own + walk, 1e-9);
  EXPECT_NEAR(fastest_of(1.3, true), 1.3 * (own + walk), 1e-9);
}

/// Plays throws whose hand lets go and touches the other version's button in one tick.
/// @param see  gets each and the event of the version that begins then
void let_go_at_a_button(GameKind rules, double longest_s,
                        const std::function<void(const Outcome&, const Event*)>& see) {
  Scenario scenario;
  scenario.version.buttons = true;
  scenario.version.radius = 0.02;
  scenario.game.rules = rules;
  scenario.version.red.button = scenario.ball.home - scenario.hand.grip;
  const auto samples = straight_throw(scenario);
  int in_one_tick = 0;
  for (double ahead = 0.0; ahead < 0.1; ahead += 0.004) {
    scenario.version.blue.button = Vec3(0.0, ahead, 0.25) - scenario.hand.grip;
    const Outcome found = play(scenario, samples, longest_s);
    const auto releases = of_kind(found, std::string(kind::release));
    const auto versions = of_kind(found, std::string(kind::version));
    if (releases.size() != 1 || versions.size() != 2) continue;
    if (releases[0]->tick != versions[1]->tick) continue;
    ++in_one_tick;
    SCOPED_TRACE(ahead);
    see(found, versions[1]);
  }
  EXPECT_GT(in_one_tick, 0);
}

// The ball is the first version's, and what it did is none of the second one.
TEST(Versions, ABallThatIsLetGoAtTheButtonOfAnotherIsOfItsOwn) {
  let_go_at_a_button(GameKind::plain, 2.0, [](const Outcome& found, const Event* begins) {
    const auto counted = of_kind(found, std::string(kind::delivery));
    ASSERT_EQ(counted.size(), 1u);
    EXPECT_GT(counted[0]->value, 0.0);
    EXPECT_LT(counted[0], begins) << "before the version began";
    for (const Event* path : of_kind(found, std::string(kind::ball_path))) {
      EXPECT_LT(path, begins);
    }
    EXPECT_FALSE(found.session.game.thrown || found.session.game.watched);
  });
}

// Where nothing is counted, its way ends with its version.
TEST(Versions, ABallThatIsLetGoAtTheButtonOfAnotherHasAWayThatIsNotCounted) {
  let_go_at_a_button(GameKind::one_throw, 1.0, [](const Outcome& found, const Event* begins) {
    const auto paths = of_kind(found, std::string(kind::ball_path));
    ASSERT_EQ(paths.size(), 1u);
    EXPECT_LT(paths[0], begins) << "before the version began";
    EXPECT_EQ(paths[0]->tick, begins->tick);
  });
}

TEST(SetResponse, IsKeptByEveryVersionAndMakesNoHashes) {
  int calls = 0;
  const engine::Response own{"mine",
                             [&](const engine::Encounter& e, const engine::Coefficients& c) {
                               ++calls;
                               return engine::paper_impulse(e, c);
                             },
                             engine::paper_sliding, "what the paper's keeps"};
  Scenario scenario;
  const Outcome paper = play(scenario, straight_throw(scenario), 3.0);
  Session session = make_session(scenario);
  set_response(session, own);
  devices::ReplaySource source(straight_throw(scenario));
  while (seconds(session.now()) < 3.0) advance(session, source);
  EXPECT_GT(calls, 0);
  EXPECT_EQ(engine::state_hash(session.world), paper.hashes.back());
  EXPECT_FALSE(session.hashes);
  scenario.version.buttons = true;
  Session versions = make_session(scenario);
  set_response(versions, own);
  for (const auto& stage : versions.versions) EXPECT_EQ(stage->world.response, &own);
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

}  // namespace
}  // namespace headpin::scene
