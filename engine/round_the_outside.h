#pragma once

#include "engine/gjk.h"
#include "engine/search.h"
#include "engine/way_out.h"

/// GJK from points outside of A - B. Private to the engine.
namespace headpin::engine {

/// Moves along the outside of A - B to a local minimum of h.
///
/// The point p = (h + off) n is outside, beyond the best plane so far. Either the plane at the
/// point of A - B nearest to p is lower, or p is already above a minimum. GJK finds that nearest
/// point. Its simplex stays valid when p moves, so p moves as soon as a step finds a lower plane.
template <typename S>
HEADPIN_FLATTEN HEADPIN_OUT_OF_LINE Closest from_outside(S& search, Vec3 n, Support best,
                                                         double size, double margin,
                                                         double tolerance) {
  const double off = 0.1 * size;
  Simplex simplex;
  Vec3 best_n = n;
  // If the shapes are well apart, the origin is outside, and its nearest point is the answer.
  const auto outside = [&]() -> Vec3 {
    return best.h < -0.5 * off ? Vec3(Vec3::Zero()) : Vec3((best.h + off) * best_n);
  };
  Vec3 p = outside();
  simplex.add(best.S, best.s_A, best.s_B);
  Vec3 v = simplex.reduce(p);
  for (int step = 0; step < 60; ++step) {
    const double length = v.norm();
    if (!(length > 0.0)) break;
    n = -v / length;
    const Support s = search(n);
    if (s.h < -margin) return search.answer(s, n);
    // The distance of A - B from p is at least n . p - s.h, and at most `length`.
    const double gap = length - (n.dot(p) - s.h);
    const double gain = best.h - s.h;
    if (gain > 0.0) {
      best = s;
      best_n = n;
    }
    if (gap <= tolerance && gain <= tolerance) break;
    const bool known = simplex.holds(s.S);
    if (known ? gain <= 0.0 : simplex.count == 4) break;  // rounding: no progress
    if (gain > 0.0) p = outside();
    if (!known) simplex.add(s.S, s.s_A, s.s_B);
    v = simplex.reduce(p);
  }
  Closest c = search.answer(best, best_n);
  // The points of A and B that form the nearest point. With flat faces, S alone is only a corner.
  c.p_A = simplex.p_A();
  c.p_B = -simplex.p_B();
  return c;
}

/// Distance of shapes that are apart: GJK from the origin.
template <typename S>
HEADPIN_OUT_OF_LINE Closest from_origin(S& search, const Closest& start, double size) {
  Closest best = start;
  Simplex simplex;
  simplex.add(start.p_A - start.p_B, start.p_A, -start.p_B);
  for (int step = 0; step < 64; ++step) {
    const Vec3 v = simplex.reduce(Vec3::Zero());
    const double length = v.norm();
    if (simplex.count == 4 || !(length > 0.0)) break;
    const Vec3 n = -v / length;
    const Support s = search(n);
    if (-s.h > best.distance) best = search.answer(s, n);
    best.p_A = simplex.p_A();
    best.p_B = -simplex.p_B();
    if (is_distance(best, size) || simplex.holds(s.S)) break;
    simplex.add(s.S, s.s_A, s.s_B);
  }
  return best;
}

}  // namespace headpin::engine
