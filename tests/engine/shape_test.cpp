#include "engine/shape.h"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/random_shapes.h"

namespace headpin::engine {
namespace {

using test::kShapeKinds;
using test::ShapeKind;
using testing::HasSubstr;

// No point of the shape lies further along n than the support point, and that point is in the
// shape.
TEST(Support, IsTheFurthestPointOfTheShape) {
  Random random(1);
  for (const ShapeKind k : kShapeKinds) {
    for (int i = 0; i < 50; ++i) {
      const Shape shape = random_shape(random, k);
      const Vec3 n = direction(random);
      const Vec3 p = support(shape, n);
      EXPECT_TRUE(contains(shape, p, 1e-12)) << kind(shape);
      for (int j = 0; j < 200; ++j) {
        const Vec3 q = random.uniform(0.0, 0.9) * direction(random);
        if (contains(shape, q)) {
          EXPECT_LE(n.dot(q), n.dot(p) + 1e-12) << kind(shape);
        }
        EXPECT_LE(n.dot(support(shape, direction(random))), n.dot(p) + 1e-12);
      }
    }
  }
}

// Poles, apexes, rims, zero and not finite directions: some point of the shape, never NaN.
TEST(Support, IsAPointOfTheShapeForEveryDirection) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  Random random(2);
  for (const ShapeKind k : kShapeKinds) {
    const Shape shape = random_shape(random, k);
    for (const double x : {0.0, -0.0, 1.0, -1.0, 1e-300, 1e300, nan, inf, -inf}) {
      for (const double y : {0.0, 1.0, -1e-200, nan, inf}) {
        for (const double z : {0.0, -0.0, 1.0, -1.0, 1e-300, 1e300, nan}) {
          const Vec3 p = support(shape, Vec3(x, y, z));
          ASSERT_TRUE(p.allFinite()) << kind(shape) << " " << x << " " << y << " " << z;
          EXPECT_TRUE(contains(shape, p, 1e-12)) << kind(shape) << " " << x << " " << y << " " << z;
        }
      }
    }
  }
}

// A ball of that radius lies in the shape, and but for ellipsoids one not much larger does not.
TEST(Clearance, IsTheRadiusOfABallThatTheShapeHolds) {
  Random random(3);
  for (const ShapeKind k :
       {ShapeKind::ellipsoid, ShapeKind::cylinder, ShapeKind::cone, ShapeKind::hull}) {
    for (int i = 0; i < 300; ++i) {
      const Shape shape = random_shape(random, k);
      const Vec3 p = random.uniform(0.0, 0.7) * direction(random);
      const double radius = std::visit(
          [&](const auto& s) {
            if constexpr (std::is_same_v<std::decay_t<decltype(s)>, HalfSpace>)
              return 0.0;
            else
              return clearance(s, p);
          },
          shape);
      EXPECT_EQ(radius >= 0.0, contains(shape, p)) << kind(shape);
      if (radius < 0.0) continue;
      double reach = 1.0;  // of the ball on its way out, least over many directions
      for (int m = 0; m < 2000; ++m) {
        const Vec3 n = direction(random);
        ASSERT_TRUE(contains(shape, p + radius * n, 1e-9)) << kind(shape);
        reach = std::min(reach, n.dot(support(shape, n) - p));
      }
      EXPECT_LE(radius, reach + 1e-9) << kind(shape);
      if (k != ShapeKind::ellipsoid) {
        EXPECT_GT(radius, 0.5 * reach - 0.02) << kind(shape);
      }
    }
  }
}

using Faces = std::vector<std::vector<std::uint32_t>>;

std::string refusal(const std::vector<Vec3>& vertices, const Faces& faces) {
  try {
    Polyhedron polyhedron(vertices, faces);
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "";
}

TEST(Polyhedron, IsRefusedWithTheReason) {
  const std::vector<Vec3> v = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const Faces good = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  EXPECT_EQ(refusal(v, good), "");
  EXPECT_THAT(refusal(v, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}}), HasSubstr("3 faces"));
  EXPECT_THAT(refusal(v, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 1}}), HasSubstr("not closed"));
  EXPECT_THAT(refusal(v, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}, {0, 2, 3}}),
              HasSubstr("belongs to 3 faces"));
  EXPECT_THAT(refusal(v, {{0, 1, 2}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}), HasSubstr("turned over"));
  EXPECT_THAT(refusal(v, {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {0, 2, 3}}), HasSubstr("inside out"));
  EXPECT_THAT(refusal(v, {{0, 2, 1}, {0, 1, 3}, {1, 2, 4}, {0, 3, 2}}), HasSubstr("vertex 4 of 4"));
  EXPECT_THAT(refusal(v, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3}}), HasSubstr("2 corners"));
  std::vector<Vec3> bad = v;
  bad[2].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusal(bad, good), HasSubstr("vertex 2 is not finite"));
  bad = v;
  bad[3] = bad[0];
  EXPECT_THAT(refusal(bad, good), HasSubstr("in one place"));
  // An octahedron with one corner pushed in is closed, but a dent.
  std::vector<Vec3> dent = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -0.2}};
  const Faces octahedron = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                            {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  EXPECT_EQ(refusal(dent, octahedron), "");
  dent[5].z() = 0.2;
  EXPECT_THAT(refusal(dent, octahedron), HasSubstr("not convex"));
  dent = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0.1}, {0, 0, 1}};
  EXPECT_THAT(refusal(dent, {{0, 3, 2, 1}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}}),
              HasSubstr("not flat"));
  // The tolerance is in proportion to the size.
  for (const double size : {1e-3, 1e3}) {
    std::vector<Vec3> small = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 1e-4}, {0, 0, 1}};
    for (Vec3& p : small) p *= size;
    EXPECT_THAT(refusal(small, {{0, 3, 2, 1}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}}),
                HasSubstr("not flat"))
        << size;
  }
  // The base is an arrowhead.
  const std::vector<Vec3> arrow = {
      {-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {0.3, -0.3, 0}, {0.5, -0.5, 1}};
  EXPECT_THAT(refusal(arrow, {{3, 2, 1, 0}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}}),
              HasSubstr("turns inwards at vertex 3"));
}

// A climb over edges finds what a search over all corners finds.
TEST(Polyhedron, ClimbsToTheFurthestCorner) {
  Random random(4);
  for (int i = 0; i < 20; ++i) {
    const Polyhedron p = i == 0 ? test::box({1.0, 2.0, 3.0}) : test::random_hull(random, 10 * i);
    for (int j = 0; j < 500; ++j) {
      const Vec3 n = direction(random);
      double most = -1e9;
      for (const Vec3& v : p.vertices()) most = std::max(most, n.dot(v));
      EXPECT_NEAR(n.dot(support(p, n)), most, 1e-12);
    }
  }
}

TEST(Shape, WithAMeasureThatIsNotPositiveIsRefused) {
  EXPECT_NO_THROW(check(Ellipsoid{{1, 2, 3}}));
  EXPECT_THROW(check(Ellipsoid{{1, 0, 3}}), std::invalid_argument);
  EXPECT_THROW(check(Cylinder{-1, 1}), std::invalid_argument);
  EXPECT_THROW(check(Cone{1, std::numeric_limits<double>::infinity()}), std::invalid_argument);
}

const Faces kTetrahedron = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};

/// Corners of a tetrahedron of this size, right-angled at `corner`.
std::vector<Vec3> tetrahedron(double size, const Vec3& corner = Vec3::Zero()) {
  return {corner, corner + Vec3(size, 0, 0), corner + Vec3(0, size, 0), corner + Vec3(0, 0, size)};
}

TEST(Polyhedron, HasTwoCornersInOnePlaceUpToATenMillionthOfItsSize) {
  for (const double size : {1e-3, 1e3}) {
    const double apart = 1e-7 * std::sqrt(3.0) * size;
    for (const Vec3& way : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)}) {
      std::vector<Vec3> v = tetrahedron(size, Vec3(2.0, 0.0, 0.0) * size);
      v.push_back(v[0] + 0.9 * apart * way);
      EXPECT_EQ(refusal(v, kTetrahedron), "polyhedron: vertices 0 and 4 are in one place") << size;
      v[4] = v[0] + 1.1 * apart * way;
      EXPECT_THAT(refusal(v, kTetrahedron), HasSubstr("vertex 4 has 0 edges")) << size;
    }
  }
}

TEST(Polyhedron, OfAnySizeIsAcceptedWithItsCentre) {
  for (const double size : {1e-7, 1.0, 1e5}) {
    const Vec3 corner = size * Vec3(0.5, -1.0, 2.0);
    ASSERT_EQ(refusal(tetrahedron(size, corner), kTetrahedron), "") << size;
    const Vec3 mean = corner + Vec3::Constant(0.25 * size);
    EXPECT_LT((Polyhedron(tetrahedron(size, corner), kTetrahedron).centre() - mean).norm(),
              1e-12 * size);
  }
}

TEST(Polyhedron, TellsWhichCornerAndFaceIsWrongAndByHowMuch) {
  // A dent in the base of five corners.
  EXPECT_EQ(refusal({{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {0, 0.2, 0}, {-1, 1, 0}, {0, -0.5, 1}},
                    {{4, 3, 2, 1, 0}, {0, 1, 5}, {1, 2, 5}, {2, 3, 5}, {3, 4, 5}, {4, 0, 5}}),
            "polyhedron: not convex: face 0 turns inwards at vertex 3");
  // The base goes up and down by a tenth about z = -1.
  EXPECT_EQ(refusal({{1, 0, -0.9}, {0, 1, -1.1}, {-1, 0, -0.9}, {0, -1, -1.1}, {0, 0, 1}},
                    {{0, 3, 2, 1}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}}),
            "polyhedron: face 0 is not flat: vertex 0 is -0.100000 off its plane");
  EXPECT_EQ(refusal(tetrahedron(1.0), {{0, 1, 2}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}),
            "polyhedron: edge 0-1 runs the same way in faces 0 and 1: one of them is turned over");
  std::vector<Vec3> halved = tetrahedron(1.0);
  halved.emplace_back(0.5, 0.0, 0.0);  // in the middle of edge 0-1
  EXPECT_EQ(refusal(halved, {{0, 2, 1, 4}, {0, 4, 1, 3}, {1, 2, 3}, {0, 3, 2}}),
            "polyhedron: vertex 4 has 2 edges, expected at least 3");
}

TEST(BoundingRadius, ReachesTheRim) {
  EXPECT_DOUBLE_EQ(bounding_radius(Cylinder{.radius = 0.3, .half_height = 0.4}), 0.5);
  EXPECT_DOUBLE_EQ(bounding_radius(Cone{.radius = 0.3, .height = 0.8}), 0.5);
}

TEST(Contains, AlsoHoldsTheSurfaceAndWhatIsOutsideByTheTolerance) {
  const Shape box = Polyhedron(tetrahedron(1.0, Vec3(2.0, 4.0, 8.0)), kTetrahedron);
  const Shape floor = HalfSpace{};
  for (const double tolerance : {0.0, 0.25}) {
    EXPECT_TRUE(contains(box, Vec3(2.0 - tolerance, 4.25, 8.25), tolerance));
    EXPECT_FALSE(contains(box, Vec3(1.99 - tolerance, 4.25, 8.25), tolerance));
    EXPECT_TRUE(contains(floor, Vec3(0.0, 0.0, tolerance), tolerance));
    EXPECT_FALSE(contains(floor, Vec3(0.0, 0.0, tolerance + 0.01), tolerance));
  }
}

TEST(Clearance, OfAPolyhedronIsTheLeastDistanceFromItsFaces) {
  const Polyhedron p(tetrahedron(1.0, Vec3(2.0, 4.0, 8.0)), kTetrahedron);
  EXPECT_DOUBLE_EQ(clearance(p, Vec3(2.0625, 4.125, 8.25)), 0.0625);
  EXPECT_DOUBLE_EQ(clearance(p, Vec3(1.5, 4.125, 8.25)), -0.5);
}

TEST(Shape, IsRefusedForEachOfItsMeasures) {
  EXPECT_NO_THROW(check(Shape(Cylinder{.radius = 1.0, .half_height = 1.0})));
  EXPECT_NO_THROW(check(Shape(Cone{.radius = 1.0, .height = 1.0})));
  EXPECT_THROW(check(Cylinder{.radius = 1.0, .half_height = 0.0}), std::invalid_argument);
  EXPECT_THROW(check(Cone{.radius = 0.0, .height = 1.0}), std::invalid_argument);
  EXPECT_THROW(check(Cone{.radius = 1.0, .height = 0.0}), std::invalid_argument);
}

}  // namespace
}  // namespace headpin::engine
