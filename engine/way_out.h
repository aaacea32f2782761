#pragma once

#include "base/math.h"
#include "engine/non_colliding.h"
#include "engine/shape.h"

/// Proofs for closest points that need no search. Private to the engine.
namespace headpin::engine {

/// A way out counts as the least if no other one is shorter than kLeast times its length minus
/// kRounding times the size.
inline constexpr double kLeast = 0.9905, kRounding = 5e-9;

/// Whether an ellipsoid contains a ball about a point. The test uses a second ball, with the
/// curvature of the sharpest end, which touches the ellipsoid from inside where its normal is n.
/// `in` goes from there to the point.
inline bool holds_ball(const Ellipsoid& s, const Vec3& in, const Vec3& n, double radius) {
  const double least = s.radii.minCoeff(), r = least * least / s.radii.maxCoeff();
  return r - (in + r * n).norm() >= radius;
}
template <typename S>
bool holds_ball(const S&, const Vec3&, const Vec3&, double) {
  return false;
}

/// A shorter way out must be below this [m].
inline double to_beat(const Closest& c, double size) {
  return -kLeast * c.distance - kRounding * size;
}

/// Whether the answer is proven: the shapes are apart, or the way out is the least, because a ball
/// of almost its length about its end lies within the other shape. This is true for most ways out
/// that start at a vertex, a cap or a smooth surface.
template <typename A, typename B>
bool is_proven(const A& a, const B& b, const Pose& X_AB, const Closest& c, double size) {
  if (c.separated) return true;
  const double radius = to_beat(c, size);
  const Vec3 in = c.p_B - c.p_A;
  return holds_ball(a, in, c.n_AB, radius) || holds_ball(b, -in, -c.n_AB, radius) ||
         clearance(a, c.p_B) >= radius ||
         clearance(b, X_AB.q.conjugate() * (c.p_A - X_AB.p)) >= radius;
}

/// Whether a gap is the distance: the points are hardly further apart than the planes.
inline bool is_distance(const Closest& c, double size) {
  return kLeast * (c.p_B - c.p_A).norm() <= c.distance + 0.5e-6 * size;
}

}  // namespace headpin::engine
