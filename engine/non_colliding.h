#pragma once

#include <cstdint>

#include "engine/shape.h"

/// The non-colliding method: proof that two convex shapes are apart, or where, which way and how
/// deep they meet (Uno and Slater 1997, section 2.1).
///
/// For a unit vector n let g(n) = n . (s_B(-n) - s_A(n)), the gap between the planes across n that
/// hold A and B back (s: support). Where g(n) > 0 the planes prove that A and B are apart and the
/// search stops. The largest g is the distance, or minus the depth. Every verdict comes with its
/// proof: apart with such a plane, meeting with a point of both, or with GJK's failure to find a
/// plane.
///
///     #include "engine/non_colliding.h"
///
///     const Shape ball = Ellipsoid{{0.108, 0.108, 0.108}};
///     const Shape pin = Cylinder{.radius = 0.06, .half_height = 0.19};
///     KeptNormal kept;  // for this pair from frame to frame: a warm start
///     const Closest c = closest_points(ball, pin, relative(X_WA, X_WB), kept, {});
///     if (!c.separated) push(X_WA * c.p_A, X_WA.q * c.n_AB, -c.distance);
///
/// Link with headpin::engine; compounds and resting contacts are in contacts.h.
///
/// Two modes:
/// - paper: from the line of centres, at most `cap` steps, then equations (1), (2) of the plane of
///   least overlap that was looked at. It never calls a pair that meets separated, but it calls flat
///   things that are apart a contact (parallel caps at cap 5 nearly always), and its depth is the
///   true one or more: at cap 20 by 3 % in half of the shallow pairs, with a normal 1 degree off; at
///   cap 5 by a third, 5 degrees off. One contact point.
/// - converged, the default: the same start and the same way out at every evaluation, then Newton's
///   method until (1), (2) hold (stratified_newton.h), a hull being replaced by its face, edge or
///   vertex in view, and GJK from outside for what is left. Such a minimum need not be the least
///   way out, nor prove that the shapes meet: it counts when a ball of its length fits in between
///   (most do), else an expanding polytope looks for shorter ways round it (polytope.h).
///
/// What converged mode promises of any two shapes of aspect ratios to 100 and sizes of 1e-3 to 1e3,
/// cold and from any kept normal; size is the radius about the smaller shape's origin:
///
///     verdict                    right when the gap is over 1e-6 of the size, or the overlap over
///                                1e-9 of both sizes
///     overlap under 5 % of size  the least way out, to 1 % and 1e-8 of the size
///     gap within the margin      the distance, to 1 % and 1e-6 of the size
///     deeper overlap             the same verdict; a way out that no start found shorter, and
///                                nearly always the least
///
/// tests/campaign tries a million pairs of each two kinds of shapes against proofs of its own.
///
/// What of the paper mode is the paper's: the start at the line of centres, the furthest points, the
/// end at N . D > 0 or at D parallel to N (here to 1e-6), the cap, equations (1) and (2). How a new
/// normal is found is only in [UNO 96], which nobody has, so that is ours:
/// - towards a proof, a step of 1.5 times the projection onto the plane across D, between the
///   projection and the mirror image of Chung and Wong (1996), which left fewest pairs undecided;
/// - after half of the cap, once such a step comes to no lower plane, a turn by the part of D across N
///   over the two arms, as steps towards a proof do not end at the closest points of pairs that meet:
///   more of them made normal and depth worse;
/// - at the cap, the answer is the best plane's, not the last one's.
/// Warm starts, Newton's method and the fallback are ours too. The distance d is N . D, which is |D|
/// at convergence.
namespace headpin::engine {

struct Closest {
  bool separated = false;
  /// Separated: the gap between the planes across n_AB, at most the distance (the search stops at
  /// the first proof). Otherwise minus the depth [m].
  double distance = 0.0;
  Vec3 p_A = Vec3::Zero(), p_B = Vec3::Zero();  ///< in A's frame [m]; A's and B's surface
  Vec3 n_AB = Vec3::UnitZ();                    ///< unit, from A to B, in A's frame
  int iterations = 0;                           ///< evaluations of the two support functions
  bool capped = false;  ///< the cap of the iteration was reached: in paper mode the depth is
                        ///< that or less, in converged mode the fallback answered
};

/// What a pair of shapes keeps from query to query, to start from.
struct KeptNormal {
  enum Of : std::uint8_t {
    none,   ///< nothing to start from
    apart,  ///< they were further apart than the margin, as the plane across the normal proved
    met     ///< they were closer
  };
  Vec3 n_AB = Vec3::Zero();  ///< unit, from A to B, in A's frame
  Of of = none;
};

struct Query {
  enum Mode {
    paper,     ///< stop at the cap: may say "intersecting" wrongly, and depth is a guess
    converged  ///< the default: carry on until equations (1), (2) hold
  };
  Mode mode = converged;
  int cap = 20;       ///< 5..20 in the paper
  bool warm = false;  ///< paper mode starts from the kept normal, which is ours and not of 1997
  bool last =
      false;  ///< paper mode answers from the last plane and turns towards a proof alone, as
              ///< trials were recorded before it answered from the best
  /// Converged mode stops at the proof of a gap of more than this; a closer pair gets its closest
  /// points, apart or not [m].
  double margin = 0.0;
};

/// Whether a kept normal is where the query begins.
inline bool starts_warm(const Query& query) {
  return query.mode == Query::converged || query.warm;
}

/// @param X_AB  frame of b in the frame of a
/// @param kept  of the last query of this pair; wrong, stale or not finite ones are harmless
/// @throws std::invalid_argument  for two half-spaces
Closest closest_points(const Shape& a, const Shape& b, const Pose& X_AB, KeptNormal& kept,
                       const Query& query);

}  // namespace headpin::engine
