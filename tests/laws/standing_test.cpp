#include <numbers>

#include <gtest/gtest.h>

#include "tests/support/bowling.h"
#include "tests/support/random_shapes.h"
#include "tests/support/scale.h"

namespace headpin::engine {
namespace {

TEST(TenSkittles, StandForAMinuteAtEveryRateWhateverTheirSurface) {
  const double duration = kThorough ? 60.0 : 2.0;
  for (const int rate : {60, 120, 240, 480, 1000}) {
    for (const double elasticity : {0.0, 0.49, 1.0}) {
      for (const double friction : {0.0, 0.49, 1.0}) {
        RackOptions o;
        o.ball = false;
        o.parameters.rate_hz = rate;
        o.parameters.sleep = false;
        o.material = {std::sqrt(elasticity), std::sqrt(friction)};
        Bowling b = bowling(o);
        const std::vector<State> placed = b.world.states;
        step(b.world);
        const double start = balance(b.world).energy;
        double highest = start;
        for (std::int64_t i = 1; i < std::llround(duration * rate); ++i) {
          step(b.world);
          if (i % 16 == 0) highest = std::max(highest, balance(b.world).energy);
        }
        EXPECT_EQ(skittles_down(b), 0) << rate << " " << elasticity << " " << friction;
        EXPECT_LE(highest, start * (1.0 + 1e-6));
        for (const BodyId i : b.skittles) {
          EXPECT_LT((b.world.states[i].X_WB.p - placed[i].X_WB.p).norm(), 1e-4);
        }
      }
    }
  }
}

/// A skittle on the edge of its base, tilted about the x axis.
struct Tilted {
  World world;
  BodyId skittle = 0;
};

Tilted tilted(double degrees, int rate_hz, bool sleep) {
  Tilted t{make_world({.rate_hz = rate_hz, .sleep = sleep})};
  add_body(t.world, floor_body({0.7, 0.7}));
  const SinCos a = sin_cos(degrees * std::numbers::pi / 180.0);
  State s;
  s.X_WB.q = rotation(Vec3(degrees * std::numbers::pi / 180.0, 0.0, 0.0));
  s.X_WB.p.z() = kSkittleHeight * a.cos + kBaseRadius * a.sin;
  t.skittle = add_body(t.world, skittle_body({0.7, 0.7, 0.005}), s);
  return t;
}

// It falls when its centre of mass is beyond the edge: atan(25.8 / 147) = 9.95 degrees.
TEST(TiltedSkittle, ReturnsBelowItsTipAngleAndFallsAboveItAtEveryRate) {
  for (const int rate : {60, 120, 240, 480, 1000}) {
    Tilted below = tilted(9.8, rate, true);
    run(below.world, 5.0);
    EXPECT_NEAR(upright(below.world.states[below.skittle]), 1.0, 1e-6) << rate;
    EXPECT_TRUE(is_asleep(below.world, below.skittle));
    Tilted above = tilted(10.2, rate, true);
    run(above.world, 5.0);
    EXPECT_LT(upright(above.world.states[above.skittle]), 0.2) << rate;
  }
}

// How a rocking skittle loses its energy is a law of its base and its friction, not of the step.
TEST(RockingSkittle, ComesToRestInATimeThatDoesNotDependOnTheRate) {
  for (const double degrees : {3.0, 6.0, 9.0}) {
    std::vector<double> asleep_after, tenth_after;
    for (const int rate : {120, 240, 480, 1000}) {
      Tilted t = tilted(degrees, rate, true);
      const double rest = 1.5 * 9.81 * kSkittleHeight;
      const double start = balance(t.world).energy - rest;
      double tenth = 0.0;
      while (!is_asleep(t.world, t.skittle) && t.world.tick < 5 * rate) {
        step(t.world);
        const double now = static_cast<double>(t.world.tick) / rate;
        if (balance(t.world).energy - rest > 0.1 * start) tenth = now;
      }
      asleep_after.push_back(static_cast<double>(t.world.tick) / rate);
      tenth_after.push_back(tenth);
    }
    for (const double time : asleep_after) {
      EXPECT_NEAR(time, asleep_after.back(), 0.2 * asleep_after.back()) << degrees;
    }
    // From 3 degrees it is over within 0.19 s, which 120 Hz divides into steps of 4 %.
    for (const double time : tenth_after) {
      EXPECT_NEAR(time, tenth_after.back(), (degrees > 3.0 ? 0.2 : 0.24) * tenth_after.back());
    }
  }
}

// On the paper's rate a slow push must move a body that stands, and a sleeper must not hinder it.
TEST(SlowHand, PushesAStandingSkittleAlong) {
  World world = make_world({});
  add_body(world, floor_body({0.7, 0.7}));
  State s = at(Vec3(0.0, 0.0, kSkittleHeight));
  const BodyId skittle = add_body(world, skittle_body({0.7, 0.7, 0.005}), s);
  put_to_sleep(world, skittle);
  Body hand = ball_body({0.7, 0.0}, 0.03, 1.0);
  hand.kind = Kind::driven;
  s.X_WB.p = Vec3(-kBaseRadius - 0.03 - 0.01, 0.0, 0.031);
  s.v_WB = Vec3(0.05, 0.0, 0.0);
  const BodyId palm = add_body(world, hand, s);
  run(world, 2.0);
  EXPECT_NEAR(world.states[skittle].X_WB.p.x() - world.states[palm].X_WB.p.x(), kBaseRadius + 0.03,
              0.05);
  EXPECT_GT(world.states[skittle].X_WB.p.x(), 0.05);
}

// What sleeps is carried, and by something that does not move.
TEST(SlowBody, DriftsOnWithoutGravity) {
  World world = make_world({.gravity_W = Vec3::Zero()});
  const BodyId ball = add_body(world, ball_body({}), at(Vec3::Zero(), Vec3(0.009, 0.0, 0.0)));
  run(world, 2.0);
  EXPECT_NEAR(world.states[ball].X_WB.p.x(), 0.018, 1e-12);
  EXPECT_NEAR(world.states[ball].v_WB.x(), 0.009, 1e-15);
}

TEST(SlowBody, FallsHoweverWeakGravityIs) {
  World world = make_world({.gravity_W = Vec3(0.0, 0.0, -0.03)});
  add_body(world, floor_body({}));
  const BodyId ball = add_body(world, ball_body({}), at(Vec3(0.0, 0.0, 1.0 + kBallRadius)));
  run(world, 5.0);
  EXPECT_NEAR(1.0 + kBallRadius - world.states[ball].X_WB.p.z(), 0.5 * 0.03 * 25.0, 1e-9);
}

TEST(SlowPlatform, TakesWhatStandsOnItAlong) {
  for (const std::string_view response : {"paper", "coulomb"}) {
    World world = make_world({.response = response});
    Body plate = ball_body({});
    plate.shape = make_compound({{test::box({0.5, 0.5, 0.05}), Pose{}}});
    plate.kind = Kind::driven;
    const BodyId platform = add_body(world, plate, at(Vec3::Zero(), Vec3(0.005, 0.0, 0.0)));
    const BodyId skittle =
        add_body(world, skittle_body({}), at(Vec3(0.0, 0.0, 0.05 + kSkittleHeight)));
    run(world, 20.0);
    EXPECT_NEAR(world.states[platform].X_WB.p.x(), 0.1, 1e-9);
    EXPECT_NEAR(world.states[skittle].X_WB.p.x(), 0.1, 1e-3) << response;
  }
}

}  // namespace
}  // namespace headpin::engine
