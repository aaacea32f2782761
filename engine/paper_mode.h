#pragma once

#include "engine/search.h"

/// The search of the paper's mode. Private to the engine.
namespace headpin::engine {

/// One step of the paper's iteration. S is the support point of A - B along the normal n; the plane
/// across n does not separate if h >= 0. The mirror image of n in S (Chung and Wong 1996) would
/// subtract 2 (h / S.S) S. In measurements, 1.5 left the fewest pairs unresolved.
inline Vec3 turned(const Vec3& n, const Support& s) {
  return unit_or(n - 1.5 * s.h / s.S.squaredNorm() * s.S, n);
}

/// Whether S is parallel to the normal: equations (1), (2).
inline bool parallel(const Support& s, const Vec3& n) {
  return (s.S - s.h * n).squaredNorm() <= 1e-12 * s.S.squaredNorm();
}

/// The paper's search. It ends at the cap, if D is parallel to N, or at a proof of separation.
///
/// Where S is nearly parallel to n, as for shapes that meet, the steps towards a proof turn n over.
/// So after half of the cap, when such a step finds no lower plane, the search continues from the
/// lowest plane. It turns n by the part of S across n divided by both arms; for two spheres this
/// leads to the line of centres. Each time that it finds no lower plane, it halves the turn. The
/// answer is the lowest plane.
///
/// @param c_A, c_B  centres from which the arms of the support points are measured, in A's frame
template <typename S>
HEADPIN_FLATTEN HEADPIN_OUT_OF_LINE Closest paper(S& search, Vec3 n, const Support& first,
                                                  const Vec3& c_A, const Vec3& c_B, int cap) {
  if (first.h < 0.0) return search.answer(first, n);
  Support s = first, best = first;
  Vec3 best_n = n;
  bool to_proof = true;
  double turn = 1.0;
  while (search.evaluations < cap) {
    if (parallel(best, best_n)) return search.answer(best, best_n);
    if (to_proof) {
      n = turned(n, s);
    } else {
      const double arms = (best.s_A - c_A).norm() + (best.s_B + c_B).norm();
      const Vec3 across = best.S - best.h * best_n;
      n = unit_or(best_n - turn / arms * across, best_n);
    }
    s = search(n);
    if (s.h < 0.0) return search.answer(s, n);
    if (s.h < best.h) {
      best = s;
      best_n = n;
      turn = 1.0;
    } else if (to_proof) {
      to_proof = search.evaluations < (cap + 1) / 2;
    } else {
      turn *= 0.5;
    }
  }
  Closest c = search.answer(best, best_n);
  c.capped = true;
  return c;
}

/// The rule of older trials: depth of the best plane, normal and points of the last one.
template <typename S>
HEADPIN_FLATTEN HEADPIN_OUT_OF_LINE Closest paper_last(S& search, Vec3 n, const Support& first,
                                                       int cap) {
  Support s = first;
  double least = s.h;
  while (search.evaluations < cap) {
    if (parallel(s, n)) return search.answer(s, n);
    n = turned(n, s);
    s = search(n);
    if (s.h < 0.0) return search.answer(s, n);
    least = std::min(least, s.h);
  }
  Closest c = search.answer(s, n);
  c.distance = -least;
  c.capped = true;
  return c;
}

}  // namespace headpin::engine
