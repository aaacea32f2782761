#pragma once

#include "engine/search.h"

/// The search of the paper's mode. Private to the engine.
namespace headpin::engine {

/// One step of the paper's iteration. S = A - B looked at from the plane's
/// normal n; the point S lies on the wrong side of the origin when h >= 0. The
/// mirror image of n in S (Chung and Wong 1996) would take away 2 (h / S.S)
/// S; 1.5 was measured to leave fewest pairs unresolved.
inline Vec3 turned(const Vec3& n, const Support& s) {
  return unit_or(n - 1.5 * s.h / s.S.squaredNorm() * s.S, n);
}

/// The points lie along the normal: equations (1), (2).
inline bool parallel(const Support& s, const Vec3& n) {
  return (s.S - s.h * n).squaredNorm() <= 1e-12 * s.S.squaredNorm();
}

/// Up to the cap, as the paper has it: D parallel to N ends it, and so does a
/// proof of separation.
///
/// Where S lies nearly along n, as it does where shapes meet, the steps towards
/// a proof turn n over. So after half of the cap, as soon as one leads to no
/// lower plane, the search goes on from the lowest: n is turned by the part of
/// S across it over both arms, which for two spheres is the way to the line of
/// centres, and by half as much each time that this leads to no lower plane.
/// The answer is the lowest plane.
///
/// @param c_A, c_B  from where the arms of the furthest points are measured, in
/// A's frame
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

/// As old trials have it: the depth of the best plane, normal and points of the
/// last.
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
