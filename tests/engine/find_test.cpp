#include <utility>

#include <gtest/gtest.h>

#include "engine/stages.h"
#include "tests/support/bowling.h"

// Which bodies find_touches() takes for near, and which sleepers it wakes.
namespace headpin::engine {
namespace {

using namespace detail;

constexpr double kSleepSpeed = 0.01;  // of Parameters [m/s]

/// Beside a ball that sleeps, at a gap along x: what it is and how it goes.
struct Beside {
  double gap = 0.0;
  Kind kind = Kind::free;
  Vec3 v = Vec3::Zero(), w = Vec3::Zero();
};

World sleeper_and(const Beside& beside) {
  World world = make_world({.gravity_W = Vec3::Zero()});
  add_body(world, ball_body({1.0, 0.0}));
  Body other = ball_body({1.0, 0.0});
  other.kind = beside.kind;
  add_body(world, other, at(Vec3(2.0 * kBallRadius + beside.gap, 0.0, 0.0), beside.v, beside.w));
  put_to_sleep(world, 0);
  return world;
}

bool wakes_by(const Beside& beside) {
  World world = sleeper_and(beside);
  Workspace w;
  find_touches(world, w);
  return !is_asleep(world, 0);
}

TEST(ASleeper, SleepsOnBesideABodyAtRestUnlessThatIsDeepInIt) {
  EXPECT_FALSE(wakes_by({.gap = 0.0}));
  EXPECT_FALSE(wakes_by({.gap = 0.0, .kind = Kind::driven}));
  EXPECT_FALSE(wakes_by({.gap = -0.5e-3}));
  EXPECT_TRUE(wakes_by({.gap = -2e-3}));
}

// Of a free body, less than the speed at which it may fall asleep itself is rest; a driven one never sleeps.
TEST(ASleeper, WakesWhereTheBodyItTouchesMovesInAnyDirection) {
  for (const Vec3& way : {Vec3(Vec3::UnitX()), Vec3(Vec3::UnitY()), Vec3(-Vec3::UnitZ())}) {
    const Vec3 slow = 0.5 * kSleepSpeed * way, fast = 2.0 * kSleepSpeed * way;
    EXPECT_TRUE(wakes_by({.v = fast}));
    EXPECT_FALSE(wakes_by({.v = slow}));
    EXPECT_TRUE(wakes_by({.kind = Kind::driven, .v = fast}));
    EXPECT_TRUE(wakes_by({.kind = Kind::driven, .v = slow}));
  }
}

TEST(ASleeper, SleepsOnWhereWhatMovesIsNoSupportOfIt) {
  EXPECT_FALSE(wakes_by({.gap = 0.5e-3, .v = Vec3(0.1, 0.0, 0.0)}));  // near, and it goes away
  EXPECT_FALSE(wakes_by({.gap = 0.5e-3, .kind = Kind::driven, .v = Vec3(0.0, 0.1, 0.0)}));
  // A ball that turns about the line of both centres does not move where they touch.
  EXPECT_FALSE(wakes_by({.kind = Kind::driven, .w = Vec3(3.0, 0.0, 0.0)}));
  EXPECT_TRUE(wakes_by({.kind = Kind::driven, .w = Vec3(0.0, 3.0, 0.0)}));
}

// A driven ball goes away from the one sleeper and along the other, which is half a millimetre off.
TEST(ASleeper, WakesAloneWhenItsSupportHasAnotherSleeperNearIt) {
  World world = make_world({.gravity_W = Vec3::Zero()});
  Body hand = ball_body({1.0, 0.0});
  hand.kind = Kind::driven;
  add_body(world, hand, at(Vec3(Vec3::Zero()), Vec3(-0.02, 0.0, 0.0)));
  add_body(world, ball_body({1.0, 0.0}), at(Vec3(2.0 * kBallRadius, 0.0, 0.0)));
  add_body(world, ball_body({1.0, 0.0}), at(Vec3(0.0, 2.0 * kBallRadius + 0.5e-3, 0.0)));
  put_to_sleep(world, 1);
  put_to_sleep(world, 2);
  Workspace w;
  find_touches(world, w);
  EXPECT_FALSE(is_asleep(world, 1));
  EXPECT_TRUE(is_asleep(world, 2));
}

// The ball goes by half a millimetre from the sleeper; straight on it would seem to meet it.
TEST(ASleeper, SleepsOnWhenABallPassesAndTheSearchForTheirMeetingLeavesNoPoint) {
  World world = make_world({.gravity_W = Vec3::Zero()});
  add_body(world, ball_body({1.0, 0.0}));
  add_body(world, ball_body({1.0, 0.0}),
           at(Vec3(-0.02, 2.0 * kBallRadius + 0.5e-3, 0.0), Vec3(5.0, 0.0, 0.0)));
  put_to_sleep(world, 0);
  Workspace w;
  const Touches& touches = find_touches(world, w);
  EXPECT_TRUE(is_asleep(world, 0));
  ASSERT_EQ(touches.all.size(), 1u);
  EXPECT_EQ(touches.points.size(), 1u);
}

TEST(FindTouches, LooksAtAHalfSpaceOfAnyHeightWhenABodyIsNearItsSurfaceAlone) {
  for (const double height : {-2.0, 0.0, 1.0, 50.0}) {
    for (const double gap : {1e-3, 1.0}) {
      World world = make_world({});
      add_body(world, floor_body({1.0, 0.0}), at(Vec3(0.0, 0.0, height)));
      add_body(world, ball_body({1.0, 0.0}),
               at(Vec3(0.0, 0.0, height + kBallRadius + gap), Vec3(0.0, 0.0, -1.0)));
      Workspace w;
      const std::size_t near = gap < 0.5 ? 1 : 0;
      EXPECT_EQ(find_touches(world, w).all.size(), near) << height;
      EXPECT_EQ(w.pairs.candidates.size(), near) << height;
    }
  }
}

TEST(Statistics, CountThePairsOfBoundedBodiesAlone) {
  World world = make_world({});
  add_body(world, floor_body({0.5, 0.5}));
  for (const double x : {0.0, 2.0 * kBallRadius, 3.0, 5.0}) {
    add_body(world, ball_body({0.5, 0.5}), at(Vec3(x, 0.0, kBallRadius)));
  }
  step(world);
  EXPECT_EQ(world.statistics.pairs, 1);
}

// What a driven body carries, it presses, though it does not strike it.
TEST(FindTouches, KnowsABallThatADrivenOneCarriesForPressed) {
  World world = make_world({});
  Body hand = ball_body({0.0, 0.5});
  hand.kind = Kind::driven;
  add_body(world, hand);
  add_body(world, ball_body({0.0, 0.5}), at(Vec3(0.0, 0.0, 2.0 * kBallRadius)));
  Workspace w;
  const Touches& touches = find_touches(world, w);
  ASSERT_EQ(touches.all.size(), 1u);
  EXPECT_FALSE(touches.all[0].pressed);
  for (int k = 0; k < 3; ++k) step(world, w);
  ASSERT_EQ(world.memory.touches.size(), 1u);
  ASSERT_FALSE(world.memory.touches[0].struck);
  ASSERT_EQ(find_touches(world, w).all.size(), 1u);
  EXPECT_TRUE(touches.all[0].pressed);
}

// Threads get parts of so many pairs as are worth a thread.
TEST(FindTouches, IsSharedInPartsThatAreWorthAThread) {
  for (const auto& [balls, parts] : {std::pair(10, 1u), std::pair(1030, 2u)}) {
    World world = make_world({});
    add_body(world, floor_body({0.5, 0.5}));
    for (int k = 0; k < balls; ++k) {
      add_body(world, ball_body({0.5, 0.5}), at(Vec3(0.5 * k, 0.0, kBallRadius)));
    }
    for (const int threads : {1, 2}) {
      Workspace w;
      w.crew.use(threads);
      EXPECT_EQ(find_touches(world, w).all.size(), static_cast<std::size_t>(balls));
      EXPECT_EQ(w.parts, threads == 1 ? 1u : parts);
    }
  }
}

}  // namespace
}  // namespace headpin::engine
