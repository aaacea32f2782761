#include <gtest/gtest.h>

#include "tests/support/bowling.h"

namespace headpin::engine {
namespace {

struct Thrown {
  World world;
  BodyId ball = 0;
  double slip() const {
    const State& s = world.states[ball];
    return s.v_WB.y() + s.w_WB.x() * kBallRadius;
  }
};

Thrown sliding_ball(int rate_hz, const Material& material, std::string_view response = "paper") {
  Thrown t{make_world({.rate_hz = rate_hz, .response = response})};
  add_body(t.world, floor_body(material));
  t.ball =
      add_body(t.world, ball_body(material), at(Vec3(0.0, 0.0, kBallRadius), Vec3(0.0, 6.0, 0.0)));
  return t;
}

// The paper's friction is a rate: per tau = 1/60 s a part mu of the slip goes, at whatever step.
TEST(SlidingBall, LosesSlipAtTheRateOfThePairAndNotOfTheStep) {
  for (const double friction : {0.3, 0.7, 0.9}) {
    const double mu = friction * friction;
    for (const int rate : {60, 120, 240, 480, 1000}) {
      Thrown t = sliding_ball(rate, {0.7, friction});
      for (const double time : {1.0 / 60, 0.05, 0.1, 0.2}) {
        while (static_cast<double>(t.world.tick) / rate < time - 1e-9) step(t.world);
        const double passed = static_cast<double>(t.world.tick) / rate;
        const double expected = 6.0 * std::pow(1.0 - mu, passed * 60.0);
        EXPECT_NEAR(t.slip(), expected, 1e-6 * expected + 1e-12) << rate << " " << time;
      }
    }
  }
}

// Angular momentum about the contact point stays: v ends at 5/7 of the start, whatever the rate.
TEST(SlidingBall, EndsRollingAtFiveSeventhsOfItsSpeed) {
  for (const std::string_view response : {"paper", "coulomb"}) {
    for (const int rate : {60, 240, 1000}) {
      Thrown t = sliding_ball(rate, {0.7, 0.7}, response);
      run(t.world, 2.0);
      EXPECT_NEAR(t.world.states[t.ball].v_WB.y(), 6.0 * 5.0 / 7.0, 1e-3) << response << rate;
      EXPECT_NEAR(t.slip(), 0.0, 1e-9);
      EXPECT_NEAR(t.world.states[t.ball].X_WB.p.z(), kBallRadius, 1e-9);
    }
  }
}

// The paper's rate works on slip alone, so what stands on a slope creeps: each step leaves a part
// `kept` of the slip, and gravity adds to it. The rate counts the impulse as the paper's, for a
// body that would also turn, which the slope keeps this one from: 1 + m h^2 / I.
TEST(BlockOnASlope, CreepsAtTheRateOfThePairAndNotOfTheStep) {
  const double tilt = 10.0 / 57.29577951308232, mu = 0.49, tau = 1.0 / 60;
  const Vec3 gravity = 9.81 * Vec3(0.0, std::sin(tilt), -std::cos(tilt));
  for (const int rate : {120, 240, 480, 1000}) {
    World world = make_world({.rate_hz = rate, .gravity_W = gravity, .sleep = false});
    add_body(world, floor_body({0.7, 0.7}));
    Body block = ball_body({0.7, 0.7});
    block.shape = make_compound({{Cylinder{0.1, 0.03}, Pose{}}});
    block.inertia = Vec3(0.02, 0.02, 0.035).asDiagonal();
    const BodyId i = add_body(world, block, at(Vec3(0.0, 0.0, 0.03)));
    run(world, 1.0);
    const double kept = std::pow(1.0 - mu, 1.0 / (rate * tau));
    const double turns = 1.0 + 7.0 * 0.03 * 0.03 / 0.02;
    const double creep = turns * kept / (1.0 - kept) * gravity.y() / rate;
    EXPECT_NEAR(world.states[i].v_WB.y(), creep, 1e-3 * creep) << rate;
    // The law of fine steps, to the first order in the step.
    EXPECT_NEAR(creep, -turns * gravity.y() * tau / std::log(1.0 - mu), gravity.y() / rate);
  }
}

// Coulomb: the ball slows by mu g until 2/7 v / (mu g) has passed, then rolls.
TEST(SlidingBallAfterCoulomb, SlowsByMuG) {
  const double mu = 0.04, v = 6.0, g = 9.81;
  Thrown t = sliding_ball(240, {0.7, 0.2}, "coulomb");
  run(t.world, 1.0);
  EXPECT_NEAR(t.world.states[t.ball].v_WB.y(), v - mu * g, 1e-9);
  const double rolls_after = 2.0 / 7.0 * v / (mu * g);
  run(t.world, rolls_after - 1.0 - 0.05);
  EXPECT_GT(t.slip(), 0.01);
  run(t.world, 0.1);
  EXPECT_NEAR(t.slip(), 0.0, 1e-9);
}

/// Where a disc that cannot tip is after a time, which slides along y from 3 m/s [m].
///
/// @param tilt  of the floor, whose level stays that of W [rad]
double slide_of_disc(int rate_hz, double tilt, double time, int rules) {
  const Vec3 gravity = 9.81 * Vec3(0.0, std::sin(tilt), -std::cos(tilt));
  World world =
      make_world({.rate_hz = rate_hz, .gravity_W = gravity, .response = "coulomb", .rules = rules});
  add_body(world, floor_body({0.7, 0.5}));
  Body disc = ball_body({0.7, 0.6});
  disc.shape = make_compound({{Cylinder{0.2, 0.01}, Pose{}}});
  disc.inertia = Vec3(0.07, 0.07, 0.14).asDiagonal();
  const BodyId i = add_body(world, disc, at(Vec3(0.0, 0.0, 0.01), Vec3(0.0, 3.0, 0.0)));
  run(world, time);
  return world.states[i].X_WB.p.y();
}

// Coulomb: v t - mu g t^2 / 2 while it slides, v^2 / (2 mu g) at rest. With the velocity at a step's end, a
// disc is half a step times the lost velocity short.
TEST(SlidingDiscAfterCoulomb, IsWhereTheClosedFormHasIt) {
  const double mu = 0.3, v = 3.0, g = 9.81;
  for (const int rate : {60, 240, 1000}) {
    EXPECT_NEAR(slide_of_disc(rate, 0.0, 0.5, 6), 0.5 * v - 0.125 * mu * g, 1e-6) << rate;
    const double stops = v * v / (2.0 * mu * g);
    EXPECT_NEAR(slide_of_disc(rate, 0.0, 2.0, 6), stops, 0.5 * mu * g / (rate * rate)) << rate;
    EXPECT_LT(slide_of_disc(rate, 0.0, 2.0, 5), stops - 0.4 * v / rate) << rate;
  }
}

// There the normal force has a level part too, so the rule of the step is that of before.
TEST(SlidingDiscAfterCoulomb, GoesDownASlopeAsBefore) {
  const double mu = 0.3, tilt = 0.4, g = 9.81;
  const double closed = 3.0 + 0.5 * g * (std::sin(tilt) - mu * std::cos(tilt));
  EXPECT_EQ(slide_of_disc(240, tilt, 1.0, 6), slide_of_disc(240, tilt, 1.0, 5));
  EXPECT_NEAR(slide_of_disc(240, tilt, 1.0, 6), closed, 0.0025);
}

TEST(SmoothBall, SlidesForEverWithoutTurning) {
  Thrown t = sliding_ball(240, {0.7, 0.0});
  run(t.world, 3.0);
  EXPECT_EQ(t.world.states[t.ball].v_WB.y(), 6.0);
  EXPECT_EQ(t.world.states[t.ball].w_WB, Vec3::Zero());
}

TEST(PerfectlyRoughBall, RollsFromTheFirstStep) {
  Thrown t = sliding_ball(240, {0.7, 1.0});
  step(t.world);
  EXPECT_NEAR(t.slip(), 0.0, 1e-12);
}

// A round rod that rolls on its side carries its load an arm b ahead of its middle: it slows by
// b g / (r (1 + I / (m r^2))), I being its inertia about its axis.
TEST(LyingSkittle, IsBroughtToRestByItsRollingArm) {
  const double r = 0.05, m = 1.5, axial = 0.5 * m * r * r, b = 0.005;
  Body rod = skittle_body({0.7, 1.0, b});
  rod.shape = make_compound({{Cylinder{r, 0.15}, Pose{}}});
  rod.inertia = Vec3(0.0122, 0.0122, axial).asDiagonal();
  for (const int rate : {60, 240, 1000}) {
    World world = make_world({.rate_hz = rate});
    add_body(world, floor_body({0.7, 1.0}));
    State s;
    s.X_WB = {rotation(Vec3(0.0, 1.57079632679489662, 0.0)), Vec3(0.0, 0.0, r)};  // axis along x
    s.v_WB = Vec3(0.0, 1.0, 0.0);
    s.w_WB = Vec3(-1.0 / r, 0.0, 0.0);
    const BodyId i = add_body(world, rod, s);
    run(world, 0.5);
    const double slows = b * 9.81 / (r * (1.0 + axial / (m * r * r)));
    EXPECT_NEAR(world.states[i].v_WB.y(), 1.0 - 0.5 * slows, 0.01 * 0.5 * slows) << rate;
    run(world, 2.5);
    EXPECT_TRUE(is_asleep(world, i)) << rate;
  }
}

// A ball has no axis of its own: it slows alike whichever way it is turned and rolls.
TEST(HeavyBall, IsSlowedByItsRollingArmAboutAnyAxis) {
  const double b = 0.002, v = 1.0;
  const double slows = b * 9.81 / (kBallRadius * 1.4);
  for (const Vec3& turned : {Vec3(0, 0, 0), Vec3(1.1, 0, 0), Vec3(0.3, 0.9, -0.4)}) {
    for (const double way : {0.0, 0.7, 2.0}) {
      World world = make_world({});
      add_body(world, floor_body({0.7, 1.0}));
      const BodyId i = add_body(world, ball_body({0.7, 1.0, b}),
                                at(Pose{rotation(turned), Vec3(0.0, 0.0, kBallRadius)},
                                   v * Vec3(std::cos(way), std::sin(way), 0.0),
                                   v / kBallRadius * Vec3(-std::sin(way), std::cos(way), 0.0)));
      run(world, 2.0);
      EXPECT_NEAR(world.states[i].v_WB.norm(), v - 2.0 * slows, 0.01 * 2.0 * slows) << way;
    }
  }
}

// Also where it turns far within a step, and the overlap that gravity makes in a step is deep for it.
TEST(HeavyBall, IsSlowedByItsRollingArmHoweverFastItTurns) {
  const double b = 0.002;
  const double slows = b * 9.81 / (kBallRadius * 1.4);
  for (const double v : {1.0, 2.0, 4.0, 8.0}) {
    World world = make_world({.rate_hz = 60});
    add_body(world, floor_body({0.7, 1.0}));
    const BodyId i = add_body(world, ball_body({0.7, 1.0, b}),
                              at(Pose{Quat::Identity(), Vec3(0.0, 0.0, kBallRadius)},
                                 Vec3(0.0, v, 0.0), Vec3(-v / kBallRadius, 0.0, 0.0)));
    run(world, 2.0);
    EXPECT_NEAR(world.states[i].v_WB.norm(), v - 2.0 * slows, 0.01 * 2.0 * slows) << v;
  }
}

// Coulomb: with backspin it slows by mu g as without, but for its first step, in which it lands. Under rules 13
// it kept 0.78 of the 0.98 m/s at 60 Hz.
TEST(SlidingBallAfterCoulomb, SlowsByMuGWithBackspin) {
  const double mu = 0.1, v = 7.0, turned = 2.5 * mu * 9.81 / kBallRadius;
  for (const int rate : {50, 60, 80, 240}) {
    Thrown t = sliding_ball(rate, {0.7, std::sqrt(mu)}, "coulomb");
    State& s = t.world.states[t.ball];
    s.v_WB = Vec3(0.0, v, 0.0);
    s.w_WB = Vec3(30.0, 0.0, 0.0);
    run(t.world, 1.0);
    EXPECT_NEAR(t.world.states[t.ball].v_WB.y(), v - mu * 9.81, mu * 9.81 / rate) << rate;
    EXPECT_NEAR(t.world.states[t.ball].w_WB.x(), 30.0 - turned, turned / rate) << rate;
  }
}

}  // namespace
}  // namespace headpin::engine
