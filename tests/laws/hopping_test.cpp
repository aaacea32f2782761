// What equation (9) makes of slip where elasticity is 1 (EFS 010 and 011 of table 1).
//
// For a ball of radius r on a floor that does not move, K is 1/m along the normal and 7/(2 m) across
// it. Smooth and elastic the approach w comes back; rough and elastic all the energy of the meeting
// point goes into the normal, k = sqrt(w^2 + 2/7 s^2), and none of the slip s is left. Between them,
// with elasticities 1 and a pair's friction mu, the impulses are mixed:
//   w' = (1 - mu) w + mu sqrt(w^2 + 2/7 s^2),    s' = (1 - mu) s.
// So slip becomes height: a ball hops, the higher the faster it slides, and nothing takes the height
// from it again.

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/bowling.h"

namespace headpin::engine {
namespace {

constexpr double kMu = 0.49;  // 0.7 and 0.7

struct Hop {
  double approach, slip;  ///< of the ball as it meets the lane [m/s]
};

Hop after(const Hop& h) {
  const double rough = std::sqrt(h.approach * h.approach + 2.0 / 7.0 * h.slip * h.slip);
  return {(1.0 - kMu) * h.approach + kMu * rough, (1.0 - kMu) * h.slip};
}

/// Landings of a ball that was let go level, not turning, so high above the lane.
std::vector<Hop> landings(double height, double speed, std::size_t count) {
  World world = make_world({.rate_hz = 240});
  add_body(world, floor_body({1.0, 0.7}));
  const BodyId ball = add_body(world, ball_body({1.0, 0.7}),
                               at(Vec3(0.0, 0.0, kBallRadius + height), Vec3(0.0, speed, 0.0)));
  std::vector<Hop> found;
  while (found.size() < count && world.tick < 10'000) {
    const State before = world.states[ball];
    step(world);
    for (const ContactEvent& e : world.events) {
      found.push_back({e.approach_speed, before.v_WB.y() + before.w_WB.x() * kBallRadius});
    }
  }
  return found;
}

TEST(HoppingBall, TurnsSlipIntoHeightAsEquationNineSays) {
  for (const double height : {0.03, 0.1, 0.47}) {
    const double g = 9.81, speed = 6.5;
    const std::vector<Hop> found = landings(height, speed, 6);
    ASSERT_EQ(found.size(), 6u) << height;
    // A landing is found within a step, in which gravity adds 0.04 m/s.
    EXPECT_NEAR(found[0].approach, std::sqrt(2.0 * g * height), 0.05);
    EXPECT_NEAR(found[0].slip, speed, 1e-9);
    // Now and then it is taken for a contact that lasts a step, which has friction of its own.
    const double step_more = std::pow(1.0 - kMu, 60.0 / 240.0);
    for (std::size_t i = 1; i < found.size(); ++i) {
      const Hop expected = after(found[i - 1]);
      EXPECT_NEAR(found[i].approach, expected.approach, 0.05) << height << " " << i;
      EXPECT_LT(found[i].slip, expected.slip + 1e-6) << height << " " << i;
      EXPECT_GT(found[i].slip, step_more * expected.slip - 1e-6) << height << " " << i;
    }
  }
}

// Laid down it hops to below the top of a skittle, let go from half a metre to twice as high as one.
TEST(HoppingBall, HopsOverSkittlesWhereItWasNotLaidDown) {
  const double skittle = 0.381, g = 9.81;
  const auto top = [&](double height) {
    const double w = landings(height, 6.5, 8).back().approach;
    return w * w / (2.0 * g);
  };
  EXPECT_LT(top(0.03), 0.9 * skittle);
  EXPECT_GT(top(0.47), 2.0 * skittle);
}

}  // namespace
}  // namespace headpin::engine
