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

/// Where a lens with k1 and k2 shows a tangent, by the law of docs/frames.md: the s of 0 to 2 with
/// s (1 + k1 s^2 + k2 s^4) / (1 + k1 + k2) = tangent / outer.
double place_behind_lens(double tangent, double outer, double k1, double k2) {
  double low = 0.0, high = 2.0;
  for (int i = 0; i < 100; ++i) {
    const double s = 0.5 * (low + high), square = s * s;
    const bool short_of =
        s * (1.0 + k1 * square + k2 * square * square) / (1.0 + k1 + k2) < tangent / outer;
    (short_of ? low : high) = s;
  }
  return low;
}

// A display with a lens has its pixels evenly spaced on the display, not in the tangents.
TEST(Eyes, PixelsOfADisplayWithALensAreAsWideAsTheirPlacesBehindIt) {
  const auto tangent = [](double deg) { return std::tan(deg * 3.14159265358979 / 180.0); };
  Optics lens = hmd_profile("flight-helmet-lens").optics;  // 208 x 139 pixels, 75.3 x 58.4 degrees
  const double outer = tangent(37.65);
  EXPECT_NEAR(lens.pixel_aspect(),
              (1.0 / 208) / (place_behind_lens(tangent(29.2), outer, 0.32, 0.0) / 139), 1e-9);
  EXPECT_NEAR(lens.pixel_aspect(), 0.8403, 1e-4);
  // Every edge has its own place; s is 1 at the farther one.
  lens.lens_k2 = 0.1;
  lens.outer_deg = 40.0;
  lens.inner_deg = 25.0;
  lens.up_deg = 30.0;
  lens.down_deg = 20.0;
  const auto at = [&](double deg) {
    return place_behind_lens(tangent(deg), tangent(40.0), 0.32, 0.1);
  };
  EXPECT_NEAR(lens.pixel_aspect(), ((1.0 + at(25.0)) / 208) / ((at(30.0) + at(20.0)) / 139), 1e-9);
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

// An edge without an angle of its own is at half of the field of view.
TEST(Eyes, APixelIsAsLargeAsTheEdgesSay) {
  Optics optics;  // 360 x 240 pixels, 75 x 40 degrees
  EXPECT_DOUBLE_EQ(optics.pixel_arcmin(), 12.5);
  optics.outer_deg = optics.inner_deg = 10.0;
  optics.up_deg = optics.down_deg = 8.0;
  EXPECT_DOUBLE_EQ(optics.pixel_arcmin(), 4.0);
  optics.inner_deg = 0.0;
  EXPECT_EQ(optics.edges_deg(), (Edges{10.0, 37.5, 8.0, 8.0}));
  EXPECT_DOUBLE_EQ(optics.pixel_arcmin(), 60.0 * 47.5 / 360.0);
}

}  // namespace
}  // namespace headpin::render
