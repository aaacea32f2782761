#include "render/eyes.h"

#include <algorithm>
#include <numbers>

#include "render/lens.h"

namespace headpin::render {

namespace {

double radians(double deg) {
  return deg * std::numbers::pi / 180.0;
}

/// Tangents of the angles to the edges of an eye's picture.
Edges tangents(const Optics& optics) {
  const Edges deg = optics.edges_deg();
  const auto tangent = [](double edge_deg) { return std::tan(radians(edge_deg)); };
  return {tangent(deg.outer), tangent(deg.inner), tangent(deg.up), tangent(deg.down)};
}

}  // namespace

Edges Optics::edges_deg() const {
  const auto edge = [](double edge_deg, double fov_deg) {
    return edge_deg > 0.0 ? edge_deg : 0.5 * fov_deg;
  };
  return {edge(outer_deg, horizontal_fov_deg), edge(inner_deg, horizontal_fov_deg),
          edge(up_deg, vertical_fov_deg), edge(down_deg, vertical_fov_deg)};
}

double Optics::pixel_arcmin() const {
  const Edges deg = edges_deg();
  return 60.0 * std::max((deg.outer + deg.inner) / width, (deg.up + deg.down) / height);
}

double Optics::pixel_aspect() const {
  Edges e = tangents(*this);
  if (has_lens(*this)) {  // its pixels are evenly spaced in the lens's own units
    const Lens lens(*this, std::max(e.outer, e.inner));
    e = {lens.edge(e.outer), lens.edge(e.inner), lens.edge(e.up), lens.edge(e.down)};
  }
  // The sides of a pixel on the picture plane, or on the display behind the lens.
  return (0.5 * (e.outer + e.inner) / width) / (0.5 * (e.up + e.down) / height);
}

std::array<View, 2> eyes(const Pose& X_WD, const Optics& optics) {
  const Edges e = tangents(optics);
  const auto view = [&](double side) {  // -1 left, +1 right
    const Pose X_DE{rotation(Vec3(0.0, -side * radians(optics.outward_deg), 0.0)),
                    Vec3(0.5 * side * optics.eye_distance, 0.0, 0.0)};
    return View{X_WD * X_DE,
                {side < 0.0 ? -e.outer : -e.inner, side < 0.0 ? e.inner : e.outer, -e.down, e.up,
                 optics.near, optics.far},
                optics.width,
                optics.height};
  };
  return {view(-1.0), view(+1.0)};
}

}  // namespace headpin::render
