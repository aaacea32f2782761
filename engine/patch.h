#pragma once

#include <algorithm>

#include "engine/shape.h"

/// Contacts between faces and sides: the parts of two surfaces that face each other, and a few
/// points of their common area. Private to the engine.
namespace headpin::engine::patches {

/// Faces and generators within this angle of facing each other give more than one point [rad].
inline constexpr double kFacing = 0.1;
inline constexpr int kMaxCorners = 64;

/// Faces of polyhedra that lean by less against each other count as flat on each other where one of
/// their corners is chosen as the deepest. So the choice is the same in each step [rad].
inline constexpr double kSteady = 1e-4;

/// The flat or straight part of a surface that faces a direction: a polygon, a segment or a point.
struct Patch {
  Vec3 corner[kMaxCorners];
  int count = 0;        // 1 point, 2 segment, 3.. polygon
  double radius = 0.0;  // of the surface across a segment
  bool round = false;   // the corners are those of a rim

  void add(const Vec3& p) {
    if (count < kMaxCorners) corner[count++] = p;
  }
};

inline Patch patch(const Ellipsoid&, const Vec3&) {
  return {};
}
inline Patch patch(const HalfSpace&, const Vec3&) {
  return {};
}

/// A disc becomes a polygon with corners on its rim, one of them furthest along n.
inline void add_disc(Patch& out, double radius, double z, const Vec3& n) {
  constexpr int kRim = 16;
  out.round = true;
  constexpr double kCos = 0.92387953251128675613, kSin = 0.38268343236508977173;  // of 2 pi / 16
  const double rho = std::sqrt(n.x() * n.x() + n.y() * n.y());
  Vec2 u = rho > 1e-9 ? Vec2(n.x() / rho, n.y() / rho) : Vec2(Vec2::UnitX());
  for (int i = 0; i < kRim; ++i) {
    out.add({radius * u.x(), radius * u.y(), z});
    u = {kCos * u.x() - kSin * u.y(), kSin * u.x() + kCos * u.y()};
  }
}

inline Patch patch(const Cylinder& s, const Vec3& n) {
  Patch out;
  const double rho = std::sqrt(n.x() * n.x() + n.y() * n.y());
  if (rho < kFacing) {
    add_disc(out, s.radius, n.z() < 0.0 ? -s.half_height : s.half_height, n);
  } else if (std::abs(n.z()) < kFacing) {
    const double k = s.radius / rho;
    out.add({k * n.x(), k * n.y(), -s.half_height});
    out.add({k * n.x(), k * n.y(), s.half_height});
    out.radius = s.radius;
  }
  return out;
}

/// Sine of the angle between a normal and the axis of a cone below which a very flat cone is met at its tip, and
/// not along a line of its side.
inline constexpr double kAlong = 1e-9;

inline Patch patch(const Cone& s, const Vec3& n) {
  Patch out;
  const double rho = std::sqrt(n.x() * n.x() + n.y() * n.y());
  const double slant = std::sqrt(s.radius * s.radius + s.height * s.height);
  if (rho < kFacing && n.z() < 0.0) {
    add_disc(out, s.radius, -0.5 * s.height, n);
  } else if (rho > kAlong && std::abs(s.height * n.z() - s.radius * rho) < kFacing * slant) {
    const double k = s.radius / rho;
    out.add({0.0, 0.0, 0.5 * s.height});
    out.add({k * n.x(), k * n.y(), -0.5 * s.height});
    out.radius = 0.5 * s.radius * slant / s.height;  // half-way up
  }
  return out;
}

inline Patch patch(const Polyhedron& s, const Vec3& n) {
  Patch out;
  const std::uint32_t v = s.furthest(n);
  const Polyhedron::Face* facing = nullptr;
  double most = 1.0 - 0.5 * kFacing * kFacing;
  for (const std::uint32_t f : s.faces_at(v)) {
    const double cosine = n.dot(s.faces()[f].normal);
    if (cosine > most) {
      most = cosine;
      facing = &s.faces()[f];
    }
  }
  if (facing != nullptr) {
    const auto corners = s.corners(*facing);
    const std::size_t step = (corners.size() + kMaxCorners - 1) / kMaxCorners;
    for (std::size_t i = 0; i < corners.size(); i += step) out.add(s.vertices()[corners[i]]);
    return out;
  }
  double least = kFacing;
  std::uint32_t other = v;
  for (const std::uint32_t w : s.neighbours(v)) {
    const Vec3 along = s.vertices()[w] - s.vertices()[v];
    const double sine = std::abs(n.dot(along)) / along.norm();
    if (sine < least) {
      least = sine;
      other = w;
    }
  }
  if (other != v) {
    out.add(s.vertices()[v]);
    out.add(s.vertices()[other]);
  }
  return out;
}

/// The plane across the contact normal; heights along it.
struct Frame {
  Vec3 origin, u, v, n;

  Vec2 flat(const Vec3& p) const { return {u.dot(p - origin), v.dot(p - origin)}; }
  double height(const Vec3& p) const { return n.dot(p - origin); }
};

/// A patch in the contact plane, with its height there: height(x) = level + slope . x.
struct Sheet {
  Vec2 corner[2 * kMaxCorners];
  std::uint32_t edge_of[2 * kMaxCorners];  // number of the edge that starts at a corner
  int count = 0;
  double level = 0.0;
  Vec2 slope = Vec2::Zero();

  double height(const Vec2& x) const { return level + slope.dot(x); }
  Vec2 edge(int i) const { return corner[(i + 1) % count] - corner[i]; }
};

inline double cross(const Vec2& a, const Vec2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

inline Sheet lay(const Patch& patch, const Frame& frame) {
  Sheet s;
  s.count = patch.count;
  for (int i = 0; i < patch.count; ++i) {
    s.corner[i] = frame.flat(patch.corner[i]);
    s.edge_of[i] = static_cast<std::uint32_t>(i);
  }
  if (patch.count == 2) {
    const Vec2 d = s.corner[1] - s.corner[0];
    const double rise = frame.height(patch.corner[1]) - frame.height(patch.corner[0]);
    s.slope = rise / std::max(d.squaredNorm(), 1e-300) * d;
  } else {
    // Three corners far apart span the plane.
    const int j = patch.count / 3, k = 2 * patch.count / 3;
    const Vec3 m = (patch.corner[j] - patch.corner[0]).cross(patch.corner[k] - patch.corner[0]);
    const double up = m.dot(frame.n);
    if (up != 0.0) s.slope = Vec2(m.dot(frame.u), m.dot(frame.v)) / -up;
    if (up < 0.0) std::reverse(s.corner, s.corner + s.count);
  }
  s.level = frame.height(patch.corner[0]) - s.slope.dot(frame.flat(patch.corner[0]));
  return s;
}

/// The part of a convex polygon or segment to the left of the line through p along d, which becomes
/// an edge with this number.
inline void cut(Sheet& s, const Vec2& p, const Vec2& d, std::uint32_t edge) {
  Vec2 kept[2 * kMaxCorners];
  std::uint32_t edge_of[2 * kMaxCorners];
  int count = 0;
  const int edges = s.count == 2 ? 1 : s.count;
  const auto keep = [&](const Vec2& x, std::uint32_t starts) {
    if (count == 2 * kMaxCorners) return;
    kept[count] = x;
    edge_of[count++] = starts;
  };
  for (int i = 0; i < s.count; ++i) {
    const Vec2 &a = s.corner[i], &b = s.corner[(i + 1) % s.count];
    const double side_a = cross(d, a - p), side_b = cross(d, b - p);
    if (side_a >= 0.0) keep(a, s.edge_of[i]);
    if (i < edges && (side_a >= 0.0) != (side_b >= 0.0)) {
      keep(a + side_a / (side_a - side_b) * (b - a), side_a >= 0.0 ? edge : s.edge_of[i]);
    }
  }
  s.count = count;
  std::copy(kept, kept + count, s.corner);
  std::copy(edge_of, edge_of + count, s.edge_of);
}

/// A corner of the common area of two patches, in the contact plane.
struct SharedPoint {
  Vec2 x;
  double height = 0.0, depth = 0.0;
  std::uint32_t feature = 0;  // its two edges, or its end of a common segment
};

/// The feature of a deepest point that is no corner: no two edges have it.
inline constexpr std::uint32_t kInside = 0xffff;

/// The common area of two patches, as corners in the contact plane. Returns their number.
inline int shared(const Patch& of_a, const Patch& of_b, const Sheet& a, const Sheet& b,
                  SharedPoint* out) {
  int count = 0;
  if (of_a.count == 2 && of_b.count == 2) {
    // Side on side: their common segment, if they are nearly parallel.
    const Vec2 da = a.corner[1] - a.corner[0], db = b.corner[1] - b.corner[0];
    const double length = da.norm(), turn = cross(da, db) / (length * db.norm());
    if (!(std::abs(turn) < kFacing)) return 0;
    const Vec2 t = da / length;
    const double b0 = t.dot(b.corner[0] - a.corner[0]), b1 = t.dot(b.corner[1] - a.corner[0]);
    const double low = std::max(0.0, std::min(b0, b1)), high = std::min(length, std::max(b0, b1));
    if (!(low < high)) return 0;
    for (const double s : {low, high}) {
      const Vec2 xa = a.corner[0] + s * t;
      const Vec2 xb = b.corner[0] + (s - b0) / (b1 - b0) * db;
      // If the lines of round sides are e apart sideways, the gap is larger by e^2 / 2 r.
      const double e2 = (xa - xb).squaredNorm();
      const double ha = a.height(xa), hb = b.height(xb);
      const double lost = e2 / (2.0 * (of_a.radius + of_b.radius) + std::sqrt(e2) + 1e-300);
      const auto end = static_cast<std::uint32_t>(count);
      out[count++] = {0.5 * (xa + xb), 0.5 * (ha + hb), ha - hb - lost, end};
    }
    return count;
  }
  const bool a_first = of_a.count == 2 || of_b.count != 2;  // a segment is cut by the polygon
  Sheet s = a_first ? a : b;
  const Sheet& knife = a_first ? b : a;
  for (int i = 0; i < knife.count && s.count > 0; ++i) {
    cut(s, knife.corner[i], knife.edge(i), static_cast<std::uint32_t>(kMaxCorners + i));
  }
  for (int i = 0; i < s.count; ++i) {
    const double ha = a.height(s.corner[i]), hb = b.height(s.corner[i]);
    const std::uint32_t ends = s.edge_of[(i + s.count - 1) % s.count];
    out[count++] = {s.corner[i], 0.5 * (ha + hb), ha - hb, 2 * kMaxCorners * ends + s.edge_of[i]};
  }
  return count;
}

/// The deepest candidate. If the choice is to be steady, it is the deepest one after the surfaces
/// leaned a little more, always towards the same side of A.
inline int deepest(const SharedPoint* all, int count, const Frame& frame, bool steady) {
  const Vec3 side(0.36, 0.48, 0.8);
  const Vec2 lean =
      steady ? Vec2(kSteady * Vec2(frame.u.dot(side), frame.v.dot(side))) : Vec2::Zero();
  int first = 0;
  for (int i = 1; i < count; ++i) {
    const bool deeper =
        all[i].depth + lean.dot(all[i].x) > all[first].depth + lean.dot(all[first].x);
    if (deeper) first = i;
  }
  return first;
}

/// Chooses up to four candidates: the first, the furthest from it, and the furthest on each side of
/// the line between them.
inline int spread(const SharedPoint* all, int count, int first, int* chosen) {
  chosen[0] = first;
  int far = first;
  for (int i = 0; i < count; ++i) {
    if ((all[i].x - all[first].x).squaredNorm() > (all[far].x - all[first].x).squaredNorm())
      far = i;
  }
  const Vec2 d = all[far].x - all[first].x;
  const double least = 1e-6 * d.squaredNorm();
  if (!(least > 0.0)) return 1;
  chosen[1] = far;
  int left = first, right = first;
  double leftmost = least, rightmost = -least;
  for (int i = 0; i < count; ++i) {
    const double side = cross(d, all[i].x - all[first].x);
    if (side > leftmost) {
      leftmost = side;
      left = i;
    }
    if (side < rightmost) {
      rightmost = side;
      right = i;
    }
  }
  int n = 2;
  if (left != first) chosen[n++] = left;
  if (right != first) chosen[n++] = right;
  return n;
}

}  // namespace headpin::engine::patches
