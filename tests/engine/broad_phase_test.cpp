#include "engine/broad_phase.h"

#include <gtest/gtest.h>

#include "tests/support/random_shapes.h"

namespace headpin::engine {
namespace {

Vec3 point(Random& random, double r) {
  return {random.uniform(-r, r), random.uniform(-r, r), random.uniform(-r, r)};
}

std::vector<Capsule> random_capsules(Random& random, int n, double room) {
  std::vector<Capsule> capsules;
  for (int i = 0; i < n; ++i) {
    const Vec3 a = point(random, room);
    const double length = i % 50 == 0 ? room : i % 3 == 0 ? 0.0 : 0.4;  // walls, balls, skittles
    capsules.push_back({a, a + length * direction(random), random.uniform(0.02, 0.15)});
  }
  return capsules;
}

// Sampled distance between two segments, and the capsules' distance beside it.
TEST(CapsuleDistance, IsThatOfTheNearestSamples) {
  Random random(8);
  for (int i = 0; i < 200; ++i) {
    Capsule a{point(random, 1.0), point(random, 1.0), 0.1},
        b{point(random, 1.0), point(random, 1.0), 0.2};
    if (i % 4 == 0) b.b = b.a + 0.7 * (a.b - a.a);  // parallel
    if (i % 7 == 0) a.b = a.a;
    if (i % 9 == 0) b.b = b.a;
    double least = 1e9;
    for (int s = 0; s <= 400; ++s) {
      for (int t = 0; t <= 400; ++t) {
        least =
            std::min(least, (a.a + s / 400.0 * (a.b - a.a) - b.a - t / 400.0 * (b.b - b.a)).norm());
      }
    }
    EXPECT_LE(distance(a, b), least - 0.3 + 1e-12);
    EXPECT_NEAR(distance(a, b), least - 0.3, 0.01);  // half a sample of length 3.5 / 400
  }
}

TEST(BroadPhase, FindsThePairsThatABruteSearchFinds) {
  Random random(9);
  BroadPhase broad_phase;
  for (const int n : {0, 1, 2, 10, 100, 600}) {
    const std::vector<Capsule> capsules = random_capsules(random, n, 0.15 * std::cbrt(n + 1));
    for (const double margin : {0.0, 0.05}) {
      std::vector<Pair> expected, expected_moving;
      std::vector<std::uint8_t> moving(capsules.size());
      for (std::uint8_t& m : moving) m = static_cast<std::uint8_t>(index_below(random, 2));
      for (std::uint32_t i = 0; i < capsules.size(); ++i) {
        for (std::uint32_t j = i + 1; j < capsules.size(); ++j) {
          if (distance(capsules[i], capsules[j]) > margin) continue;
          expected.push_back({i, j});
          if (moving[i] || moving[j]) expected_moving.push_back({i, j});
        }
      }
      EXPECT_EQ(broad_phase.find_pairs(capsules, {}, margin), expected);
      EXPECT_EQ(broad_phase.find_pairs(capsules, moving, margin), expected_moving);
    }
  }
}

// The capsule around a plate is wide, so balls beside the plate seem to meet it. Its box leaves most of them out, but
// none that is near: a clamped point gives the distance.
TEST(BroadPhase, LeavesOutWhatIsBesideAPlateAndNothingNear) {
  Random random(10);
  BroadPhase broad_phase;
  const Vec3 half(0.5, 0.6, 0.02);
  const Compound plate = make_compound({{test::box(half), {}}});
  EXPECT_EQ(plate.box.low, -half);
  EXPECT_EQ(plate.box.high, half);
  int round = 0, limited = 0;
  for (int i = 0; i < 2000; ++i) {
    const Pose X_WB{i % 2 == 0 ? Quat::Identity() : rotation(point(random, 3.0)),
                    point(random, 1.0)};
    const Capsule ball{X_WB * point(random, 1.2), Vec3::Zero(), random.uniform(0.01, 0.2)};
    const std::vector<Capsule> bounds{X_WB * plate.bounds, {ball.a, ball.a, ball.radius}};
    const std::vector<Box> limits{X_WB * plate.box, {}};
    const Vec3 p_B = X_WB.inverse() * ball.a;
    const double gap = (p_B - p_B.cwiseMax(-half).cwiseMin(half)).norm() - ball.radius;
    const std::size_t found = broad_phase.find_pairs(bounds, {}, 0.01, limits).size();
    if (gap <= 0.01) {
      ASSERT_EQ(found, 1u) << gap;
    }
    limited += static_cast<int>(found);
    round += static_cast<int>(broad_phase.find_pairs(bounds, {}, 0.01).size());
  }
  EXPECT_LT(limited, 0.75 * round);
}

// Ten skittles on their spots do not touch each other's bounds, though their spheres overlap.
TEST(TenStandingSkittles, MakeNoPair) {
  const Compound skittle =
      make_compound({{Cylinder{0.0258, 0.03}, {Quat::Identity(), {0, 0, 0.03}}},
                     {Ellipsoid{{0.0605, 0.0605, 0.11}}, {Quat::Identity(), {0, 0, 0.116}}},
                     {Cylinder{0.0235, 0.08}, {Quat::Identity(), {0, 0, 0.26}}},
                     {Ellipsoid{{0.0325, 0.0325, 0.0325}}, {Quat::Identity(), {0, 0, 0.3485}}}});
  std::vector<Capsule> bounds;
  for (int row = 0; row < 4; ++row) {
    for (int i = 0; i <= row; ++i) {
      const Vec3 spot(0.3048 * (i - 0.5 * row), 0.3048 * 0.8660254 * row, 0.0);
      bounds.push_back(Pose{Quat::Identity(), spot} * skittle.bounds);
    }
  }
  BroadPhase broad_phase;
  EXPECT_TRUE(broad_phase.find_pairs(bounds).empty());
  EXPECT_LT(skittle.bounds.radius, 0.061);
  // A ball beside the head pin is one pair.
  bounds.push_back({Vec3(0.1, -0.1, 0.108), Vec3(0.1, -0.1, 0.108), 0.108});
  EXPECT_EQ(broad_phase.find_pairs(bounds), (std::vector<Pair>{{0, 10}}));
}

}  // namespace
}  // namespace headpin::engine
