#include <gtest/gtest.h>

#include "tests/support/bowling.h"
#include "tests/support/random_shapes.h"

namespace headpin::engine {
namespace {

RackOptions kept() {
  RackOptions o;
  o.parameters.keep_ledger = true;
  return o;
}

void expect_same(const Balance& a, const Balance& b, double tolerance) {
  EXPECT_NEAR(a.energy, b.energy, tolerance);
  EXPECT_NEAR((a.momentum - b.momentum).norm(), 0.0, tolerance);
  EXPECT_NEAR((a.angular_momentum - b.angular_momentum).norm(), 0.0, tolerance);
}

TEST(Ledger, AddsUpToWhatTheBodiesHave) {
  Bowling b = bowling(kept());
  run(b.world, 3.0);
  // Some 200 J and 40 kg m/s went through 720 steps of rounding.
  expect_same(b.world.ledger.sum(), balance(b.world), 1e-9);
}

// Impulses only ever take energy (paper_impulse); lasting contacts too, to the solver's residual.
TEST(Ledger, ShowsThatContactsOnlyTakeEnergy) {
  for (const double elasticity : {0.0, 0.7, 1.0}) {
    for (const double friction : {0.0, 0.7, 1.0}) {
      RackOptions o = kept();
      o.material = {elasticity, friction};
      Bowling b = bowling(o);
      const double start = balance(b.world).energy;
      for (int i = 0; i < 3 * 240; ++i) {
        const Ledger before = b.world.ledger;
        step(b.world);
        const Ledger& after = b.world.ledger;
        EXPECT_LE(after.impact.energy - before.impact.energy, 1e-12 * start);
        EXPECT_LE(after.sustained.energy - before.sustained.energy, 1e-9 * start)
            << elasticity << " " << friction << " tick " << i;
      }
    }
  }
}

TEST(Ledger, ChargesFreeFlightWithNothingButTheFall) {
  World world = make_world({.keep_ledger = true});
  add_body(world, skittle_body({}), at(Vec3::Zero(), Vec3(1.0, 2.0, 3.0), Vec3(4.0, -5.0, 6.0)));
  const Balance start = balance(world);
  run(world, 1.0);
  expect_same(world.ledger.hand, start, 1e-12);  // it was put there
  EXPECT_NEAR(world.ledger.gravity.energy, 0.0, 1e-11);
  EXPECT_NEAR((world.ledger.gravity.momentum - Vec3(0, 0, -1.5 * 9.81)).norm(), 0.0, 1e-11);
  expect_same(world.ledger.impact, {}, 0.0);
  expect_same(world.ledger.sustained, {}, 0.0);
  expect_same(world.ledger.correction, {}, 0.0);
}

// Impacts fall anywhere into a step; what flies before and after them gains nothing by gravity.
TEST(Ledger, FindsNoEnergyInTheFallOfABouncingBody) {
  for (const int rate : {60, 240, 1000}) {
    World world = make_world({.rate_hz = rate, .keep_ledger = true});
    add_body(world, floor_body({1.0, 0.0}));
    add_body(world, skittle_body({1.0, 0.0}),
             at(Pose{rotation(Vec3(0.4, 0.3, 0.0)), Vec3(0.0, 0.0, 1.0)}));
    for (int i = 0; i < 3 * rate; ++i) {
      step(world);
      if (world.statistics.contacts > 0) continue;  // carried for a moment
      EXPECT_NEAR(world.ledger.sum().energy, balance(world).energy, 1e-10);
    }
    const Ledger& l = world.ledger;
    EXPECT_NEAR(l.gravity.energy + l.sustained.energy, 0.0, 0.02 * l.hand.energy) << rate;
    EXPECT_NEAR(l.impact.energy, 0.0, 1e-10);
  }
}

TEST(Ledger, ShowsThatCorrectionGivesHardlyAnyEnergy) {
  for (const int rate : {120, 240, 1000}) {
    RackOptions o = kept();
    o.parameters.rate_hz = rate;
    Bowling b = bowling(o);
    const double start = balance(b.world).energy;
    run(b.world, 3.0);
    const Ledger& l = b.world.ledger;
    EXPECT_GE(l.correction.energy, 0.0) << rate;
    EXPECT_LE(l.correction.energy, 1e-3 * start) << rate;
    // What is carried gains the fall of a step, which its contacts take away again.
    EXPECT_LE(l.gravity.energy + l.sustained.energy, 0.0) << rate;
  }
}

TEST(Ledger, OfAWorldAtRestNoticesWhatAHandChanges) {
  RackOptions o = kept();
  o.ball = false;
  Bowling b = bowling(o);
  run(b.world, 2.0);
  ASSERT_EQ(b.world.statistics.contacts, 0);  // all sleep: the step was cut short
  State s = b.world.states[b.skittles[3]];
  const double hand = b.world.ledger.hand.energy;
  s.X_WB.p.z() += 0.5;
  set_state(b.world, b.skittles[3], s);
  put_to_sleep(b.world, b.skittles[3]);  // it hangs there
  step(b.world);
  EXPECT_NEAR(b.world.ledger.hand.energy - hand, 1.5 * 9.81 * 0.5, 1e-9);
  run(b.world, 0.1);
  EXPECT_NEAR(b.world.ledger.hand.energy - hand, 1.5 * 9.81 * 0.5, 1e-9);
  expect_same(b.world.ledger.sum(), balance(b.world), 1e-9);
}

// Two free bodies: the impulse between them changes neither momentum.
TEST(Ledger, FindsNoMomentumInImpactsBetweenFreeBodies) {
  World world = make_world({.keep_ledger = true});
  world.parameters.gravity_W = Vec3::Zero();
  State s;
  add_body(world, skittle_body({}), s);
  s.X_WB.p = Vec3(0.05, -0.5, 0.03);
  s.v_WB = Vec3(0.0, 6.0, 0.0);
  add_body(world, ball_body({}), s);
  const Balance start = balance(world);
  run(world, 0.5);
  EXPECT_LT(world.ledger.impact.energy, -1.0);
  EXPECT_NEAR(world.ledger.impact.momentum.norm(), 0.0, 1e-12);
  const Balance end = balance(world);
  EXPECT_NEAR((end.momentum - start.momentum).norm(), 0.0, 1e-12);
  // Paths bend where bodies meet within the step, so this momentum holds as well; the turn of a
  // body within the step of its impact is of second order.
  EXPECT_NEAR((end.angular_momentum - start.angular_momentum).norm(), 0.0, 1e-9);
}

// A hand at V that strikes a ball at rest, smooth and elastic, gives it 2 V: all of it hand's work.
TEST(Ledger, ChargesAHandWithWhatItGives) {
  World world = make_world({.keep_ledger = true});
  world.parameters.gravity_W = Vec3::Zero();
  const Material smooth{1.0, 0.0};
  const BodyId ball = add_body(world, ball_body(smooth));
  Body hand = ball_body(smooth, 0.05, 1.0);
  hand.kind = Kind::driven;
  add_body(world, hand, at(Vec3(-0.3, 0.0, 0.0), Vec3(2.0, 0.0, 0.0)));
  run(world, 0.5);
  EXPECT_NEAR(world.states[ball].v_WB.x(), 4.0, 1e-12);
  EXPECT_NEAR(world.ledger.hand.energy, 0.5 * 7.0 * 16.0, 1e-9);
  EXPECT_NEAR(world.ledger.hand.momentum.x(), 28.0, 1e-9);
  EXPECT_NEAR(world.ledger.impact.energy, 0.0, 1e-12);
}

// A turntable that takes a cube with it: what it gives is the hand's, twist and all.
TEST(Ledger, ChargesATurntableWithTheTurnThatItGives) {
  for (const std::string_view response : {"paper", "coulomb"}) {
    World world = make_world({.response = response, .keep_ledger = true});
    Body plate = ball_body({0.7, 0.7});
    plate.shape = make_compound({{Cylinder{0.5, 0.01}, Pose{}}});
    plate.kind = Kind::driven;
    State s = at(Vec3(0.0, 0.0, -0.01), Vec3::Zero(), Vec3(0.0, 0.0, 3.0));
    add_body(world, plate, s);
    s = {};
    s.X_WB.p = Vec3(0.1, 0.0, 0.05);
    Body cube = ball_body({0.7, 0.7}, 0.05, 1.0);
    cube.shape = make_compound({{test::box({0.05, 0.05, 0.05}), Pose{}}});
    cube.inertia = Mat3::Identity() * (0.01 / 6.0);
    const BodyId i = add_body(world, cube, s);
    for (int k = 0; k < 240; ++k) {
      const double before = world.ledger.sustained.energy;
      step(world);
      EXPECT_LE(world.ledger.sustained.energy - before, 1e-9) << response << " tick " << k;
    }
    EXPECT_GT(world.states[i].w_WB.z(), 1.0) << response;
    EXPECT_GT(world.ledger.hand.energy, balance(world).energy) << response;
    // All forces but gravity are the hand's, so none of the momentum is the contacts' own.
    EXPECT_LT(world.ledger.sustained.momentum.norm(), 1e-9) << response;
    EXPECT_LT(world.ledger.sustained.angular_momentum.norm(), 1e-9) << response;
    EXPECT_GT(world.ledger.hand.momentum.z(), 9.0) << response;  // 1 kg carried for 1 s
    expect_same(world.ledger.sum(), balance(world), 1e-9);
  }
}

// A hand that carries a skittle up slowly: its work is the height gained.
TEST(Ledger, ChargesALiftingHandWithTheHeight) {
  World world = make_world({.keep_ledger = true});
  State s = at(Vec3(0.0, 0.0, kSkittleHeight));
  const BodyId skittle = add_body(world, skittle_body({0.7, 0.7, 0.005}), s);
  Body plate = ball_body({0.7, 0.7});
  plate.shape = make_compound({{Cylinder{0.2, 0.01}, Pose{}}});
  plate.kind = Kind::driven;
  s.X_WB.p = Vec3(0.0, 0.0, -0.01);
  s.v_WB = Vec3(0.0, 0.0, 0.1);
  add_body(world, plate, s);
  run(world, 0.1);  // it has taken up the speed of the plate
  const double before = world.ledger.hand.energy;
  run(world, 1.0);
  EXPECT_NEAR(world.states[skittle].X_WB.p.z(), kSkittleHeight + 0.11, 1e-3);
  EXPECT_NEAR(world.ledger.hand.energy - before, 1.5 * 9.81 * 0.1, 1e-2 * 1.5 * 9.81 * 0.1);
}

}  // namespace
}  // namespace headpin::engine
