#pragma once

#include "engine/hull_feature.h"
#include "engine/search.h"

/// Searches with a face, edge or vertex of a hull in place of the hull. Private to the engine.
namespace headpin::engine {

/// Tries the face in view, if there is one. The normal is that of the face, and the closest point
/// of the other shape must lie over the face.
///
/// @param[in,out] n       becomes the normal of the face
/// @param[in,out] fa, fb  get the edge to try next, if that point lies outside the face
/// @return  whether the answer was found; it is then in c
template <typename A, typename B>
bool on_face(Search<A, B>& search, Vec3& n, const Query& q, Feature& fa, Feature& fb, Closest& c) {
  constexpr bool hull_a = kHull<A>, hull_b = kHull<B>;
  if (fa.face == nullptr && fb.face == nullptr) return false;
  const bool of_a = fa.face != nullptr;
  if constexpr (hull_a) {
    if (of_a) n = search.a.normal(*fa.face);
  }
  if constexpr (hull_b) {
    if (!of_a) n = search.b.normal(*fb.face);
  }
  const Support s = search(n);
  if (s.h < -q.margin) {
    c = search.answer(s, n);
    return true;
  }
  if constexpr (hull_a) {
    const Vec3 touching = s.h * n - s.s_B;
    if (of_a && in_face(search.a, *fa.face, touching, fa)) {
      c = search.answer({touching, s.s_B, s.S, s.h}, n);
      return true;
    }
  }
  if constexpr (hull_b) {
    const Vec3 touching = s.h * n - s.s_A;
    if (!of_a && in_face(search.b, *fb.face, touching, fb)) {
      c = search.answer({s.s_A, touching, s.S, s.h}, n);
      return true;
    }
  }
  return false;
}

/// Newton's method with a feature of the hull in place of the hull. The result is valid if the
/// whole hull reaches no further along the normal found.
///
/// @return  false if the feature was the wrong one
template <typename A, typename B>
bool by_feature(Search<A, B>& search, Vec3 n, double size, const Query& q, double near,
                Closest& c) {
  constexpr bool hull_a = kHull<A>, hull_b = kHull<B>;
  Feature fa, fb;
  if constexpr (hull_a) fa = in_view(search.a, n, near);
  if constexpr (hull_b) fb = in_view(search.b, n, near);
  if (on_face(search, n, q, fa, fb, c)) return true;
  const auto on_both = [&](const auto& a, const auto& b) {
    return descend(a, b, n, size, q.margin, q.cap);
  };
  const auto on_b = [&](const auto& a) {
    if constexpr (hull_b) {
      return with_feature(search.b, fb, [&](const auto& b) { return on_both(a, b); });
    } else {
      return on_both(a, search.b);
    }
  };
  Descent d;
  if constexpr (hull_a) {
    d = with_feature(search.a, fa, on_b);
  } else {
    d = on_b(search.a);
  }
  search.evaluations += d.evaluations;
  if (d.end == Descent::unresolved) return false;
  const Support s = search(d.n);
  if (s.h < -q.margin) {
    c = search.answer(s, d.n);
    return true;
  }
  if (d.end == Descent::apart || s.h > d.h + 1e-10 * size) return false;
  c = search.answer({d.s_A, d.s_B, s.S, s.h}, d.n);
  return true;
}

}  // namespace headpin::engine
