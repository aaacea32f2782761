#include "engine/kept_plane.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/engine/shape_pairs.h"
#include "tests/support/random_shapes.h"

namespace headpin::engine {
namespace {

// The gap along the kept normal is that of the support points: a little less of a margin is proven, a little
// more is not.
TEST(AKeptPlane, SeparatesByTheGapOfTheSupportPoints) {
  test::Pool pool(71);
  for (int i = 0; i < 800; ++i) {
    const Shape &a = pool.pick(i % 4), &b = pool.pick(i / 4 % 4);
    const Pose X_AB{any_rotation(pool.random),
                    pool.random.uniform(0.5, 2.0) * direction(pool.random)};
    const KeptNormal kept{direction(pool.random), KeptNormal::apart};
    const double gap = -test::depth_along(a, b, X_AB, kept.n_AB);
    const Pose X_WA{any_rotation(pool.random), direction(pool.random)}, X_WB = X_WA * X_AB;
    for (const double off : {-1e-9, 1e-9}) {
      EXPECT_EQ(still_apart(a, X_WA, b, X_WB, kept, gap + off), off < 0.0);
      EXPECT_EQ(still_apart(a, b, X_AB.q.toRotationMatrix(), X_AB.p, kept, gap + off), off < 0.0);
    }
  }
}

// More than the margin is asked for, of a normal of length 1.
TEST(AKeptPlane, NeedsMoreThanTheMarginAndAUnitNormal) {
  const Shape ball = Ellipsoid{{0.5, 0.5, 0.5}};
  const Pose X_AB{Quat::Identity(), {2.0, 0.0, 0.0}};
  const auto apart = [&](double length, double margin) {
    const KeptNormal kept{length * Vec3::UnitX(), KeptNormal::apart};
    const bool posed = still_apart(ball, {}, ball, X_AB, kept, margin);
    EXPECT_EQ(still_apart(ball, ball, Mat3::Identity(), X_AB.p, kept, margin), posed);
    return posed;
  };
  EXPECT_FALSE(apart(1.0, 1.0));
  EXPECT_TRUE(apart(1.0, std::nextafter(1.0, 0.0)));
  for (const double length : {0.0, 0.5, 1.001, 2.0}) EXPECT_FALSE(apart(length, -9.0)) << length;
}

}  // namespace
}  // namespace headpin::engine
