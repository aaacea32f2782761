#include <gtest/gtest.h>

#include "tests/support/bowling.h"
#include "tests/support/scale.h"

namespace headpin::engine {
namespace {

/// Cylinders 0.1 m high and 0.2 m wide on each other; the masses from below.
struct Stack {
  World world;
  std::vector<BodyId> bodies = {};
};

Stack stack(const std::vector<double>& masses, int rate_hz, std::string_view response) {
  Stack s{make_world({.rate_hz = rate_hz, .response = response, .sleep = false})};
  const Material rough{0.7, 0.7};
  add_body(s.world, floor_body(rough));
  for (std::size_t i = 0; i < masses.size(); ++i) {
    Body body = ball_body(rough, 0.1, masses[i]);
    body.shape = make_compound({{Cylinder{0.1, 0.05}, Pose{}}});
    body.inertia = masses[i] * Vec3(0.0033, 0.0033, 0.005).asDiagonal();
    s.bodies.push_back(
        add_body(s.world, body, at(Vec3(0.0, 0.0, 0.05 + 0.1 * static_cast<double>(i)))));
  }
  return s;
}

/// After ten seconds: how far the uppermost is from where it was put.
double moved(Stack s) {
  const Vec3 start = s.world.states[s.bodies.back()].X_WB.p;
  run(s.world, 10.0);
  return (s.world.states[s.bodies.back()].X_WB.p - start).norm();
}

TEST(Stack, OfTwentyStandsUnderCoulomb) {
  for (const int rate : {60, 240}) {
    if (!kThorough && rate == 240) continue;
    EXPECT_LE(moved(stack(std::vector<double>(20, 1.0), rate, "coulomb")), 2e-3) << rate;
  }
}

TEST(Stack, OfTenStandsUnderThePapersRate) {
  EXPECT_LE(moved(stack(std::vector<double>(10, 1.0), 240, "paper")), 2e-3);
}

TEST(Stack, CarriesAHundredfoldMassUnderCoulomb) {
  for (const int rate : {60, 240}) {
    EXPECT_LE(moved(stack({1.0, 1.0, 1.0, 100.0}, rate, "coulomb")), 1e-2) << rate;
  }
}

// Friction 1 binds every contact that presses.
TEST(PerfectlyRoughGame, IsSolvedAtEveryRate) {
  for (const int rate : {60, 240, 1000}) {
    if (!kThorough && rate != 240) continue;
    Statistics sum;
    for (const double offset : {-0.1, -0.08, -0.03, 0.02, 0.06, 0.1}) {
      RackOptions o;
      o.parameters.rate_hz = rate;
      o.material = {0.7, 1.0};
      o.ball_offset = offset;
      Bowling b = bowling(o);
      while (b.world.tick < 5 * rate) {
        step(b.world);
        sum += b.world.statistics;
      }
    }
    EXPECT_GT(sum.islands, 4000) << rate;
    EXPECT_LE(sum.unsolved * 1000, sum.islands) << rate;
    EXPECT_LE(sum.residual, 1e-4) << rate;  // [m/s]; asked for are 1e-6
  }
}

}  // namespace
}  // namespace headpin::engine
