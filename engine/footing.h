#pragma once

#include <type_traits>
#include <vector>

#include "engine/contacts.h"

/// Contact points of shapes that stand on a plane, in closed form. Private to the engine.
namespace headpin::engine::footing {

inline constexpr double kSin120 = 0.86602540378443864676;

/// Whether the ground is body A or body B of a contact. Normals point from A to B.
enum class Side { a, b };

/// How many points of a rim carry a disc. Of three, two opposite edges are a half and a whole radius
/// away, and a pin that is hit yields too easily one way: as in older trials.
enum class Rim { three, four };

/// The plane of a half-space, and contact points of shapes that stand on it.
struct Ground {
  Ground(Side side, const Pose& X_WP, double most, Rim points_of_rim,
         std::vector<ContactPoint>& points)
      : up_W(z_axis(X_WP.q)),
        n_AB_W(side == Side::a ? up_W : Vec3(-up_W)),
        along_W(X_WP.q * Vec3::UnitY()),
        level(up_W.dot(X_WP.p)),
        margin(most),
        of_rim(points_of_rim),
        out(points) {}
  /// The plane of a face of a polyhedron.
  Ground(Side side, const Polyhedron::Face& face, const Pose& X_WG, double most,
         std::vector<ContactPoint>& points)
      : up_W(X_WG.q * face.normal),
        n_AB_W(side == Side::a ? up_W : Vec3(-up_W)),
        along_W(X_WG.q * face.along),
        level(up_W.dot(X_WG.p) + face.offset),
        margin(most),
        of_rim(Rim::four),
        out(points) {}

  double height(const Vec3& p_W) const { return up_W.dot(p_W) - level; }

  /// Adds the points of a shape that are no higher than the margin.
  ///
  /// @param origin  height of the origin of the shape's frame G over the ground [m]
  void carry(const Shape& shape, const Mat3& R_WG, const Vec3& p_WG, double origin);

  const Vec3 up_W, n_AB_W;  // away from the ground; normal of its contacts
  const Vec3 along_W;       // a direction in the plane
  const double level, margin;
  const Rim of_rim;
  std::vector<ContactPoint>& out;
};

/// A shape over the ground.
struct Footprint {
  const Ground& ground;
  const Mat3& R_WG;
  const Vec3& p_WG;
  Vec3 down;     // in G
  double level;  // height of G's origin

  void point(const Vec3& p_G, std::uint32_t feature) {
    const double height = level - down.dot(p_G);
    if (height > ground.margin) return;
    ground.out.push_back(
        {R_WG * p_G + p_WG - 0.5 * height * ground.up_W, ground.n_AB_W, -height, feature});
  }
};

/// Horizontal direction of steepest descent in the shape's frame. An upright round shape has none;
/// then it is a fixed direction of the ground, so that the yaw of the shape does not matter.
inline Vec2 downhill(const Footprint& foot, const Vec3& down) {
  Vec2 u(down.x(), down.y());
  if (u.squaredNorm() < 1e-8) u = (foot.R_WG.transpose() * foot.ground.along_W).head<2>();
  return u / u.norm();
}

// Adds the lowest point of a rim, and those a quarter of a turn to each side of it and opposite.
inline void rim(Footprint& foot, double radius, double z, const Vec2& u, std::uint32_t feature) {
  const Vec2 v(-u.y(), u.x());
  if (foot.ground.of_rim == Rim::four) {
    for (const Vec2& p : {u, v, Vec2(-v), Vec2(-u)}) {
      foot.point({radius * p.x(), radius * p.y(), z}, feature++);
    }
    return;
  }
  const Vec2 left = -0.5 * u + kSin120 * v, right = -0.5 * u - kSin120 * v;
  foot.point({radius * u.x(), radius * u.y(), z}, feature);
  foot.point({radius * left.x(), radius * left.y(), z}, feature + 1);
  foot.point({radius * right.x(), radius * right.y(), z}, feature + 2);
}

inline void stand(Footprint& foot, const Ellipsoid& s, const Vec3& down, double) {
  foot.point(support(s, down), 0);
}

inline void stand(Footprint& foot, const Cylinder& s, const Vec3& down, double) {
  const Vec2 u = downhill(foot, down);
  const double z = down.z() < 0.0 ? -s.half_height : s.half_height;
  rim(foot, s.radius, z, u, down.z() < 0.0 ? 0 : 4);
  foot.point({s.radius * u.x(), s.radius * u.y(), -z}, down.z() < 0.0 ? 4 : 0);
}

inline void stand(Footprint& foot, const Cone& s, const Vec3& down, double) {
  rim(foot, s.radius, -0.5 * s.height, downhill(foot, down), 0);
  foot.point({0.0, 0.0, 0.5 * s.height}, 4);
}

// Adds the lowest corner, the corner furthest from it, and the furthest corner on each side of the
// line between them.
inline void stand(Footprint& foot, const Polyhedron& s, const Vec3& down, double above) {
  const std::span<const Vec3> v = s.vertices();
  const std::uint32_t lowest = s.furthest(down);
  const Vec3 p0 = v[lowest];
  if (down.dot(p0) < above) return;
  const auto along_plane = [&](std::size_t i) {
    const Vec3 d = v[i] - p0;
    return Vec3(d - d.dot(down) * down);
  };
  std::uint32_t furthest = lowest;
  double most = 0.0;
  for (std::uint32_t i = 0; i < v.size(); ++i) {
    if (down.dot(v[i]) < above) continue;
    const double r2 = along_plane(i).squaredNorm();
    if (r2 > most) {
      most = r2;
      furthest = i;
    }
  }
  foot.point(p0, lowest);
  if (furthest == lowest) return;
  foot.point(v[furthest], furthest);
  const Vec3 across = down.cross(along_plane(furthest));
  std::uint32_t left = lowest, right = lowest;
  double leftmost = 1e-9 * most, rightmost = -1e-9 * most;
  for (std::uint32_t i = 0; i < v.size(); ++i) {
    if (down.dot(v[i]) < above) continue;
    const double side = across.dot(along_plane(i));
    if (side > leftmost) {
      leftmost = side;
      left = i;
    }
    if (side < rightmost) {
      rightmost = side;
      right = i;
    }
  }
  if (left != lowest) foot.point(v[left], left);
  if (right != lowest) foot.point(v[right], right);
}

inline void Ground::carry(const Shape& shape, const Mat3& R_WG, const Vec3& p_WG, double origin) {
  Footprint foot{*this, R_WG, p_WG, -(R_WG.transpose() * up_W), origin};
  std::visit(
      [&](const auto& s) {
        // Points p with down . p >= above are within the margin.
        if constexpr (!std::is_same_v<std::decay_t<decltype(s)>, HalfSpace>) {
          stand(foot, s, foot.down, foot.level - margin);
        }
      },
      shape);
}

}  // namespace headpin::engine::footing
