#include "engine/non_colliding.h"

#include <gtest/gtest.h>

#include "tests/support/random_shapes.h"

namespace headpin::engine {
namespace {

using test::Kind;
using test::Random;

TEST(TwoSpheres, AreAsFarApartAsTheirCentresLessTheirRadii) {
  for (const double gap : {0.5, 1e-3, 1e-9, -1e-9, -1e-3, -0.2}) {
    const Vec3 line = Vec3(1.0, 2.0, -0.5).normalized();
    Vec3 n = Vec3::Zero();
    const Closest c = closest_points(Ellipsoid{{0.3, 0.3, 0.3}}, Ellipsoid{{0.2, 0.2, 0.2}},
                                     {Quat::Identity(), (0.5 + gap) * line}, n, {});
    EXPECT_EQ(c.separated, gap > 0.0);
    EXPECT_NEAR(c.distance, gap, 1e-12);
    EXPECT_LT((c.n_AB - line).norm(), 1e-9);
    EXPECT_LT((c.p_A - 0.3 * line).norm(), 1e-9);
    EXPECT_LT((c.p_B - (0.3 + gap) * line).norm(), 1e-9);
  }
}

}  // namespace
}  // namespace headpin::engine
