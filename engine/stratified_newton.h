#pragma once

#include "engine/posed.h"

/// Newton's method for the least depth of two of the paper's primitives. Private to the engine.
///
/// It minimises h(n) = n . S(n), the support function of A - B, over unit vectors n.
///
/// Where h is smooth, it makes Newton steps on the sphere: gradient g = S - h n, Hessian W - h 1 across
/// n, with W the radii of curvature (the second derivative of a support function; Schneider, Convex
/// Bodies, 2.5).
///
/// But contacts are at kinks of h most of the time. There are two kinds: the circle of normals of a
/// side, where a whole generator is furthest (n . axis = c; c = 0 for a cylinder, the sine of the half
/// angle for a cone), and the pole of a cap, where a whole disc is. A step that would cross a kink ends
/// on it. The search stays there while generator or disc contain a point that makes S parallel to n;
/// else it leaves by the end that comes nearest. A step that does not lower h is halved. Along a circle
/// of radius rho,
///
///     d2h / ds2 = t . W t + (c axis . S - h) / rho^2,    t along the circle,
///
/// with the apex, or any point of a cylinder's generator, for S.
namespace headpin::engine {

struct Descent {
  enum End { apart, least, unresolved };
  End end = unresolved;
  Vec3 n = Vec3::UnitZ();
  double h = 0.0;
  Vec3 s_A = Vec3::Zero(),
       s_B = Vec3::Zero();  ///< S = s_A + s_B, with B mirrored
  int evaluations = 0;
};

namespace newton {

using posed::At;
using posed::Bend;
using posed::Generator;

inline constexpr double kLongestStep = 0.7;  // rad

/// A curvature that is safe to divide by: small and negative ones become positive.
inline double safe(double curvature, double floor) {
  return curvature > floor ? curvature : floor + std::abs(curvature);
}

inline Vec3 unit(const Vec3& v) {
  return 1.0 / std::sqrt(v.squaredNorm()) * v;
}

/// 1 / sqrt(1 + x) for x below 1e-3, without a root and a division.
inline double inverse_root_above_1(double x) {
  return 1.0 + x * (-0.5 + x * (0.375 + x * (-0.3125 + x * 0.2734375)));
}

/// Two unit vectors perpendicular to n and to each other (Duff et al. 2017).
inline void across(const Vec3& n, Vec3& u, Vec3& v) {
  const double sign = std::copysign(1.0, n.z());
  const double a = -1.0 / (sign + n.z()), b = n.x() * n.y() * a;
  u = {1.0 + sign * n.x() * n.x() * a, sign * b, -sign * n.x()};
  v = {b, sign + n.y() * n.y() * a, -n.y()};
}

/// The Newton step in the plane: -H^-1 g, with H made positive. If h decreases to both sides, as at
/// the tips of two cones, it is the longest step in the downward direction.
///
/// @param tolerance   least decrease of h on such a step, without the slope [m]
/// @param[out] least  lower bound of the curvatures that it divided by; 0 if h decreases to both
///   sides
inline Vec2 step_of(const Bend& H, double gu, double gv, double floor, double tolerance,
                    double& least) {
  const double det = H.uu * H.vv - H.uv * H.uv, trace = H.uu + H.vv;
  // Both eigenvalues are above the floor.
  if (det > floor * trace - floor * floor && trace > 2.0 * floor) {
    least = det / trace;
    return 1.0 / det * Vec2(H.uv * gv - H.vv * gu, H.uv * gu - H.uu * gv);
  }
  const double half = 0.5 * (H.uu - H.vv), root = std::sqrt(half * half + H.uv * H.uv);
  const double high = safe(0.5 * trace + root, floor), lowest = 0.5 * trace - root;
  const bool falls = 0.5 * lowest * kLongestStep * kLongestStep < -tolerance;
  least = falls ? 0.0 : floor;
  // Eigenvector of the higher eigenvalue: that of [half uv; uv -half] with eigenvalue `root`.
  Vec2 x = half > 0.0 ? Vec2(root + half, H.uv) : Vec2(H.uv, root - half);
  const double length = x.norm();
  x = length > 0.0 ? Vec2(x / length) : Vec2::UnitX();
  const Vec2 y(-x.y(), x.x()), g(gu, gv);
  const double down =
      falls ? std::copysign(kLongestStep, -y.dot(g)) : -y.dot(g) / safe(lowest, floor);
  return -x.dot(g) / high * x + down * y;
}

/// The normal on both circles that is nearest to n; n itself if the circles do not meet.
template <typename A, typename B>
Vec3 on_both(const A& a, double ca, const B& b, double cb, const Vec3& n) {
  const Vec3 across = a.axis.cross(b.axis);
  const double sin2 = across.squaredNorm(), cosine = a.axis.dot(b.axis);
  if (sin2 < 1e-20) return n;
  const Vec3 in_plane = ((ca - cosine * cb) * a.axis + (cb - cosine * ca) * b.axis) / sin2;
  const double up2 = 1.0 - in_plane.squaredNorm();
  if (up2 < 0.0) return n;
  const double up = std::sqrt(up2 / sin2);
  return (in_plane + (n.dot(across) < 0.0 ? -up : up) * across).normalized();
}

template <typename Shape>
Vec3 onto_circle(const Shape& s, const Vec3& n) {
  const Vec3 w = s.across(n, s.along(n));
  const double rho = w.norm();
  if (!(rho > 0.0)) return n;
  return s.kink() * s.axis + s.kink_radius() / rho * w;
}

/// Which side of the circle the direction lies on.
template <typename Shape>
int side_of(const Shape& s, const Vec3& n) {
  return s.along(n) > s.kink() ? 1 : -1;
}

/// Whether the step from n to `next` passes over the pole of a cap.
template <typename Shape>
bool over_pole(const Shape& s, const Vec3& n, const Vec3& next) {
  const double z0 = s.along(n), z1 = s.along(next);
  return z0 * z1 > 0.0 && s.pole(z1) && n.dot(next) - z0 * z1 < 0.0;
}

template <typename Shape>
Vec3 pole_near(const Shape& s, const Vec3& n) {
  return s.along(n) < 0.0 ? Vec3(-s.axis) : s.axis;
}

/// Makes the point of a generator at tau the support point.
inline void move(At& a, const Generator& line, double tau, Vec3& g) {
  a.s += tau * line.e;
  g += tau * line.e;
}

/// Leaves a generator at the end that is nearest to tau.
inline void leave(At& a, const Generator& line, double tau, Vec3& g) {
  const bool high = tau > 0.5 * (line.low + line.high);
  move(a, line, high ? line.high : line.low, g);
  if (high) a.bend = line.bend_high;
  a.side = high ? line.high_side : -line.high_side;
  a.set = At::point;
}

inline double outside(double tau, double low, double high) {
  return std::max({low - tau, tau - high, 0.0});
}

}  // namespace newton

/// Moves a normal of the last frame onto the kink next to it, if there is one. Most contacts are at
/// kinks, and those of B have moved since. A wrong guess costs one evaluation.
template <typename A, typename B>
Vec3 onto_kinks(const A& a, const B& b, const Vec3& n) {
  constexpr double kNear = 0.02;  // rad
  bool near_a = false, near_b = false;
  if constexpr (A::kKinks) {
    const double z = a.along(n);
    if (std::abs(z) > 1.0 - 0.5 * kNear * kNear && a.pole(z))
      return z < 0.0 ? Vec3(-a.axis) : a.axis;
    near_a = std::abs(z - a.kink()) < kNear * a.kink_radius();
  }
  if constexpr (B::kKinks) {
    const double z = b.along(n);
    if (std::abs(z) > 1.0 - 0.5 * kNear * kNear && b.pole(z))
      return z < 0.0 ? Vec3(-b.axis) : b.axis;
    near_b = std::abs(z - b.kink()) < kNear * b.kink_radius();
  }
  if constexpr (A::kKinks && B::kKinks) {
    if (near_a && near_b) return newton::on_both(a, a.kink(), b, b.kink(), n);
  }
  if constexpr (A::kKinks) {
    if (near_a) return newton::onto_circle(a, n);
  }
  if constexpr (B::kKinks) {
    if (near_b) return newton::onto_circle(b, n);
  }
  return n;
}

namespace newton {

/// Lengths of a search [m]: the least decrease of h on a step, and the least curvature.
struct Scale {
  double tolerance, floor;
};

/// State of a search at the normal n. The points of A and B move along generators and discs until S
/// is as parallel to n as possible.
template <typename A, typename B>
struct Place {
  Place(const A& shape_a, const B& shape_b, const Vec3& normal)
      : a(shape_a), b(shape_b), n(normal), at_a(a.at(n)), at_b(b.at(n)) {}

  const A& a;
  const B& b;
  const Vec3& n;
  At at_a, at_b;
  const Vec3 S = at_a.s + at_b.s;
  const double h = n.dot(S);
  Vec3 g;  // gradient: S - h n, as the points move
  Generator line_a, line_b;
  const At* held = nullptr;  // the search stays on its circle
  Vec3 S_low;                // S before the points moved along the held generators

  void look_for_generators() {
    g = S - h * n;
    if constexpr (A::kKinks) {
      if (at_a.set == At::generator) line_a = a.generator(n, at_a);
    }
    if constexpr (B::kKinks) {
      if (at_b.set == At::generator) line_b = b.generator(n, at_b);
    }
  }
  void answer(Descent& d, Descent::End end) const {
    d.end = end;
    d.n = n;
    d.h = h;
    d.s_A = at_a.s;
    d.s_B = at_b.s;
  }
};

// The five cases. Each returns whether the search is at the minimum. If not, it sets the next aim,
// or leaves this to a later case.

/// A whole cap is furthest: a face on a face, or something stands on the cap.
template <typename A, typename B>
bool on_disc(Place<A, B>& p, const Scale& scale, Vec3& aim) {
  const auto nearest = [&](At& x, const Generator& line) {
    if (x.set == At::generator) {
      move(x, line, std::clamp(-p.g.dot(line.e), line.low, line.high), p.g);
    }
  };
  nearest(p.at_a, p.line_a);
  nearest(p.at_b, p.line_b);
  const double radius_a = p.at_a.set == At::disc ? p.a.radius : 0.0;
  const double radius_b = p.at_b.set == At::disc ? p.b.radius : 0.0;
  const double radius = radius_a + radius_b, off = p.g.norm();
  if (off <= radius) {
    p.at_a.s -= radius_a / radius * p.g;
    p.at_b.s -= radius_b / radius * p.g;
    return true;
  }
  const Vec3 out = p.g / off;
  p.at_a.s -= radius_a * out;
  p.at_b.s -= radius_b * out;
  Bend H;
  p.a.add_bend(p.n, p.at_a, out, Vec3::Zero(), H);
  p.b.add_bend(p.n, p.at_b, out, Vec3::Zero(), H);
  const double step = (off - radius) / safe(H.uu - p.h, scale.floor);
  if (0.5 * step * (off - radius) < scale.tolerance) return true;
  aim = unit(p.n - std::min(step, kLongestStep) * out);
  return false;
}

/// Two generators. If they cross, they meet in one point, or the search leaves the one that ends
/// first. If they are parallel, they act as one long generator.
template <typename A, typename B>
bool on_two_generators(Place<A, B>& p) {
  const double det = p.n.dot(p.line_a.e.cross(p.line_b.e));
  if (std::abs(det) > 1e-6) {  // crossed
    const double ta = -p.n.dot(p.g.cross(p.line_b.e)) / det;
    const double tb = -p.n.dot(p.line_a.e.cross(p.g)) / det;
    const double out_a = outside(ta, p.line_a.low, p.line_a.high);
    const double out_b = outside(tb, p.line_b.low, p.line_b.high);
    if (out_a == 0.0 && out_b == 0.0) {
      move(p.at_a, p.line_a, ta, p.g);
      move(p.at_b, p.line_b, tb, p.g);
      return true;
    }
    out_a >= out_b ? leave(p.at_a, p.line_a, ta, p.g) : leave(p.at_b, p.line_b, tb, p.g);
    return false;
  }
  const double same = p.line_a.e.dot(p.line_b.e) > 0.0 ? 1.0 : -1.0;
  const double tau = -p.g.dot(p.line_a.e);
  const double low = same > 0.0 ? p.line_b.low : -p.line_b.high;
  const double high = same > 0.0 ? p.line_b.high : -p.line_b.low;
  if (tau < p.line_a.low + low || tau > p.line_a.high + high) {
    leave(p.at_a, p.line_a, tau, p.g);
    leave(p.at_b, p.line_b, same * tau, p.g);
    return false;
  }
  const double ta = std::clamp(tau, p.line_a.low, p.line_a.high);
  p.S_low = p.S;
  move(p.at_a, p.line_a, ta, p.g);
  move(p.at_b, p.line_b, same * (tau - ta), p.g);
  p.held = &p.at_a;
  return false;
}

/// One generator: the search stays on its circle while the generator contains the point that makes
/// S parallel to n.
template <typename A, typename B>
void on_generator(Place<A, B>& p, At& x, const Generator& line) {
  if (x.set != At::generator || p.held != nullptr) return;
  const double tau = -p.g.dot(line.e);
  if (tau < line.low || tau > line.high) {
    leave(x, line, tau, p.g);
    return;
  }
  p.S_low = p.at_a.s + p.at_b.s;
  move(x, line, tau, p.g);
  p.held = &x;
}

/// A step along the circle of the held generator.
template <typename A, typename B>
bool along_circle(const Place<A, B>& p, const Scale& scale, Vec3& aim) {
  const Vec3 t = p.held->t;
  Bend H;
  p.a.add_bend(p.n, p.at_a, t, Vec3::Zero(), H);
  p.b.add_bend(p.n, p.at_b, t, Vec3::Zero(), H);
  const auto along = [&](const auto& s) {
    if constexpr (std::decay_t<decltype(s)>::kKinks) {
      const double c = s.kink(), rho = s.kink_radius();
      const double curvature =
          safe(H.uu + (c * s.axis.dot(p.S_low) - p.h) / (rho * rho), scale.floor);
      const double gt = p.g.dot(t), step = -gt / curvature;
      if (-0.5 * gt * step < scale.tolerance) return true;
      const Vec3 w = p.n - c * s.axis + std::clamp(step, -kLongestStep, kLongestStep) * t;
      aim = c * s.axis + rho * unit(w);
    }
    return false;
  };
  return p.held == &p.at_a ? along(p.a) : along(p.b);
}

/// Where h is smooth: Newton's step on the sphere.
///
/// @param stiffness  least curvature at the last such step; near the minimum it is exact enough
template <typename A, typename B>
bool across_smooth(const Place<A, B>& p, const Scale& scale, double& stiffness, Vec3& aim) {
  if (p.g.squaredNorm() < scale.tolerance * stiffness) return true;
  Vec3 u, v;
  across(p.n, u, v);
  Bend H;
  p.a.add_bend(p.n, p.at_a, u, v, H);
  p.b.add_bend(p.n, p.at_b, u, v, H);
  H.uu -= p.h;
  H.vv -= p.h;
  const double gu = p.g.dot(u), gv = p.g.dot(v);
  Vec2 step = step_of(H, gu, gv, scale.floor, scale.tolerance, stiffness);
  const double length2 = step.squaredNorm();
  if (length2 < kLongestStep * kLongestStep &&
      -0.5 * (gu * step.x() + gv * step.y()) < scale.tolerance) {
    return true;
  }
  if (length2 > kLongestStep * kLongestStep) step *= kLongestStep / std::sqrt(length2);
  aim = p.n + step.x() * u + step.y() * v;
  aim *= length2 < 1e-3 ? inverse_root_above_1(length2) : 1.0 / aim.norm();
  return false;
}

/// Selects the case. @return whether the search is at the minimum
template <typename A, typename B>
bool at_least(Place<A, B>& p, const Scale& scale, double& stiffness, Vec3& aim) {
  p.look_for_generators();
  if (p.at_a.set == At::disc || p.at_b.set == At::disc) return on_disc(p, scale, aim);
  if (p.at_a.set == At::generator && p.at_b.set == At::generator && on_two_generators(p)) {
    return true;
  }
  on_generator(p, p.at_a, p.line_a);
  on_generator(p, p.at_b, p.line_b);
  return p.held != nullptr ? along_circle(p, scale, aim) : across_smooth(p, scale, stiffness, aim);
}

/// Kinks on the way of a step.
struct Kinks {
  int side_a = 0,
      side_b = 0;  // of the circles of kinks the step started from; 0: may cross
  bool hold_a = false, hold_b = false, free_a = false, free_b = false;

  template <typename A, typename B>
  void note(const Place<A, B>& p) {
    side_a = p.at_a.side;
    side_b = p.at_b.side;
    hold_a = p.held == &p.at_a;
    hold_b = p.held == &p.at_b;
    free_a = p.at_a.set != At::disc;
    free_b = p.at_b.set != At::disc;
  }

  /// The end of a step. A step that would cross a kink ends on it. A pole that was no better is not
  /// tried again.
  template <typename A, typename B>
  Vec3 stop(const A& a, const B& b, const Vec3& from, const Vec3& to, bool again) const {
    if constexpr (A::kKinks) {
      if (free_a && !again && over_pole(a, from, to)) return pole_near(a, to);
    }
    if constexpr (B::kKinks) {
      if (free_b && !again && over_pole(b, from, to)) return pole_near(b, to);
    }
    bool over_a = false, over_b = false;
    if constexpr (A::kKinks) over_a = side_a != 0 && side_of(a, to) != side_a;
    if constexpr (B::kKinks) over_b = side_b != 0 && side_of(b, to) != side_b;
    if constexpr (A::kKinks && B::kKinks) {
      if ((over_a || hold_a) && (over_b || hold_b) && (over_a || over_b)) {
        const Vec3 both = on_both(a, a.kink(), b, b.kink(), to);
        if ((both - to).squaredNorm() < (to - from).squaredNorm()) return both;
      }
    }
    if constexpr (A::kKinks) {
      if (over_a) return onto_circle(a, to);
    }
    if constexpr (B::kKinks) {
      if (over_b) return onto_circle(b, to);
    }
    return to;
  }
};

}  // namespace newton

/// Descends from n to a local minimum of h.
///
/// @param a, b    posed shapes, b mirrored
/// @param n       unit
/// @param size    of the smaller shape [m]: scale of tolerances
/// @param margin  stops with `apart` where h < -margin
/// @param cap     most evaluations
template <typename A, typename B>
HEADPIN_FLATTEN HEADPIN_OUT_OF_LINE Descent descend(const A& a, const B& b, Vec3 n, double size,
                                                    double margin, int cap) {
  using namespace newton;
  const Scale scale{1e-11 * size, 0.02 * size};
  Descent d;
  Vec3 aim = n;  // target of the last step, without kinks
  Kinks kinks;
  double stiffness = 0.0;
  for (int k = 1; k <= cap; ++k) {
    Place<A, B> p(a, b, n);
    d.evaluations = k;
    if (p.h < -margin) {
      p.answer(d, Descent::apart);
      return d;
    }
    if (k > 1 && p.h > d.h + 1e-13 * size) {  // the step was too long: halve it
      aim = unit(aim + d.n);
      n = kinks.stop(a, b, d.n, aim, true);
      continue;
    }
    p.answer(d, Descent::unresolved);
    if (at_least(p, scale, stiffness, aim)) {
      p.answer(d, Descent::least);
      return d;
    }
    kinks.note(p);
    n = kinks.stop(a, b, d.n, aim, false);
  }
  return d;
}

}  // namespace headpin::engine
