#pragma once

#include "engine/math.h"
#include "engine/non_colliding.h"
#include "engine/shape.h"

/// What is proven of closest points without a search. Private to the engine.
namespace headpin::engine {

/// A way out counts as the least when none is shorter than this part of it, less this part of the
/// size.
inline constexpr double kLeast = 0.9905, kRounding = 5e-9;

/// Whether an ellipsoid holds a ball about a point, by one as round as its sharpest end, which
/// touches it from within where its normal is n; `in` is from there to the point.
inline bool holds_ball(const Ellipsoid& s, const Vec3& in, const Vec3& n, double radius) {
  const double least = s.radii.minCoeff(), r = least * least / s.radii.maxCoeff();
  return r - (in + r * n).norm() >= radius;
}
template <typename S>
bool holds_ball(const S&, const Vec3&, const Vec3&, double) {
  return false;
}

/// What a shorter way out must beat.
inline double to_beat(const Closest& c, double size) {
  return -kLeast * c.distance - kRounding * size;
}

/// Whether nothing is left to look for: the shapes are apart, or the way out is the least, as a ball
/// of almost its length about the end of it lies within the other shape. That is true of most that
/// begin at a vertex, a cap or a smooth surface.
template <typename A, typename B>
bool is_proven(const A& a, const B& b, const Pose& X_AB, const Closest& c, double size) {
  if (c.separated) return true;
  const double radius = to_beat(c, size);
  const Vec3 in = c.p_B - c.p_A;
  return holds_ball(a, in, c.n_AB, radius) || holds_ball(b, -in, -c.n_AB, radius) ||
         clearance(a, c.p_B) >= radius ||
         clearance(b, X_AB.q.conjugate() * (c.p_A - X_AB.p)) >= radius;
}

/// Whether a gap is the distance, as the points are hardly further apart.
inline bool is_distance(const Closest& c, double size) {
  return kLeast * (c.p_B - c.p_A).norm() <= c.distance + 0.5e-6 * size;
}

}  // namespace headpin::engine
