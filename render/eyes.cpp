#include "render/eyes.h"

#include <numbers>

namespace headpin::render {

namespace {

double radians(double deg) {
  return deg * std::numbers::pi / 180.0;
}

}  // namespace

double Optics::pixel_aspect() const {
  const double tan_x = std::tan(radians(0.5 * horizontal_fov_deg));
  const double tan_y = std::tan(radians(0.5 * vertical_fov_deg));
  // The angle a pixel spans, across over down, taken on the picture plane.
  return (tan_x / width) / (tan_y / height);
}

std::array<View, 2> eyes(const Pose& X_WD, const Optics& optics) {
  const double tan_x = std::tan(radians(0.5 * optics.horizontal_fov_deg));
  const double tan_y = std::tan(radians(0.5 * optics.vertical_fov_deg));
  const auto view = [&](double side) {  // -1 left, +1 right
    const Pose X_DE{rotation(Vec3(0.0, -side * radians(optics.outward_deg), 0.0)),
                    Vec3(0.5 * side * optics.eye_distance, 0.0, 0.0)};
    return View{X_WD * X_DE,
                {-tan_x, tan_x, -tan_y, tan_y, optics.near, optics.far},
                optics.width,
                optics.height};
  };
  return {view(-1.0), view(+1.0)};
}

}  // namespace headpin::render
