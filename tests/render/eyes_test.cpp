#include "render/eyes.h"

#include <cmath>

#include <gtest/gtest.h>

#include "render/data/hmd.h"

namespace headpin::render {
namespace {

/// Where a point falls in a view: pixels from the left and from the top.
Vec2 project(const View& view, const Vec3& p_W) {
  const Vec3 p = view.X_WE.inverse() * p_W;
  const Frustum& f = view.frustum;
  return {view.width * (p.x() / -p.z() - f.left) / (f.right - f.left),
          view.height * (f.top - p.y() / -p.z()) / (f.top - f.bottom)};
}

TEST(Eyes, FocalLengthsAreThoseOf75By40Degrees) {
  const auto [left, right] = eyes({}, {});
  const double fx = left.width / (left.frustum.right - left.frustum.left);
  const double fy = left.height / (left.frustum.top - left.frustum.bottom);
  EXPECT_NEAR(fx, 234.58, 0.01);  // 180 / tan 37.5
  EXPECT_NEAR(fy, 329.70, 0.01);  // 120 / tan 20
  EXPECT_NEAR(Optics{}.pixel_aspect(), fy / fx, 1e-12);
}

TEST(Eyes, DisparityIsFocalLengthTimesEyeDistanceOverDepth) {
  const Optics optics;
  const auto [left, right] = eyes({}, optics);
  for (const double depth : {0.5, 1.0, 5.0, 20.0}) {
    const Vec3 p(0.1, -0.2, -depth);
    const double disparity = project(left, p).x() - project(right, p).x();
    EXPECT_NEAR(disparity, 234.58 * optics.eye_distance / depth, 1e-3) << depth;
    EXPECT_NEAR(project(left, p).y(), project(right, p).y(), 1e-9);
  }
}

TEST(Eyes, NoEyeDistanceGivesTwoEqualViews) {
  Optics optics;
  optics.eye_distance = 0.0;
  const auto [left, right] = eyes({rotation(Vec3(0.3, 0.1, 0.2)), Vec3(1, 2, 3)}, optics);
  EXPECT_EQ(left.X_WE.p, right.X_WE.p);
  EXPECT_EQ(left.X_WE.q.coeffs(), right.X_WE.q.coeffs());
}

// Each edge has its own angle; the temple's is left for the left eye and right for the right one.
TEST(Eyes, EdgesAreThoseOfTempleAndNose) {
  Optics optics;
  optics.outer_deg = 37.5;
  optics.inner_deg = 19.8;
  optics.up_deg = 25.0;
  optics.down_deg = 15.0;
  const auto [left, right] = eyes({}, optics);
  const auto tangent = [](double deg) { return std::tan(deg * 3.14159265358979 / 180.0); };
  EXPECT_NEAR(left.frustum.left, -tangent(37.5), 1e-12);
  EXPECT_NEAR(left.frustum.right, tangent(19.8), 1e-12);
  EXPECT_EQ(right.frustum.left, -left.frustum.right);
  EXPECT_EQ(right.frustum.right, -left.frustum.left);
  EXPECT_NEAR(left.frustum.top, tangent(25.0), 1e-12);
  EXPECT_NEAR(right.frustum.bottom, -tangent(15.0), 1e-12);
  // A point far away, straight ahead of the head, is off the middle of both pictures, mirrored.
  const Vec3 ahead(0.0, 0.0, -1e6);
  EXPECT_GT(project(left, ahead).x(), 0.55 * left.width);
  EXPECT_NEAR(project(left, ahead).x() + project(right, ahead).x(), left.width, 1e-3);
}

// The other reading of the paper: 75 degrees are what both eyes see together.
TEST(Eyes, OfTheProfileTotalSee75DegreesTogether) {
  const auto [left, right] = eyes({}, hmd_profile("flight-helmet-total").optics);
  const auto degrees = [](double tangent) { return std::atan(tangent) * 180.0 / 3.14159265358979; };
  EXPECT_NEAR(degrees(right.frustum.right) - degrees(left.frustum.left), 75.0, 1e-9);
  EXPECT_NEAR(degrees(left.frustum.right) - degrees(left.frustum.left), 57.3, 1e-9);
  EXPECT_NEAR(degrees(left.frustum.right) - degrees(right.frustum.left), 39.6, 1e-9);
}

TEST(Eyes, OutwardTurnSendsTheLeftEyeToTheLeft) {
  Optics optics;
  optics.outward_deg = 5.0;
  const auto [left, right] = eyes({}, optics);
  EXPECT_LT((left.X_WE.q * Vec3(0, 0, -1)).x(), 0.0);
  EXPECT_GT((right.X_WE.q * Vec3(0, 0, -1)).x(), 0.0);
  EXPECT_NEAR(left.X_WE.q.angularDistance(right.X_WE.q), 10.0 * 3.14159265 / 180.0, 1e-6);
  EXPECT_DOUBLE_EQ((right.X_WE.p - left.X_WE.p).x(), optics.eye_distance);
}

}  // namespace
}  // namespace headpin::render
