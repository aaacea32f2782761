#pragma once

#include <algorithm>
#include <cmath>

#include "engine/inlining.h"
#include "engine/shape.h"

/// Shapes of a query, posed in A's frame, with the data that Newton's method needs for one
/// direction. Private to the engine; callers use non_colliding.h.
///
/// A query works on the difference A - B = A + (-B). B is therefore posed mirrored through the
/// origin: its centre and axis change sign and one set of formulas serves both sides of the sum.
namespace headpin::engine::posed {

/// Support of a shape along a direction n.
struct At {
  /// The set of furthest points: one point, or more if n is on a kink of the support function.
  enum Set { point, generator, disc };

  Vec3 s;       ///< a support point; for a disc its centre
  Vec3 t;       ///< points on rims: unit, along the rim
  double bend;  ///< radii of curvature: bend t t' (rims; 0 elsewhere; not used by ellipsoids)
  Set set;
  int side;  ///< side of the circle of kinks n . axis = c: +1 or -1; 0 on it
};

/// A generator that is furthest as a whole: s + tau e for low <= tau <= high, s as in At.
struct Generator {
  Vec3 e = Vec3::UnitZ();  ///< unit
  double low = 0.0, high = 0.0;
  double bend_high = 0.0;  ///< At::bend when the high end is taken for s
  int high_side = 1;       ///< side of the circle on which the high end is furthest
};

/// Symmetric 2 x 2: radii of curvature in a basis of the plane across n.
struct Bend {
  double uu = 0.0, uv = 0.0, vv = 0.0;
};

inline constexpr double kOnKink = 1e-9;

/// Nearer to a pole than this, the part of a direction across the axis is only rounding. Scaled to
/// the radius, it would give a point off the shape, so the centre of the cap is used instead of its
/// rim.
inline constexpr double kAtPole2 = 1e-28;  // sine, squared

/// Minus the z axis, with unit length to the last bit. The axis of a quaternion is only as exact as
/// its norm, and an error of its length would cause an error across the axis.
inline Vec3 mirrored_axis(const Quat& q) {
  const Vec3 z = z_axis(q);
  return (0.5 * z.squaredNorm() - 1.5) * z;
}

/// `own`: the shape is in its own frame, with its centre at the origin and its axis along z, as A
/// of a query is. This saves a third of the work. `posed`: any other frame.
enum class Where { own, posed };

template <Where where>
struct Ellipsoid {
  static constexpr bool kKinks = false;
  static constexpr double radius = 0.0;

  Vec3 c;
  double xx, yy, zz, xy, xz, yz;  ///< Q = R diag(radii^2) R'; s(n) = c + Q n / sqrt(n . Q n)

  HEADPIN_INLINE Vec3 times(const Vec3& n) const {
    if constexpr (where == Where::own) return {xx * n.x(), yy * n.y(), zz * n.z()};
    return {xx * n.x() + xy * n.y() + xz * n.z(), xy * n.x() + yy * n.y() + yz * n.z(),
            xz * n.x() + yz * n.y() + zz * n.z()};
  }
  HEADPIN_INLINE Vec3 support(const Vec3& n) const {
    const Vec3 q = times(n);
    const Vec3 r = 1.0 / std::sqrt(n.dot(q)) * q;
    if constexpr (where == Where::own) return r;
    return c + r;
  }
  HEADPIN_INLINE At at(const Vec3& n) const {
    return {support(n), Vec3::Zero(), 0.0, At::point, 0};
  }
  HEADPIN_INLINE void add_bend(const Vec3& n, const At& a, const Vec3& u, const Vec3& v,
                               Bend& bend) const {
    Vec3 r = a.s;
    if constexpr (where == Where::posed) r -= c;
    const Vec3 Qu = times(u), Qv = times(v);
    const double inverse = 1.0 / n.dot(r), ru = r.dot(u), rv = r.dot(v);
    bend.uu += (u.dot(Qu) - ru * ru) * inverse;
    bend.uv += (u.dot(Qv) - ru * rv) * inverse;
    bend.vv += (v.dot(Qv) - rv * rv) * inverse;
  }
};

/// The common part of cylinders and cones: an axis, and rims around it.
template <Where where>
struct Round {
  static constexpr bool kKinks = true;

  Vec3 c;     ///< centre
  Vec3 axis;  ///< unit
  double radius;
  double half;  ///< half the height

  /// The part of n along the axis.
  HEADPIN_INLINE double along(const Vec3& n) const {
    if constexpr (where == Where::own) return n.z();
    return n.dot(axis);
  }
  /// The part of n across the axis, given z = n . axis. Near a pole it is a difference of almost
  /// equal vectors. Then its rounding error along the axis is removed: it would give a point off
  /// the shape, which proves nothing.
  HEADPIN_INLINE Vec3 across(const Vec3& n, double z) const {
    if constexpr (where == Where::own) return {n.x(), n.y(), 0.0};
    Vec3 w = n - z * axis;
    if (w.squaredNorm() < 1e-6 * z * z) w -= w.dot(axis) * axis;
    return w;
  }
  /// axis x n.
  HEADPIN_INLINE Vec3 round(const Vec3& n) const {
    if constexpr (where == Where::own) return {-n.y(), n.x(), 0.0};
    return axis.cross(n);
  }
  /// The point at height z on the axis, and w off it; w is across the axis.
  HEADPIN_INLINE Vec3 point(double z, const Vec3& w) const {
    if constexpr (where == Where::own) return {w.x(), w.y(), z};
    return c + w + z * axis;
  }
  HEADPIN_INLINE Vec3 point(double z) const {
    if constexpr (where == Where::own) return {0.0, 0.0, z};
    return c + z * axis;
  }

  HEADPIN_INLINE static void add_bend(const Vec3&, const At& a, const Vec3& u, const Vec3& v,
                                      Bend& bend) {
    const double tu = a.t.dot(u), tv = a.t.dot(v);
    bend.uu += a.bend * tu * tu;
    bend.uv += a.bend * tu * tv;
    bend.vv += a.bend * tv * tv;
  }
};

template <Where where>
struct Cylinder : Round<where> {
  using Round<where>::axis, Round<where>::radius, Round<where>::half;

  /// Height of the circle of side normals, n . axis = kink(), and its radius.
  double kink() const { return 0.0; }
  double kink_radius() const { return 1.0; }
  /// Whether the pole with n . axis of this sign is a cap.
  bool pole(double z) const { return z != 0.0; }

  HEADPIN_INLINE Vec3 support(const Vec3& n) const {
    const double z = this->along(n);
    const Vec3 w = this->across(n, z);
    const double rho2 = w.squaredNorm();
    const double k = rho2 > kAtPole2 * z * z ? radius / std::sqrt(rho2) : 0.0;
    return this->point(std::copysign(half, z), k * w);
  }
  HEADPIN_INLINE At at(const Vec3& n) const {
    const double z = this->along(n);
    const Vec3 w = this->across(n, z);
    const double rho = w.norm();
    if (rho < kOnKink) {
      return {this->point(std::copysign(half, z)), Vec3::Zero(), 0.0, At::disc, z > 0.0 ? 1 : -1};
    }
    const double inverse = 1.0 / rho, bend = radius * inverse;
    const Vec3 t = inverse * this->round(n);
    if (std::abs(z) < kOnKink) return {this->point(0.0, bend * w), t, bend, At::generator, 0};
    return {this->point(std::copysign(half, z), bend * w), t, bend, At::point, z > 0.0 ? 1 : -1};
  }
  Generator generator(const Vec3&, At& a) const { return {axis, -half, half, a.bend, 1}; }
};

template <Where where>
struct Cone : Round<where> {  ///< apex at c + half axis
  using Round<where>::axis, Round<where>::radius, Round<where>::half;

  double sine, cosine;  ///< of the half angle at the apex

  double kink() const { return sine; }
  double kink_radius() const { return cosine; }
  bool pole(double z) const { return z < 0.0; }

  HEADPIN_INLINE Vec3 support(const Vec3& n) const {
    const double z = this->along(n);
    const Vec3 w = this->across(n, z);
    const double rho = w.norm();
    if (2.0 * half * z > radius * rho) return this->point(half);
    const double k = rho * rho > kAtPole2 * z * z ? radius / rho : 0.0;
    return this->point(-half, k * w);
  }
  HEADPIN_INLINE At at(const Vec3& n) const {
    const double z = this->along(n);
    const Vec3 w = this->across(n, z);
    const double rho = w.norm();
    const double above = z * cosine - rho * sine;  // sine of the angle from the circle
    if (above >= -kOnKink) {
      return {this->point(half), Vec3::Zero(), 0.0, above > kOnKink ? At::point : At::generator,
              above > kOnKink ? 1 : 0};
    }
    if (rho < kOnKink) return {this->point(-half), Vec3::Zero(), 0.0, At::disc, -1};
    const double inverse = 1.0 / rho, bend = radius * inverse;
    return {this->point(-half, bend * w), inverse * this->round(n), bend, At::point, -1};
  }
  Generator generator(const Vec3& n, At& a) const {
    const Vec3 w = this->across(n, this->along(n));
    const double inverse = 1.0 / w.norm();
    a.t = inverse * this->round(n);
    return {sine * inverse * w - cosine * axis, 0.0, 2.0 * half / cosine, radius * inverse, -1};
  }
};

struct Hull {
  const engine::Polyhedron* shape;
  Mat3 R;  ///< of the shape in A's frame
  Vec3 p;
  double sign;                 ///< -1 when mirrored
  std::uint32_t last = kNone;  ///< the last support point; the next one is near it

  static constexpr std::uint32_t kNone = 0xffffffff;

  Vec3 support(const Vec3& n) {
    const Vec3 n_G = sign * (R.transpose() * n);
    last = last == kNone ? shape->furthest(n_G) : shape->climb(last, n_G);
    return vertex(last);
  }
  Vec3 vertex(std::uint32_t i) const { return sign * (R * shape->vertices()[i] + p); }
  Vec3 normal(const engine::Polyhedron::Face& f) const { return sign * (R * f.normal); }
};

/// A single vertex of a hull.
struct Point {
  static constexpr bool kKinks = false;
  static constexpr double radius = 0.0;

  Vec3 c;

  At at(const Vec3&) const { return {c, Vec3::Zero(), 0.0, At::point, 0}; }
  static void add_bend(const Vec3&, const At&, const Vec3&, const Vec3&, Bend&) {}
};

/// A single edge of a hull, as a cylinder with radius 0.
inline Cylinder<Where::posed> edge(const Hull& hull, std::uint32_t from, std::uint32_t to) {
  const Vec3 a = hull.vertex(from), b = hull.vertex(to), d = b - a;
  const double length = d.norm();
  return {{0.5 * (a + b), d / length, 0.0, 0.5 * length}};
}

inline Ellipsoid<Where::own> pose_A(const engine::Ellipsoid& s) {
  const Vec3 r2 = s.radii.cwiseProduct(s.radii);
  return {Vec3::Zero(), r2.x(), r2.y(), r2.z(), 0.0, 0.0, 0.0};
}
inline Cylinder<Where::own> pose_A(const engine::Cylinder& s) {
  return {{Vec3::Zero(), Vec3::UnitZ(), s.radius, s.half_height}};
}
inline Cone<Where::own> pose_A(const engine::Cone& s) {
  const double slant = std::sqrt(s.radius * s.radius + s.height * s.height);
  return {
      {Vec3::Zero(), Vec3::UnitZ(), s.radius, 0.5 * s.height}, s.radius / slant, s.height / slant};
}
inline Hull pose_A(const engine::Polyhedron& s) {
  return {&s, Mat3::Identity(), Vec3::Zero(), 1.0};
}

inline Ellipsoid<Where::posed> pose_B(const engine::Ellipsoid& s, const Pose& X_AB) {
  const Mat3 R = X_AB.q.toRotationMatrix();
  const Vec3 r2 = s.radii.cwiseProduct(s.radii);
  const auto q = [&](int i, int j) {
    return R(i, 0) * R(j, 0) * r2.x() + R(i, 1) * R(j, 1) * r2.y() + R(i, 2) * R(j, 2) * r2.z();
  };
  return {-X_AB.p, q(0, 0), q(1, 1), q(2, 2), q(0, 1), q(0, 2), q(1, 2)};
}
inline Cylinder<Where::posed> pose_B(const engine::Cylinder& s, const Pose& X_AB) {
  return {{-X_AB.p, mirrored_axis(X_AB.q), s.radius, s.half_height}};
}
inline Cone<Where::posed> pose_B(const engine::Cone& s, const Pose& X_AB) {
  const double slant = std::sqrt(s.radius * s.radius + s.height * s.height);
  return {{-X_AB.p, mirrored_axis(X_AB.q), s.radius, 0.5 * s.height},
          s.radius / slant,
          s.height / slant};
}
inline Hull pose_B(const engine::Polyhedron& s, const Pose& X_AB) {
  return {&s, X_AB.q.toRotationMatrix(), X_AB.p, -1.0};
}

}  // namespace headpin::engine::posed
