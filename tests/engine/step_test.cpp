// What a whole step keeps and counts, of a body or two whose motion is known.

#include <algorithm>

#include <gtest/gtest.h>

#include "engine/save.h"
#include "tests/support/bowling.h"

namespace headpin::engine {
namespace {

constexpr double kBallMass = 7.0, kFall = 9.81, kTick = 1.0 / 240.0;

/// A ball, body 1, over a floor, body 0; the ledger is kept.
World ball_on_floor(double gap, const Vec3& v, const Parameters& changed = {}) {
  Parameters p = changed;
  p.keep_ledger = true;
  World world = make_world(p);
  add_body(world, floor_body({0.5, 0.5}));
  add_body(world, ball_body({0.5, 0.5}, kBallRadius, kBallMass),
           at(Vec3(0.0, 0.0, kBallRadius + gap), v));
  return world;
}

void expect_balance(const Balance& is, double energy, double up) {
  EXPECT_NEAR(is.energy, energy, 1e-9);
  EXPECT_LT((is.momentum - Vec3(0.0, 0.0, up)).norm(), 1e-9);
}

TEST(Statistics, AreSummedOneByOneAndLargestValuesAreTheLargest) {
  Statistics a{1, 2, 3, {4, 5, 6}, 7, 8, 9, 10, 11, 12, 0.25, 0.5, 13};
  a += {100, 200, 300, {400, 500, 600}, 700, 800, 900, 1000, 1100, 1200, 0.125, 0.75, 1300};
  EXPECT_EQ(a.steps, 101);
  EXPECT_EQ(a.pairs, 202);
  EXPECT_EQ(a.contacts, 303);
  EXPECT_EQ(a.queries.queries, 404);
  EXPECT_EQ(a.queries.iterations, 505);
  EXPECT_EQ(a.queries.capped, 606);
  EXPECT_EQ(a.impacts, 707);
  EXPECT_EQ(a.unfinished_impacts, 808);
  EXPECT_EQ(a.pulls, 909);
  EXPECT_EQ(a.islands, 1010);
  EXPECT_EQ(a.solver_iterations, 1111);
  EXPECT_EQ(a.unsolved, 1212);
  EXPECT_EQ(a.residual, 0.25);
  EXPECT_EQ(a.deepest_overlap, 0.75);
  EXPECT_EQ(a.awake, 1313);
}

// "A supported body gains the fall of one step, which `sustained` takes away again."
TEST(Ledger, OfAStepOfABallThatLiesIsGravityAndWhatCarriesIt) {
  World world = ball_on_floor(0.0, Vec3::Zero());
  step(world);
  const double dv = kFall * kTick, energy = 0.5 * kBallMass * dv * dv;
  expect_balance(world.ledger.sustained, -energy, kBallMass * dv);
  expect_balance(world.ledger.gravity, energy, -kBallMass * dv);
  expect_balance(world.ledger.correction, 0.0, 0.0);
  expect_balance(world.ledger.impact, 0.0, 0.0);
}

TEST(Ledger, OfAStepOfABallThatFliesIsGravityAlone) {
  World world = ball_on_floor(1.0, Vec3(2.0, 0.0, 3.0));
  step(world);
  expect_balance(world.ledger.gravity, 0.0, -kBallMass * kFall * kTick);
  for (const Balance& b : {world.ledger.sustained, world.ledger.correction, world.ledger.impact}) {
    expect_balance(b, 0.0, 0.0);
  }
}

// Elasticities of 0.5 each leave a quarter of the speed: 15/16 of the energy is lost.
TEST(Ledger, OfAStepWithAnImpactHasItsLoss) {
  World world = ball_on_floor(0.0, Vec3(0.0, 0.0, -4.0), {.gravity_W = Vec3::Zero()});
  step(world);
  expect_balance(world.ledger.impact, -0.5 * kBallMass * 15.0, kBallMass * 5.0);
  for (const Balance& b : {world.ledger.sustained, world.ledger.correction, world.ledger.gravity}) {
    expect_balance(b, 0.0, 0.0);
  }
}

TEST(Ledger, OfAStepThatCorrectsAnOverlapHasTheHeight) {
  World world = ball_on_floor(-1e-3, Vec3::Zero());
  step(world);
  const double rise = world.states[1].X_WB.p.z() - (kBallRadius - 1e-3);
  EXPECT_GT(rise, 1e-5);
  expect_balance(world.ledger.correction, kBallMass * kFall * rise, 0.0);
}

// What still moves a little when it falls asleep loses that energy.
TEST(Ledger, OfAStepInWhichABallFallsAsleepHasItsLastEnergy) {
  World world = ball_on_floor(0.0, Vec3(0.002, 0.0, 0.0));
  world.states[1].w_WB = Vec3(0.0, 0.002 / kBallRadius, 0.0);
  while (!is_asleep(world, 1) && world.tick < 480) step(world);
  ASSERT_TRUE(is_asleep(world, 1));
  const Balance now = balance(world), sum = world.ledger.sum();
  EXPECT_EQ(world.states[1].v_WB, Vec3(Vec3::Zero()));
  EXPECT_NEAR(sum.momentum.x(), now.momentum.x(), 1e-12);
  EXPECT_NEAR(world.ledger.sustained.momentum.x(), -kBallMass * 0.002, 1e-9);
  EXPECT_NEAR(world.ledger.gravity.momentum.x(), 0.0, 1e-9);
}

TEST(AStep, OfAWorldInWhichNothingMovesForgetsItsContacts) {
  World world = ball_on_floor(0.0, Vec3::Zero());
  add_body(world, ball_body({0.5, 0.5}), at(Vec3(2.0 * kBallRadius, 0.0, kBallRadius)));
  step(world);
  ASSERT_FALSE(world.memory.candidates.empty());
  ASSERT_FALSE(world.memory.normals.empty());
  ASSERT_FALSE(world.memory.touches.empty());
  ASSERT_FALSE(world.memory.loads.empty());
  world.asleep[1] = world.asleep[2] = 1;
  world.roll.made = false;
  step(world);
  EXPECT_TRUE(world.memory.candidates.empty());
  EXPECT_TRUE(world.memory.normals.empty());
  EXPECT_TRUE(world.memory.touches.empty());
  EXPECT_TRUE(world.memory.loads.empty());
  EXPECT_EQ(world.tick, 2);
}

// A step's queries are its own, also in a workspace that has made others.
TEST(AStep, CountsItsQueriesAnewInAUsedWorkspace) {
  Bowling b = bowling({.parameters = {}, .ball_distance = 0.2});
  World other = b.world;
  Workspace used;
  std::int64_t queries = 0;
  for (int tick = 0; tick < 40; ++tick) {
    Workspace fresh;
    step(b.world, used);
    step(other, fresh);
    ASSERT_EQ(b.world.statistics.queries.queries, other.statistics.queries.queries) << tick;
    ASSERT_EQ(b.world.statistics.queries.iterations, other.statistics.queries.iterations) << tick;
    queries += b.world.statistics.queries.queries;
  }
  EXPECT_GT(queries, 400);
}

TEST(AStep, StopsWhatWouldSwingIntoTheFloor) {
  World world = make_world({.rate_hz = 60, .gravity_W = Vec3::Zero()});
  add_body(world, floor_body({0.0, 0.0}));
  Body rod = ball_body({0.0, 0.0});
  rod.shape = make_compound(
      {{Cylinder{0.01, 0.5}, {rotation({0.0, 0.5 * 3.14159265, 0.0}), Vec3::Zero()}}});
  const BodyId i = add_body(world, rod, at(Vec3(0.0, 0.0, 0.2), Vec3::Zero(), Vec3(0, 30.0, 0)));
  for (int tick = 0; tick < 10; ++tick) {
    step(world);
    const double dip = 0.5 * std::abs(world.states[i].X_WB.q.toRotationMatrix()(2, 0));
    EXPECT_GT(world.states[i].X_WB.p.z() - dip, -0.02) << tick;
  }
}

// Bodies that an impact makes faster find each other late; what is remembered is in order again.
TEST(AStep, RemembersItsPairsInTheOrderOfTheirKeys) {
  Bowling b = bowling({.parameters = {}, .ball_distance = 0.15});
  const World made = b.world;
  const BodyId skittle = b.skittles[0];
  for (int tick = 0; tick < 60; ++tick) {
    step(b.world);
    const std::vector<Candidate>& c = b.world.memory.candidates;
    for (std::size_t k = 1; k < c.size(); ++k) ASSERT_LT(c[k - 1].key, c[k].key) << tick;
    ASSERT_NO_THROW(restore(made, save(b.world))) << tick;
  }
  const std::uint64_t met =
      key_of(false, std::min(skittle, b.balls[0]), std::max(skittle, b.balls[0]));
  EXPECT_TRUE(std::binary_search(b.world.memory.met.begin(), b.world.memory.met.end(), met));
}

TEST(AStep, RemembersThePairsWhoseBoundsMeet) {
  World world = make_world({.gravity_W = Vec3::Zero()});
  for (const double x : {0.0, 2.0 * kBallRadius, 5.0}) {
    add_body(world, ball_body({}), at(Vec3(x, 0.0, 0.0)));
  }
  step(world);
  ASSERT_EQ(world.memory.candidates.size(), 1u);
  EXPECT_EQ(world.memory.candidates[0].key, key_of(true, 0, 1));
  ASSERT_EQ(world.memory.normals.size(), 1u);
  EXPECT_EQ(world.memory.normals[0].of, KeptNormal::met);
}

}  // namespace
}  // namespace headpin::engine
