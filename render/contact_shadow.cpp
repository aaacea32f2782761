#include "render/contact_shadow.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace headpin::render {

std::vector<ContactVertex> contact_vertices(const DrawList& list) {
  std::vector<ContactVertex> vertices;
  for (const Patch& patch : list.patches) {
    const double width = patch.u_W.norm(), length = patch.v_W.norm();
    const Vec3 u = patch.u_W / width, v = patch.v_W / length, n = u.cross(v);
    for (const Occluder& ball : list.occluders) {
      const Vec3 p = ball.p_W - patch.p_W;
      const double height = n.dot(p);
      if (height <= 0.0) continue;
      // Beyond `far` the ball takes less than kFaint: height r^2 / far^3 = kFaint.
      const double far = std::cbrt(height * ball.radius * ball.radius / kFaint);
      if (far <= height) continue;
      const double reach = std::sqrt(far * far - height * height);
      const double u0 = std::max(0.0, u.dot(p) - reach), u1 = std::min(width, u.dot(p) + reach);
      const double v0 = std::max(0.0, v.dot(p) - reach), v1 = std::min(length, v.dot(p) + reach);
      if (u0 >= u1 || v0 >= v1) continue;
      Eigen::Vector4f at;
      at << ball.p_W.cast<float>(), static_cast<float>(ball.radius);
      for (const auto& [a, b] : {std::pair{u0, v0}, std::pair{u1, v0}, std::pair{u1, v1},
                                 std::pair{u0, v0}, std::pair{u1, v1}, std::pair{u0, v1}}) {
        vertices.push_back({Vec3(patch.p_W + a * u + b * v).cast<float>(), n.cast<float>(), at});
      }
    }
  }
  return vertices;
}

}  // namespace headpin::render
