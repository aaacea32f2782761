#include "render/flow.h"

#include <algorithm>
#include <map>

#include "render/camera.h"

namespace headpin::render {

namespace {

/// The pose of an object at both moments.
struct Motion {
  Pose X_WG_before, X_WG_after;

  Vec3 after(const Vec3& p_W) const {
    const bool rests =
        X_WG_before.p == X_WG_after.p && X_WG_before.q.coeffs() == X_WG_after.q.coeffs();
    return rests ? p_W : X_WG_after * (X_WG_before.inverse() * p_W);
  }
};

/// The motions of the objects that have the same mesh at both moments, by id. All items of an object
/// move together.
std::map<std::uint32_t, Motion> motions(std::span<const DrawItem> before,
                                        std::span<const DrawItem> after) {
  std::map<std::uint32_t, Motion> all;
  for (const DrawItem& item : before) {
    const auto same = std::ranges::find_if(after, [&](const DrawItem& other) {
      return other.id == item.id && other.mesh == item.mesh && other.scale == item.scale;
    });
    if (same != after.end()) all.try_emplace(item.id, Motion{item.X_WG, same->X_WG});
  }
  return all;
}

}  // namespace

std::vector<std::array<float, 2>> flow(const DrawnView& before, const Labels& seen,
                                       const DrawnView& after) {
  const Camera from(before.view), to(after.view);
  const Pose X_WC = from.X_CW.inverse();
  const std::map<std::uint32_t, Motion> moved = motions(before.items, after.items);
  const auto width = static_cast<std::size_t>(seen.width);
  std::vector<std::array<float, 2>> out(seen.id.size(), {kUnknownFlow, kUnknownFlow});
  for (std::size_t i = 0; i < out.size(); ++i) {
    const auto motion = moved.find(seen.id[i]);
    if (motion == moved.end()) continue;
    const auto x = static_cast<double>(i % width), y = static_cast<double>(i / width);
    const Vec3 p_W = X_WC * from.point(x, y, static_cast<double>(seen.depth[i]));
    const Vec3 p_CQ = to.X_CW * motion->second.after(p_W);
    if (p_CQ.z() <= after.view.frustum.near) continue;
    // Minus the same computation, so that what rests has a flow of exactly 0.
    const Vec2 by = to.pixel(p_CQ) - from.pixel(from.X_CW * p_W);
    out[i] = {static_cast<float>(by.x()), static_cast<float>(by.y())};
  }
  return out;
}

}  // namespace headpin::render
