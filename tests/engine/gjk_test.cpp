#include "engine/gjk.h"

#include <algorithm>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace headpin::engine {
namespace {

/// What A and B had where their difference is w.
Vec3 of_A(const Vec3& w) {
  return 2.0 * w + Vec3(1.0, -1.0, 3.0);
}
Vec3 of_B(const Vec3& w) {
  return of_A(w) - w;
}

/// Expects that the simplex of these points, reduced, has the nearest of all points between them: none of them
/// is nearer along the way to it. What is left of the simplex is that point as a mean with no useless corner.
void expect_nearest(const std::vector<Vec3>& points, const Vec3& from, double scale) {
  Simplex s;
  for (const Vec3& w : points) s.add(w, of_A(w), of_B(w));
  const Vec3 v = s.reduce(from);
  ASSERT_GT(s.count, 0);
  ASSERT_LE(s.count, static_cast<int>(points.size()));
  for (const Vec3& w : points) ASSERT_GE(v.dot(w - from - v), -1e-10 * scale * scale);
  Vec3 mean = Vec3::Zero();
  double sum = 0.0;
  for (int i = 0; i < s.count; ++i) {
    ASSERT_GT(s.weight[i], 0.0);
    ASSERT_TRUE(std::find(points.begin(), points.end(), s.w[i]) != points.end());
    ASSERT_EQ(s.a[i], of_A(s.w[i]));
    ASSERT_EQ(s.b[i], of_B(s.w[i]));
    mean += s.weight[i] * s.w[i];
    sum += s.weight[i];
  }
  ASSERT_NEAR(sum, 1.0, 1e-13);
  ASSERT_NEAR((mean - from - v).norm(), 0.0, 1e-13 * scale);
  ASSERT_NEAR((s.p_A() - of_A(mean)).norm(), 0.0, 1e-13 * (scale + 10.0));
  ASSERT_NEAR((s.p_B() - of_B(mean)).norm(), 0.0, 1e-13 * (scale + 10.0));
  if (s.count == 4) {
    ASSERT_NEAR(v.norm(), 0.0, 1e-13 * scale);
  }
}

/// A point of a small lattice, so that points often lie on a line or a plane with others, or on each other.
Vec3 on_lattice(std::mt19937& random) {
  const auto number = [&] { return static_cast<double>(random() % 7) - 3.0; };
  const double x = number(), y = number(), z = number();
  return {x, y, z};
}

// Powers of two: all differences and volumes are exact, where points lie on a line or a plane too.
TEST(Simplex, IsReducedToItsNearestPointInAnySizeAndPlace) {
  std::mt19937 random(1);
  for (const double scale : {0x1p-20, 1.0, 0x1p20}) {
    for (std::size_t count = 1; count <= 4; ++count) {
      for (int k = 0; k < 4000; ++k) {
        std::vector<Vec3> points;
        for (std::size_t i = 0; i < count; ++i) points.push_back(scale * on_lattice(random));
        expect_nearest(points, scale * on_lattice(random), scale);
        if (testing::Test::HasFatalFailure()) return;
      }
    }
  }
}

// Four points of a plane that is turned, and a point of that plane: only rounding tells on which side it is.
TEST(Simplex, OfFourPointsOfAPlaneDoesNotHoldAPointBesideThemInThatPlane) {
  std::mt19937 random(2);
  for (int k = 0; k < 4000; ++k) {
    const Quat q = rotation(0.3 * on_lattice(random) + Vec3(0.01, 0.02, 0.03));
    const auto in_plane = [&] {
      const Vec3 p = on_lattice(random);
      return Vec3(q * Vec3(p.x(), p.y(), 0.5));
    };
    std::vector<Vec3> points;
    while (points.size() < 4) {  // a search adds no point that its simplex has already
      const Vec3 p = in_plane();
      if (std::find(points.begin(), points.end(), p) == points.end()) points.push_back(p);
    }
    double widest = 0.0;  // four points of one line are left out
    for (const Vec3& p : points) {
      widest = std::max(widest, (points[1] - points[0]).cross(p - points[0]).norm());
    }
    if (widest < 0.5) continue;
    expect_nearest(points, in_plane(), 1.0);
    if (testing::Test::HasFatalFailure()) return;
  }
}

TEST(Simplex, HoldsAllFourPointsRoundAPointInsideOfThem) {
  Simplex s;
  for (const Vec3& w :
       {Vec3(3.0, 0.0, 0.0), Vec3(0.0, 3.0, 0.0), Vec3(0.0, 0.0, 3.0), Vec3(-1.0, -1.0, -1.0)}) {
    s.add(w, of_A(w), of_B(w));
  }
  EXPECT_NEAR(s.reduce(Vec3(0.5, 0.25, 0.125)).norm(), 0.0, 1e-15);
  ASSERT_EQ(s.count, 4);
  const double rest = 2.125 / 6.0;  // w3 = (3 - sum of the place) / 6: then it is w3 (-1) + 3 w_i
  EXPECT_NEAR(s.weight[3], rest, 1e-15);
  EXPECT_NEAR(s.weight[0], (0.5 + rest) / 3.0, 1e-15);
  EXPECT_NEAR(s.weight[1], (0.25 + rest) / 3.0, 1e-15);
  EXPECT_NEAR(s.weight[2], (0.125 + rest) / 3.0, 1e-15);
}

}  // namespace
}  // namespace headpin::engine
