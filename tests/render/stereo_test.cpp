// Where things are by the pictures of both eyes.

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "render/eyes.h"
#include "render/renderer.h"
#include "tests/render/drawn_scenes.h"

namespace headpin::render {
namespace {

using test::BallScene;
using test::centroid;
using test::looking_ahead;
using test::picture;
using test::projected_middle;

// render.md section 5 measured 0.029 px rms, 0.072 px at most with 2 x 2 samples; 1.5 times that.
TEST(Picture, OfABallIsWhereItsProjectionIsInBothEyes) {
  BallScene scene;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  double worst = 0.0, squares = 0.0;
  int count = 0;
  for (int i = 0; i < 60; ++i) {
    const Pose X_WD{rotation(Vec3(unit(random), unit(random), unit(random))),
                    Vec3(unit(random), unit(random), unit(random))};
    Optics optics;
    optics.outward_deg = i % 2 == 0 ? 0.0 : 3.0;
    const double depth = 0.6 + 2.0 * (1.0 + unit(random));
    const Vec3 p_DB(0.5 * depth * unit(random), 0.25 * depth * unit(random), -depth);
    scene.put(X_WD * p_DB);
    for (const View& view : eyes(X_WD, optics)) {
      const Vec2 error = centroid(picture(scene.renderer, scene.list, view)) -
                         projected_middle(view, X_WD * p_DB, scene.radius);
      worst = std::max(worst, error.norm());
      squares += error.squaredNorm();
      ++count;
    }
  }
  EXPECT_LT(worst, 0.11);
  EXPECT_LT(std::sqrt(squares / count), 0.044);
}

// Disparity fx b / Z with fx = 234.58 px, b = 64 mm; the left eye sees things farther right. The
// ball always has the 6 px for which render.md measured errors up to 0.074 px; 1.5 times that.
TEST(Picture, OfABallIsDisplacedBetweenTheEyesByFocalLengthTimesEyeDistanceOverDepth) {
  BallScene scene;
  for (const double depth : {0.6, 1.0, 2.0, 4.0, 8.0}) {
    scene.put({0.1, depth, 1.55});
    scene.list.items[0].scale = Vec3::Constant(0.5 * depth);
    std::array<Image, 2> images;
    scene.renderer.draw(scene.list, eyes(looking_ahead({0, 0, 1.6}), {}), images);
    const Vec2 left = centroid(images[0]), right = centroid(images[1]);
    const double r = 0.5 * depth * scene.radius;
    const double expected = 234.58 * 0.064 * depth / (depth * depth - r * r);
    EXPECT_NEAR(left.x() - right.x(), expected, 0.11) << depth;
    EXPECT_NEAR(left.y(), right.y(), 0.11) << depth;
  }
}

/// Where rays through the middle of a ball in both pictures come nearest to each other, given what
/// the eyes are taken to be; the middle of its picture is a little outside that of the ball.
Vec3 triangulated(const std::array<View, 2>& views, const std::array<Image, 2>& images, double r) {
  std::array<Vec3, 2> p, d;
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const View& v = views[eye];
    const Vec2 at = centroid(images[eye]);
    p[eye] = v.X_WE.p;
    d[eye] = v.X_WE.q * Vec3(v.frustum.left + (v.frustum.right - v.frustum.left) * at.x() / v.width,
                             v.frustum.top - (v.frustum.top - v.frustum.bottom) * at.y() / v.height,
                             -1.0);
  }
  const Vec3 between = p[1] - p[0];
  const double a = d[0].dot(d[0]), b = d[0].dot(d[1]), c = d[1].dot(d[1]);
  const double s = (c * d[0].dot(between) - b * d[1].dot(between)) / (a * c - b * b);
  return p[0] + (s + r * r / s) * d[0];  // s is the depth
}

/// How far off the triangulated depth of a ball of 0.1085 m is on its way from 1 to 5 m, as shares.
struct DepthError {
  double rms = 0.0, most = 0.0;
};
template <typename Change>
DepthError depth_error(const Change& change) {
  BallScene scene;
  scene.list.items[0].scale = Vec3::Constant(0.1085 / scene.radius);
  const Pose X_WD{rotation(Vec3(0.0, 0.0, 0.05)) * looking_ahead({0, 0, 1.6}).q, Vec3(0, 0, 1.6)};
  DepthError error;
  constexpr int kPlaces = 41;
  for (int i = 0; i < kPlaces; ++i) {
    const double depth = 1.0 + 0.1 * i;
    const Vec3 p_DB(0.15 - 0.02 * depth, -0.1 * depth, -depth);
    scene.put(X_WD * p_DB);
    std::array<View, 2> views = eyes(X_WD, {});
    std::array<Image, 2> images;
    scene.renderer.draw(scene.list, views, images);
    change(views, images);
    const double off = -(X_WD.inverse() * triangulated(views, images, 0.1085)).z() / depth - 1.0;
    error.rms += off * off / kPlaces;
    error.most = std::max(error.most, std::abs(off));
  }
  error.rms = std::sqrt(error.rms);
  return error;
}

// 1 % rms, 2 % at most; what is wrong with the eyes is found out.
TEST(Picture, OfABallTellsWhereItIsFrom1To5Metres) {
  const DepthError error = depth_error([](auto&, auto&) {});
  EXPECT_LT(error.rms, 0.01);
  EXPECT_LT(error.most, 0.02);
  EXPECT_GT(depth_error([](auto&, auto& images) { std::swap(images[0], images[1]); }).rms, 0.5);
  EXPECT_GT(depth_error([](auto& views, auto&) {  // half the eye distance
              const Vec3 middle = 0.5 * (views[0].X_WE.p + views[1].X_WE.p);
              for (View& v : views) v.X_WE.p = 0.5 * (v.X_WE.p + middle);
            })
                .rms,
            0.3);
  EXPECT_GT(depth_error([](auto& views, auto&) {  // one eye rolled: a head that is not
              views[1].X_WE.q = views[1].X_WE.q * rotation(Vec3(0.0, 0.0, 0.1));
            })
                .rms,
            0.02);
}

TEST(Picture, IsTheSameForBothEyesWithoutEyeDistance) {
  BallScene scene;
  scene.put({0.1, 1.0, 1.6});
  Optics optics;
  optics.eye_distance = 0.0;
  std::array<Image, 2> images;
  scene.renderer.draw(scene.list, eyes(looking_ahead({0, 0, 1.6}), optics), images);
  EXPECT_EQ(images[0], images[1]);
  optics.eye_distance = 0.064;
  scene.renderer.draw(scene.list, eyes(looking_ahead({0, 0, 1.6}), optics), images);
  EXPECT_NE(images[0], images[1]);
}

}  // namespace
}  // namespace headpin::render
