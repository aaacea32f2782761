#include "engine/polytope.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/random_shapes.h"

namespace headpin::engine {
namespace {

/// Points that stand for A - B.
struct Cloud {
  std::vector<Vec3> points;

  Vec3 furthest(const Vec3& n) const {
    return *std::ranges::max_element(points, {}, [&](const Vec3& x) { return n.dot(x); });
  }
  static Vec3 ask(void* cloud, const Vec3& n) { return static_cast<Cloud*>(cloud)->furthest(n); }
};

/// Up to a hundred times as long as wide, turned at random.
Cloud slender(Random& random) {
  const Quat q = any_rotation(random);
  Vec3 k;
  for (double& x : k) x = std::pow(10.0, random.uniform(-1.0, 1.0));
  Cloud cloud;
  for (int i = index_below(random, 30) + 6; i > 0; --i) {
    cloud.points.push_back(q * Vec3(k.cwiseProduct(direction(random))));
  }
  return cloud;
}

// With the origin a little outside, some way out is always shorter. What six directions show of a
// slender body may be flat: that proves nothing.
TEST(PolytopeTest, NeverProvesAWayOutOfWhatIsApart) {
  Random random(11);
  for (int trial = 0; trial < 20'000; ++trial) {
    Cloud cloud = slender(random);
    const Vec3 across = direction(random), least = cloud.furthest(across);
    const double gap = std::pow(10.0, random.uniform(-6.0, -1.0));
    for (Vec3& x : cloud.points) x -= least + gap * across;
    Vec3 n = (across + random.uniform(0.0, 1.0) * direction(random)).normalized();
    double depth = n.dot(cloud.furthest(n));
    if (depth < 0.0) continue;
    Polytope around(&Cloud::ask, &cloud, n, cloud.furthest(n));
    while (depth >= 0.0 && around.find_shorter(depth, n)) {
      ASSERT_NEAR(n.norm(), 1.0, 1e-12);
      ASSERT_LT(n.dot(cloud.furthest(n)), depth);
      depth = n.dot(cloud.furthest(n));
    }
    EXPECT_LT(depth, 0.0) << "trial " << trial << ", gap " << gap;
    EXPECT_FALSE(around.gave_up()) << "trial " << trial;
  }
}

// Inside, what it ends with is the least of all ways out, as every direction has it.
TEST(PolytopeTest, EndsWithTheLeastWayOut) {
  Random random(12);
  for (int trial = 0; trial < 300; ++trial) {
    Cloud cloud = slender(random);
    Vec3 centre = Vec3::Zero();
    for (const Vec3& x : cloud.points) centre += x / static_cast<double>(cloud.points.size());
    for (Vec3& x : cloud.points) x -= centre;
    Vec3 n = direction(random);
    double depth = n.dot(cloud.furthest(n));
    Polytope around(&Cloud::ask, &cloud, n, cloud.furthest(n));
    while (around.find_shorter((1.0 - 1e-9) * depth, n)) depth = n.dot(cloud.furthest(n));
    ASSERT_FALSE(around.gave_up()) << "trial " << trial;
    for (int i = 0; i < 2000; ++i) {
      const Vec3 m = direction(random);
      EXPECT_GE(m.dot(cloud.furthest(m)), (1.0 - 1e-8) * depth) << "trial " << trial;
    }
  }
}

/// Points that stand for A - B, and the directions that they were asked about.
struct Asked {
  Cloud cloud;
  std::vector<Vec3> directions;

  double reach(const Vec3& n) const { return n.dot(cloud.furthest(n)); }
  static Vec3 ask(void* asked, const Vec3& n) {
    Asked& self = *static_cast<Asked*>(asked);
    EXPECT_TRUE(n.allFinite() && n.norm() > 1e-3) << "no direction: " << n.transpose();
    self.directions.push_back(n);
    return self.cloud.furthest(n);
  }
};

struct End {
  double depth = 0.0;
  bool gave_up = false;
};

/// Asks for ever shorter ways out, from n, while they are 0 or more.
End shortened(Asked& of, Vec3 n) {
  double depth = of.reach(n);
  Polytope around(&Asked::ask, &of, n, of.cloud.furthest(n));
  while (depth >= 0.0 && around.find_shorter(depth, n)) depth = of.reach(n);
  return {depth, around.gave_up()};
}

/// The least way out by every plane through three of the points that has no point before it.
double least_by_all_planes(const std::vector<Vec3>& points) {
  double least = std::numeric_limits<double>::infinity();
  const std::size_t count = points.size();
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < count; ++j) {
      for (std::size_t k = i + 1; k < count; ++k) {
        const Vec3 m = (points[j] - points[i]).cross(points[k] - points[i]);
        if (j <= i || j == k || m.isZero(0.0)) continue;
        const double at = m.dot(points[i]);
        double most = at, fewest = at;
        for (const Vec3& x : points) {
          most = std::max(most, m.dot(x));
          fewest = std::min(fewest, m.dot(x));
        }
        if (most <= at) least = std::min(least, at / m.norm());
        if (fewest >= at) least = std::min(least, -at / m.norm());
      }
    }
  }
  return least;
}

/// Points of a grid, of which many are in one plane, in one line or in one place.
std::vector<Vec3> of_a_grid(Random& random, int dimensions) {
  std::vector<Vec3> points;
  for (int i = index_below(random, 12) + 1; i > 0; --i) {
    Vec3 x = Vec3::Zero();
    for (int k = 0; k < dimensions; ++k) x[k] = index_below(random, 5) - 2;
    points.push_back(x);
  }
  return points;
}

TEST(PolytopeTest, EndsWithTheLeastWayOutOfPointsOfAGrid) {
  Random random(13);
  for (int trial = 0; trial < 1500; ++trial) {
    Asked of{{of_a_grid(random, 3)}, {}};
    const double least = least_by_all_planes(of.cloud.points);
    const Vec3 n = trial % 2 ? direction(random) : Vec3::Unit(trial / 2 % 3);
    if (!std::isfinite(least) || of.reach(n) < 0.0) continue;
    const End end = shortened(of, n);
    if (least > 1e-9) {
      EXPECT_FALSE(end.gave_up) << "trial " << trial;
      EXPECT_NEAR(end.depth, least, 1e-9) << "trial " << trial;
    } else {
      EXPECT_TRUE(end.gave_up || end.depth < 1e-9) << "trial " << trial;
    }
  }
}

// No answer is promised for what has no volume, but the search ends.
TEST(PolytopeTest, EndsForWhatIsFlatALineOrAPoint) {
  Random random(14);
  for (int trial = 0; trial < 1500; ++trial) {
    const Quat q = trial % 2 ? any_rotation(random) : Quat::Identity();
    Asked of{{of_a_grid(random, trial % 3)}, {}};
    for (Vec3& x : of.cloud.points) x = q * x;
    const Vec3 n = direction(random);
    if (of.reach(n) < 1e-9) continue;
    EXPECT_LE(shortened(of, n).depth, of.reach(n));
    EXPECT_LT(of.directions.size(), 600u);
  }
}

// Times a power of two nothing is rounded another way: the search of a thing a thousand times as large asks the
// same questions.
TEST(PolytopeTest, AsksTheSameInEverySize) {
  Random random(15);
  for (int trial = 0; trial < 300; ++trial) {
    Asked of{trial % 2 ? slender(random) : Cloud{of_a_grid(random, 2 + trial / 2 % 2)}, {}};
    const Vec3 n = direction(random);
    if (of.reach(n) < 0.0) continue;
    const End end = shortened(of, n);
    for (const double factor : {0x1p-10, 0x1p10}) {
      Asked scaled{of.cloud, {}};
      for (Vec3& x : scaled.cloud.points) x *= factor;
      const End same = shortened(scaled, n);
      EXPECT_EQ(same.depth, factor * end.depth);
      EXPECT_EQ(same.gave_up, end.gave_up);
      EXPECT_EQ(scaled.directions, of.directions) << "trial " << trial;
    }
  }
}

/// A square of half diagonal `wide` at height 1 over the origin, whose corners are along the first tilts, and
/// a tip far below.
Asked pyramid(double wide, double below) {
  const Vec3 n = Vec3::UnitZ(), u = n.unitOrthogonal(), v = n.cross(u);
  return {{{n + wide * u, n + wide * v, n - wide * u, n - wide * v, -below * n}}, {}};
}

// The first six points are asked for 7 degrees about the normal and behind it. Where they hold the ball,
// nothing more is asked.
TEST(PolytopeTest, EndsAtTheSixPointsIfTheyHoldTheBall) {
  for (const double depth : {1.0, std::nextafter(1.0, 2.0)}) {
    Asked of = pyramid(8.0, 64.0);
    Vec3 n = Vec3::UnitZ();
    Polytope around(&Asked::ask, &of, n, n);
    ASSERT_EQ(of.directions.size(), 5u);
    for (int k = 0; k < 4; ++k) {
      const Vec3& asked = of.directions[static_cast<std::size_t>(k)];
      EXPECT_NEAR(asked.dot(n) / asked.norm(), 1.0 / std::sqrt(1.0 + 0.13 * 0.13), 1e-12);
    }
    EXPECT_EQ(of.directions[4], Vec3(-n));
    EXPECT_EQ(around.find_shorter(depth, n), depth > 1.0);
    EXPECT_EQ(of.directions.size(), depth > 1.0 ? 6u : 5u);
    EXPECT_FALSE(around.gave_up());
  }
}

// Below, x + y - z / 3 = 2 / 3 is a face: the least way out, at 2 / sqrt(19).
TEST(PolytopeTest, FindsAFaceBelow) {
  const double least = 2.0 / std::sqrt(19.0);
  for (const double depth : {0.999 * least, 1.001 * least}) {
    Asked of = pyramid(1.0, 2.0);
    Vec3 n = Vec3::UnitZ();
    Polytope around(&Asked::ask, &of, n, n);
    EXPECT_EQ(around.find_shorter(depth, n), depth > least);
    EXPECT_EQ(of.directions.size(), depth > least ? 6u : 5u);
    if (depth > least) {
      EXPECT_NEAR(of.reach(n), least, 1e-12);
      EXPECT_FALSE(around.find_shorter((1.0 - 1e-12) * of.reach(n), n));
      EXPECT_FALSE(around.gave_up());
    }
  }
}

}  // namespace
}  // namespace headpin::engine
