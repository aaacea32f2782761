#include "render/camera.h"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "render/data/hmd.h"
#include "render/display.h"
#include "render/matrices.h"

namespace headpin::render {
namespace {

double angle_deg(double pixels, double focal) {
  return std::atan(pixels / focal) * 180.0 / std::numbers::pi;
}

// The outermost edges are half a pixel from the centres of the outermost pixels.
TEST(Camera, HasThePublishedFieldsOfViewOfEveryDisplay) {
  for (const HmdProfile& profile : hmd_profiles()) {
    if (has_lens(profile.optics)) continue;
    for (const View& view : eyes({}, profile.optics)) {
      const Camera camera(view);
      const double across = angle_deg(camera.cx + 0.5, camera.fx) +
                            angle_deg(view.width - 0.5 - camera.cx, camera.fx);
      const double down = angle_deg(camera.cy + 0.5, camera.fy) +
                          angle_deg(view.height - 0.5 - camera.cy, camera.fy);
      EXPECT_NEAR(across, profile.optics.horizontal_fov_deg, 1e-9) << profile.name;
      EXPECT_NEAR(down, profile.optics.vertical_fov_deg, 1e-9) << profile.name;
    }
  }
}

// OpenGL's clip space is from -1 to 1, upwards; its pixels' centres are at half integers.
TEST(Camera, SeesAPointWhereOpenGlDrawsIt) {
  Optics optics;
  optics.outer_deg = 37.5;
  optics.inner_deg = 19.8;
  optics.up_deg = 25.0;
  optics.down_deg = 15.0;
  optics.outward_deg = 8.0;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  const auto somewhere = [&] { return Vec3(any(random), any(random), any(random)); };
  for (int i = 0; i < 100; ++i) {
    for (const View& view : eyes({rotation(3.0 * somewhere()), somewhere()}, optics)) {
      const Vec3 p_W = view.X_WE * Vec3(any(random), any(random), -2.0 + any(random));
      const Eigen::Vector4d clip = world_to_clip(view) * p_W.homogeneous();
      const Camera camera(view);
      const Vec3 p_C = camera.X_CW * p_W;
      const Vec2 at = camera.pixel(p_C);
      EXPECT_NEAR(at.x(), 0.5 * (1.0 + clip.x() / clip.w()) * view.width - 0.5, 1e-9);
      EXPECT_NEAR(at.y(), 0.5 * (1.0 - clip.y() / clip.w()) * view.height - 0.5, 1e-9);
      EXPECT_NEAR(p_C.z(), clip.w(), 1e-12);  // the depth
      EXPECT_LT((camera.point(at.x(), at.y(), p_C.z()) - p_C).norm(), 1e-12);
    }
  }
}

}  // namespace
}  // namespace headpin::render
