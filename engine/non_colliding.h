#pragma once

#include <cstdint>

#include "engine/shape.h"

/// The non-colliding method: proof that two convex shapes are apart, or where, which way and how
/// deep they meet (Uno and Slater 1997, section 2.1).
///
/// For unit n let g(n) = n . (s_B(-n) - s_A(n)): the gap between the two planes across n that hold
/// A and B back. Where g(n) > 0 the planes prove that A and B are apart, and the search may stop;
/// the largest g is the distance, or minus the depth. The paper climbs from the centre line for at
/// most `cap` steps and takes what it then has.
///
///     Vec3 n_AB = Vec3::Zero();  // kept for this pair from frame to frame
///     const Closest c = closest_points(Ellipsoid{{.1, .1, .1}}, Cylinder{.06, .19}, X_AB, n_AB,
///     {}); if (!c.separated) push(X_WA * c.p_A, X_WA.q * c.n_AB, -c.distance);
namespace headpin::engine {

struct Closest {
  bool separated = false;
  /// Separated: the gap between the planes across n_AB, at most the distance (the search stops at
  /// the first proof). Otherwise minus the depth [m].
  double distance = 0.0;
  Vec3 p_A = Vec3::Zero(), p_B = Vec3::Zero();  ///< in A's frame [m]; A's and B's surface
  Vec3 n_AB = Vec3::UnitZ();                    ///< unit, from A to B, in A's frame
  int iterations = 0;                           ///< evaluations of the two support functions
  bool capped = false;  ///< the cap of the iteration was reached (then the fallback answered)
};

struct Query {
  enum Mode {
    paper,     ///< stop at the cap: may say "intersecting" wrongly, and depth is a guess
    converged  ///< the default: carry on until equations (1), (2) hold
  };
  Mode mode = converged;
  int cap = 20;  ///< 5..20 in the paper
  /// Converged mode stops at the proof of a gap of more than this; a closer pair gets its closest
  /// points, apart or not [m].
  double margin = 0.0;
};

/// @param X_AB        frame of b in the frame of a
/// @param n_AB_cache  last normal of this pair in A's frame; zero, stale or not finite ones are
///   harmless. Left as the normal to start from next time.
/// @throws std::invalid_argument  for two half-spaces
Closest closest_points(const Shape& a, const Shape& b, const Pose& X_AB, Vec3& n_AB_cache,
                       const Query& query);

}  // namespace headpin::engine
