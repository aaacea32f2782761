// The way of a ball in the words of coaches, held against its closed form.

#include "scene/play/ball_path.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene/play/score.h"
#include "scene/record/events.h"
#include "scene/stage/read_scenario.h"
#include "scene/stage/stage.h"

namespace headpin::scene {
namespace {

constexpr double kFriction = 0.2, kGravity = 9.81;

/// A regulation lane without oil, under Coulomb's friction.
Scenario even_lane() {
  Scenario scenario = load_scenario(HEADPIN_SOURCE_DIR "/assets/scenarios/regulation-ten-pin.toml");
  scenario.collision.response = "coulomb";
  set_friction(scenario, std::sqrt(kFriction));
  return scenario;
}

/// 8 m/s, 2 degrees to the right from board 12, 150 rpm with 45 degrees of axis rotation: it hooks to
/// the left.
engine::State hooking(const Stage& stage) {
  const double radian = std::numbers::pi / 180.0, spin = 150.0 * 2.0 * std::numbers::pi / 60.0;
  engine::State s;
  s.X_WB.p = Vec3((20.0 - 12.0) * stage.room.lane_width / 39.0, 0.2, stage.scenario.ball.radius);
  s.v_WB = 8.0 * Vec3(std::sin(2.0 * radian), std::cos(2.0 * radian), 0.0);
  const Vec3 right(std::cos(2.0 * radian), -std::sin(2.0 * radian), 0.0);
  s.w_WB = -spin * (std::cos(45.0 * radian) * right + std::sin(45.0 * radian) * s.v_WB / 8.0);
  return s;
}

/// What is seen of a ball until it leaves the lane, 5 s at most.
BallWatch way_of(Stage& stage, const engine::State& start) {
  const engine::BodyId ball = stage.balls.front();
  engine::World& world = stage.world;
  engine::set_kind(world, ball, engine::Kind::free);
  engine::set_state(world, ball, start);
  BallWatch watch = watch_ball(stage.room, start);
  while (!watch.over && world.tick < 5 * world.parameters.rate_hz) {
    engine::step(world);
    const bool strikes =
        !watch.path.entry &&
        std::ranges::any_of(world.events, [&](const engine::ContactEvent& contact) {
          return stage.roles[contact.a] == Role::skittle || stage.roles[contact.b] == Role::skittle;
        });
    see(watch, stage.room, stage.scenario.ball.radius, world, world.states[ball], strikes);
  }
  return watch;
}

TEST(BallPath, TellsTheReleaseAsCoachesDo) {
  const Stage stage = make_stage(even_lane());
  const Delivered release = delivered(stage.room, hooking(stage));
  EXPECT_NEAR(release.board, 12.0, 1e-9);
  EXPECT_NEAR(release.angle_deg, 2.0, 1e-9);
  EXPECT_NEAR(release.speed, 8.0, 1e-12);
  EXPECT_NEAR(release.revs_per_min, 150.0, 1e-9);
  EXPECT_NEAR(release.rotation_deg, 45.0, 1e-9);
  EXPECT_NEAR(release.tilt_deg, 0.0, 1e-9);
  engine::State other = hooking(stage);
  other.w_WB = Vec3(-3.0, 3.0, 3.0 * std::sqrt(2.0));
  other.v_WB = Vec3(0.0, 5.0, -1.0);
  EXPECT_NEAR(delivered(stage.room, other).rotation_deg, -45.0, 1e-9) << "hooks to the right";
  EXPECT_NEAR(delivered(stage.room, other).tilt_deg, 45.0, 1e-9);
}

// The slip keeps its direction while the ball slides, so its velocity changes evenly: it crosses the
// lane's axis after v / a, has turned by a degree where that follows from both velocities, and rolls
// when 2/7 of the slip is gone (Hopkins and Patterson 1977).
TEST(BallPath, HasBreakpointSkidAndHookAsInClosedForm) {
  Stage stage = make_stage(even_lane());
  const engine::State start = hooking(stage);
  const double r = stage.scenario.ball.radius;
  const Vec2 v = start.v_WB.head<2>();
  const Vec2 slip = v + r * Vec2(-start.w_WB.y(), start.w_WB.x());
  const Vec2 a = -kFriction * kGravity * slip.normalized();
  const auto at = [&](double t) -> Vec2 {
    return start.X_WB.p.head<2>() + t * v + 0.5 * t * t * a;
  };
  const double breaks = -v.x() / a.x();
  const double slope = std::tan(std::numbers::pi / 180.0);  // 2 degrees to the right become 1
  const double hooks = (v.x() - slope * v.y()) / (slope * a.y() - a.x());
  const double rolls = 2.0 / 7.0 * slip.norm() / (kFriction * kGravity);
  constexpr double kWay = 0.04;  // of a step [m]
  const BallPath path = way_of(stage, start).path;
  ASSERT_TRUE(path.breakpoint && path.skid_end && path.hook_end && path.entry);
  EXPECT_NEAR(path.breakpoint->distance, at(breaks).y(), kWay);
  EXPECT_NEAR(path.breakpoint->board, 20.0 - at(breaks).x() / stage.room.lane_width * 39.0, 0.2);
  EXPECT_NEAR(*path.skid_end, at(hooks).y(), kWay);
  EXPECT_NEAR(*path.hook_end, at(rolls).y(), 0.03 * at(rolls).y());
  EXPECT_EQ(path.gutter, std::nullopt);
  EXPECT_LT(path.entry->angle_deg, -0.5);
  EXPECT_NEAR(path.entry->rotation_deg, 0.0, 1.0) << "it rolls";
  EXPECT_LT(*path.loft_end, 0.25);
}

// The lane begins at the foul line: a ball that comes over the approach from beside it has not left it.
TEST(BallPath, OnTheApproachNothingIsBesideTheLane) {
  for (const std::int64_t rules : {10, 11}) {
    Scenario scenario = even_lane();
    scenario.collision.rules = rules;
    Stage stage = make_stage(scenario);
    engine::State start;
    start.X_WB.p = Vec3(0.56, -1.2, scenario.ball.radius + 0.001);
    start.v_WB = Vec3(-0.36, 8.0, 0.0);  // straight to x = 0.51 m at the line, and over the lane
    const BallPath path = way_of(stage, start).path;
    if (rules < 11) {
      ASSERT_TRUE(path.gutter);
      EXPECT_LT(*path.gutter, 0.0);
      continue;
    }
    EXPECT_EQ(path.gutter, std::nullopt);
    EXPECT_TRUE(path.entry && path.hook_end);
    // One that stays beside the lane has left it where the lane begins.
    start.v_WB = Vec3(0.0, 8.0, 0.0);
    Stage beside = make_stage(scenario);
    const BallPath missed = way_of(beside, start).path;
    ASSERT_TRUE(missed.gutter);
    EXPECT_NEAR(*missed.gutter, 0.0, 0.04);  // a tick's way
    EXPECT_GT(*missed.gutter, 0.0);
  }
}

// It is thrown up again within a tick: at no tick's end it lies on the lane.
TEST(BallPath, HasTheFirstTouchOfABallThatBounces) {
  for (const double height : {0.012, 0.05, 0.28, 0.30, 0.32, 0.34}) {
    Stage stage = make_stage(even_lane());
    engine::State start = hooking(stage);
    start.X_WB.p.z() += height;
    start.v_WB = Vec3(0.0, 5.0, 0.0);
    start.w_WB = Vec3::Zero();
    const double falls = std::sqrt(2.0 * height / kGravity);
    const BallPath path = way_of(stage, start).path;
    ASSERT_TRUE(path.loft_end) << height;
    EXPECT_NEAR(*path.loft_end, start.X_WB.p.y() + 5.0 * falls, 0.003) << height;
  }
}

// From less than a millimetre up, with the lane near from the first step on.
TEST(BallPath, HasTheFirstTouchOfABallThatIsLetGoJustAboveTheLane) {
  for (const double height : {0.0002, 0.0005, 0.0009}) {
    for (const std::int64_t rate : {240, 960}) {
      Scenario scenario = even_lane();
      scenario.rates.physics_hz = rate;
      Stage stage = make_stage(scenario);
      engine::State start = hooking(stage);
      start.X_WB.p.z() += height;
      start.v_WB = Vec3(0.0, 8.0, -0.0146);
      start.w_WB = Vec3::Zero();
      const double falls =
          (std::sqrt(0.0146 * 0.0146 + 2.0 * kGravity * height) - 0.0146) / kGravity;
      const BallPath path = way_of(stage, start).path;
      ASSERT_TRUE(path.loft_end) << height;
      EXPECT_NEAR(*path.loft_end, start.X_WB.p.y() + 8.0 * falls, 0.004) << height << " " << rate;
    }
  }
}

TEST(BallPath, HasTheFirstTouchOfABallThatFliesBack) {
  Stage stage = make_stage(even_lane());
  engine::State start = hooking(stage);
  start.X_WB.p += Vec3(0.0, 3.0, 0.1);
  start.v_WB = Vec3(0.0, -2.0, 0.0);
  start.w_WB = Vec3::Zero();
  const BallPath path = way_of(stage, start).path;
  ASSERT_TRUE(path.loft_end);
  EXPECT_NEAR(*path.loft_end, start.X_WB.p.y() - 2.0 * std::sqrt(0.2 / kGravity), 0.003);
}

TEST(BallPath, EndsInTheGutterOrBehindTheSkittles) {
  Stage stage = make_stage(even_lane());
  engine::State start = hooking(stage);
  start.v_WB = Vec3(1.0, 5.0, 0.0);
  const BallPath wide = way_of(stage, start).path;
  ASSERT_TRUE(wide.gutter);
  EXPECT_GT(*wide.gutter, 0.5);
  EXPECT_FALSE(wide.entry || wide.exit_board);

  Stage other = make_stage(even_lane());
  start = hooking(other);
  start.X_WB.p.x() = 0.0;
  start.v_WB = Vec3(0.0, 9.0, 0.0);
  start.w_WB = Vec3(-9.0 / other.scenario.ball.radius, 0.0, 0.0);
  const BallWatch straight = way_of(other, start);
  EXPECT_TRUE(straight.over);
  ASSERT_TRUE(straight.path.exit_board);
  EXPECT_NEAR(*straight.path.exit_board, 20.0, 8.0);
  EXPECT_FALSE(straight.path.breakpoint || straight.path.gutter);
}

// It passes the head pin's spot, and then meets one of the last row.
TEST(BallPath, EntersWhereItMeetsItsFirstSkittle) {
  Stage stage = make_stage(even_lane());
  engine::State now = hooking(stage);
  BallWatch watch = watch_ball(stage.room, now);
  const auto goes_on = [&](double by, double board, bool strikes) {
    now.X_WB.p.x() = (20.0 - board) * stage.room.lane_width / 39.0;
    now.X_WB.p.y() = stage.room.head_pin + by;
    see(watch, stage.room, stage.scenario.ball.radius, stage.world, now, strikes);
    return watch.path.entry ? watch.path.entry->board : 0.0;
  };
  EXPECT_EQ(goes_on(-0.1, 30.0, false), 0.0);
  EXPECT_NEAR(goes_on(0.1, 31.0, false), 30.0, 1e-9) << "it may meet none";
  EXPECT_NEAR(goes_on(0.3, 32.0, false), 30.0, 1e-9);
  EXPECT_NEAR(goes_on(0.5, 33.0, true), 32.0, 1e-9);
  EXPECT_NEAR(goes_on(0.6, 34.0, false), 32.0, 1e-9);
}

TEST(BallPath, IsWrittenAndReadAgain) {
  BallPath path;
  path.release = {12.5, -1.25, 7.5, 300.0, 45.0, 10.0};
  path.skid_end = 8.125;
  path.breakpoint = LanePlace{7.5, 12.0};
  path.exit_board = 19.25;
  path.flare_mm = 120.5;
  const auto again = Detail::read(kind::ball_path, Detail(path).text());
  ASSERT_TRUE(again.get_if<BallPath>());
  EXPECT_EQ(*again.get_if<BallPath>(), path);
  for (const char* text : {"", "{", "{\"release\": 3}", "{\"release\": {\"board\": 3}}", "[]"}) {
    const Detail foreign = Detail::read(kind::ball_path, text);
    EXPECT_FALSE(foreign.get_if<BallPath>()) << text;
    EXPECT_EQ(foreign.text(), text);
  }
}

Event of(std::string_view kind, std::vector<std::string> bodies, double value = 0.0) {
  Event event;
  event.kind = kind;
  event.bodies = std::move(bodies);
  event.value = value;
  return event;
}

// The pins that the ball touched, in order, and those that stand when it was counted.
TEST(BallPath, OfAThrowHasWhatItTouchedAndWhatItLeft) {
  const Scenario scenario;
  Score score;
  Event game = of(kind::game, {}, 10.0);
  game.detail = GameKind::ten_pin;
  score.add(game, scenario);
  score.add(of(kind::release, {"ball"}, 7.0), scenario);
  for (const char* pin : {"skittle 1", "skittle 3", "skittle 3"}) {
    score.add(of(kind::touch, {"ball", pin}), scenario);
  }
  score.add(of(kind::touch, {"skittle 5", "ball"}), scenario);
  score.add(of(kind::touch, {"skittle 1", "skittle 2"}), scenario);
  std::vector<std::string> most;
  for (const int pin : {1, 2, 3, 5, 6, 8, 9, 10}) most.push_back(name_of_skittle(pin));
  score.add(of(kind::delivery, most, 8.0), scenario);
  ASSERT_EQ(score.throws.size(), 1u);
  EXPECT_EQ(score.throws[0].touched, (std::vector{1, 3, 5}));
  EXPECT_EQ(score.throws[0].leave, "4-7");
  score.add(of(kind::release, {"ball"}, 7.0), scenario);
  score.add(of(kind::delivery, {"skittle 4"}, 1.0), scenario);
  EXPECT_EQ(score.throws[1].leave, "7");
  EXPECT_EQ(skittle_number("skittle 12"), 12);
  for (const char* name : {"ball 3", "skittle", "skittle x", "lane", ""}) {
    EXPECT_EQ(skittle_number(name), std::nullopt) << name;
  }
}

TEST(BallPath, OfAThrowAtAFullRackLeavesWhatOfItStands) {
  const Scenario scenario;
  Score score;
  Event game = of(kind::game, {}, 9.0);
  game.detail = GameKind::ninepins;
  score.add(game, scenario);
  for (const auto& [felled, leave] : {std::pair{std::vector{1, 2, 3, 4, 5}, "6-7-8-9"},
                                      {{6, 9}, "1-2-3-4-5-7-8"},
                                      {{}, "1-2-3-4-5-6-7-8-9"}}) {
    std::vector<std::string> names;
    for (const int pin : felled) names.push_back(name_of_skittle(pin));
    score.add(of(kind::release, {"ball"}, 7.0), scenario);
    score.add(of(kind::delivery, names, static_cast<double>(names.size())), scenario);
    EXPECT_EQ(score.throws.back().leave, leave);
  }
}

/// A ball without a lane or a step: its states are told.
struct ToldBall {
  static constexpr double kRadius = 0.125;  // without rounding

  RoomMeasures room;
  engine::World world;
  BallWatch watch;

  ToldBall(int rate_hz, double gravity, const engine::State& release) {
    world.parameters.rate_hz = rate_hz;
    world.parameters.gravity_W = Vec3(0.0, 0.0, -gravity);
    watch = watch_ball(room, release);
  }
  const BallPath& then(const engine::State& now, bool was_released = false, bool strikes = false) {
    see(watch, room, kRadius, world, now, strikes, was_released);
    return watch.path;
  }
};

/// A ball at a distance, with its lowest point at a height.
engine::State told_state(double distance, double height, const Vec3& v_WB) {
  engine::State s;
  s.X_WB.p = Vec3(0.0, distance, ToldBall::kRadius + height);
  s.v_WB = v_WB;
  return s;
}

// 3 m/s down and 0.8 m up: at the lane with 5 m/s, after 0.2 s of the step's 0.25 s.
TEST(BallPath, HasTheFirstTouchWhereTheFallWithinAStepEnds) {
  const engine::State lies = told_state(3.5, 0.0, {0.0, 10.0, 0.0});
  ToldBall falls(4, 10.0, told_state(1.0, 0.8, {0.0, 10.0, -3.0}));
  EXPECT_NEAR(falls.then(lies).loft_end.value_or(0.0), 3.0, 1e-9);
  ToldBall weightless(4, 0.0, told_state(1.0, 0.5, {0.0, 10.0, -4.0}));
  EXPECT_NEAR(weightless.then(lies).loft_end.value_or(0.0), 2.25, 1e-9);
}

TEST(BallPath, HasTheFirstTouchOfABallThatIsLetGoOnTheLaneThere) {
  ToldBall ball(4, 10.0, told_state(1.0, 0.0, {0.0, 8.0, 0.0}));
  EXPECT_EQ(ball.then(told_state(3.0, 0.0, {0.0, 8.0, 0.0}), true).loft_end, 1.0);
}

TEST(BallPath, HasNoTouchOfTheLaneInTheAir) {
  ToldBall let_go(240, 10.0, told_state(1.0, 1.0, {0.0, 8.0, 0.0}));
  EXPECT_FALSE(let_go.then(told_state(1.03, 1.0, {0.0, 8.0, -0.02}), true).loft_end);
  ToldBall pushed_up(240, 10.0, told_state(1.0, 0.5, {0.0, 8.0, -1.0}));
  EXPECT_FALSE(pushed_up.then(told_state(1.03, 0.5, {0.0, 8.0, 2.0})).loft_end);
  // Just above the lane, but in free flight.
  ToldBall rises(240, 10.0, told_state(1.0, 0.00005, {0.0, 8.0, 1.0}));
  EXPECT_FALSE(rises.then(told_state(1.03, 0.004, {0.0, 8.0, 1.0 - 10.0 / 240.0})).loft_end);
}

TEST(BallPath, RollsWhenItSlipsByLessThanAFiftiethOfItsSpeed) {
  for (const double speed : {8.0, 0.5}) {
    for (const double slips : {0.01, 0.03}) {
      engine::State s = told_state(1.0, 0.0, {0.0, speed, 0.0});
      s.w_WB.x() = -(1.0 - slips) * speed / ToldBall::kRadius;
      ToldBall ball(240, 10.0, s);
      EXPECT_EQ(ball.then(s, true).hook_end.has_value(), slips < 0.02) << speed << " " << slips;
    }
  }
}

TEST(BallPath, HasNoBreakpointWhereItComesToRest) {
  ToldBall ball(240, 10.0, told_state(1.0, 0.0, {-0.05, 0.1, 0.0}));
  EXPECT_FALSE(ball.then(told_state(1.0, 0.0, Vec3::Zero())).breakpoint);
}

TEST(BallPath, HasAnExitOnTheLaneAlone) {
  for (const double x : {-0.55, -0.5, 0.5, 0.55}) {
    ToldBall ball(240, 10.0, told_state(6.0, 0.0, {0.0, 8.0, 0.0}));
    engine::State behind = told_state(ball.room.deck_end + 0.1, 0.0, {0.0, 8.0, 0.0});
    behind.X_WB.p.x() = x;
    const BallPath path = ball.then(behind, false, true);
    EXPECT_EQ(path.exit_board.has_value(), std::abs(x) < 0.527) << x;
    if (path.exit_board) {
      EXPECT_NEAR(*path.exit_board, 20.0 - x * 39.0 / 1.0541, 1e-9);
    }
  }
}

// Rolling, back spin, and side spin to either side. A ball that stands has no direction to tell it from.
TEST(BallPath, TellsSpinAlongAndAcrossTheLaneAndThatOfABallThatStands) {
  const RoomMeasures room;
  engine::State s = told_state(1.0, 0.0, {0.0, 5.0, 0.0});
  for (const auto& [w_WB, rotation_deg] : {std::pair{Vec3(-3.0, 0.0, 0.0), 0.0},
                                           {Vec3(3.0, 0.0, 0.0), 180.0},
                                           {Vec3(0.0, -3.0, 0.0), 90.0},
                                           {Vec3(0.0, 3.0, 0.0), -90.0},
                                           {Vec3(0.0, 0.0, 3.0), 0.0}}) {
    s.w_WB = w_WB;
    EXPECT_NEAR(delivered(room, s).rotation_deg, rotation_deg, 1e-9) << w_WB.transpose();
    EXPECT_LE(delivered(room, s).rotation_deg, 180.0) << w_WB.transpose();
  }
  s.v_WB = Vec3::Zero();
  s.w_WB = Vec3(1.0, 2.0, 2.0);
  const Delivered stands = delivered(room, s);
  EXPECT_EQ(stands.rotation_deg, 0.0);
  EXPECT_EQ(stands.tilt_deg, 0.0);
  EXPECT_NEAR(stands.revs_per_min, 3.0 * 30.0 / std::numbers::pi, 1e-9);
}

// What leaves the deck sideways after its entry is in neither column, as docs/tables.md says.
TEST(BallPath, HasNoGutterAndNoExitWhereItLeavesTheLaneBesideTheSkittles) {
  for (const bool strikes : {true, false}) {
    ToldBall ball(240, 10.0, told_state(1.0, 0.0, {0.0, 8.0, 0.0}));
    engine::State at = told_state(ball.room.head_pin + 0.1, 0.0, {2.0, 8.0, 0.0});
    EXPECT_TRUE(ball.then(at, true, strikes).entry);
    at.X_WB.p = Vec3(0.6, ball.room.head_pin + 0.4, at.X_WB.p.z());
    EXPECT_FALSE(ball.then(at, true).gutter);
    at.X_WB.p.y() = ball.room.deck_end + 0.1;
    const BallPath path = ball.then(at, true);
    EXPECT_FALSE(path.gutter || path.exit_board);
    EXPECT_TRUE(ball.watch.over);
  }
}

}  // namespace
}  // namespace headpin::scene
