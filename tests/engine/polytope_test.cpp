#include "engine/polytope.h"

#include <algorithm>
#include <cmath>
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

}  // namespace
}  // namespace headpin::engine
