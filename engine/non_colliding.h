#pragma once

#include <cstdint>

#include "engine/shape.h"

/// The non-colliding method: proof that two convex shapes are apart, or where, which way and how
/// deep they meet (Uno and Slater 1997, section 2.1).
///
/// For a unit vector n let g(n) = n . (s_B(-n) - s_A(n)), the gap between the support planes of A
/// and B across n (s: support point). Where g(n) > 0 the planes prove that A and B are apart and
/// the search stops. The largest g is the distance, or minus the depth. Every verdict has a proof.
/// If the shapes are apart, the proof is such a plane. If they intersect, the proof is a common
/// point, or the fact that GJK finds no separating plane.
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
/// - paper: starts from the line of centres and makes at most `cap` steps. Then it applies
///   equations (1), (2) to the plane of least overlap that it found. It never reports a pair that
///   meets as separated. But it reports flat shapes that are apart as a contact (parallel caps at
///   cap 5 nearly always), and its depth is the true one or more: for half of the shallow pairs of
///   the paper's primitives 3 to 7 % more at cap 20, with a normal 1 degree off, and a third to all of it more
///   at cap 5, 5 degrees off; of polyhedra, up to twice the true one at cap 20. One contact point.
/// - converged, the default: the same start, and it also stops at the first proof of separation.
///   Then Newton's method runs until (1), (2) hold (stratified_newton.h), with the face, edge or
///   vertex in view in place of a hull. GJK from outside solves the rest. Such a minimum need not
///   be the least way out, and does not prove that the shapes meet. It is accepted if a ball of
///   almost its length fits in between (for most pairs). Otherwise an expanding polytope searches
///   for shorter ways around it (polytope.h).
///
/// Accuracy of converged mode for any two shapes with aspect ratios to 100 and sizes of 1e-3 to
/// 1e3, cold and from any kept normal; size is the radius about the smaller shape's origin:
///
///     verdict                    right when the gap is over 1e-6 of the size, or the overlap over
///                                1e-9 of both sizes
///     overlap under 5 % of size  the least way out, to 1 % and 1e-8 of the size
///     gap within the margin      the distance, to 1 % and 1e-6 of the size
///     deeper overlap             the same verdict; a way out that no start found shorter, and
///                                nearly always the least
///
/// tests/campaign checks a million pairs of each two kinds of shapes against proofs of its own.
///
/// These parts of paper mode are from the paper: the start at the line of centres, the support
/// points, the end at N . D > 0 or at D parallel to N (here to 1e-6), the cap, equations (1) and
/// (2). The rule for a new normal is only in [UNO 96], which is not available. These rules are
/// therefore ours:
/// - Towards a proof, a step of 1.5 times the projection onto the plane across D. This is between
///   the projection and the mirror image of Chung and Wong (1996), and left the fewest pairs
///   undecided.
/// - After half of the cap, when such a step finds no lower plane, a turn by the part of D across N
///   divided by the two arms. Steps towards a proof do not end at the closest points of pairs that
///   meet; more of them made normal and depth worse.
/// - At the cap, the answer comes from the best plane, not from the last one.
///
/// Warm starts, Newton's method and the fallback are also ours. The distance d is N . D, which is
/// |D| at convergence.
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

/// The normal of a pair of shapes, kept for the warm start of its next query.
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
  bool warm = false;  ///< paper mode starts from the kept normal, which is not in the paper
  bool last =
      false;  ///< paper mode answers from the last plane and only makes steps towards a proof,
              ///< as in older trials
  bool steady = true;  ///< points of faces keep their numbers from step to step; in older trials
                       ///< they are numbered from the deepest
  /// A face that alone is within a body's reach carries it as a half-space does, and discs stand on
  /// four points of their rim. In older trials each pair of parts is searched, and discs stand on three
  /// points on a half-space.
  bool faces = true;
  /// Parts of a compound of polyhedra are left out where their boxes do not meet the body's. Under older
  /// rules they are tested, which may give the next query another normal to start from.
  bool boxes = true;
  /// Converged mode stops at the proof of a gap of more than this; a closer pair gets its closest
  /// points, apart or not [m].
  double margin = 0.0;
};

/// Whether the query starts from the kept normal.
inline bool starts_warm(const Query& query) {
  return query.mode == Query::converged || query.warm;
}

/// @param X_AB  frame of b in the frame of a
/// @param kept  of the last query of this pair; wrong, stale or not finite ones are harmless
/// @throws std::invalid_argument  for two half-spaces
Closest closest_points(const Shape& a, const Shape& b, const Pose& X_AB, KeptNormal& kept,
                       const Query& query);

}  // namespace headpin::engine
