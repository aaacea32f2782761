#pragma once

#include <limits>
#include <type_traits>

#include "engine/inlining.h"
#include "engine/non_colliding.h"
#include "engine/posed.h"

/// Support points of two posed shapes. Private to the engine.
namespace headpin::engine {

template <typename S>
inline constexpr bool kHull = std::is_same_v<S, posed::Hull>;

/// One evaluation: the support points along n, S = p_A - p_B and h = n . S = -g(n).
struct Support {
  Vec3 s_A, s_B;  // S = s_A + s_B, B mirrored
  Vec3 S;
  double h = std::numeric_limits<double>::infinity();
};

/// Two posed shapes and the number of evaluations.
template <typename A, typename B>
struct Search {
  A a;
  B b;
  int evaluations = 0;

  HEADPIN_INLINE Support operator()(const Vec3& n) {
    ++evaluations;
    Support s{a.support(n), b.support(n), Vec3::Zero(), 0.0};
    s.S = s.s_A + s.s_B;
    s.h = n.dot(s.S);
    return s;
  }
  Search& search() { return *this; }
  Closest answer(const Support& s, const Vec3& n) const {
    return {s.h < 0.0, -s.h, s.s_A, -s.s_B, n, evaluations, false};
  }
};
template <typename A, typename B>
Search(A, B) -> Search<A, B>;  // clang 14 does not deduce it of an aggregate

HEADPIN_INLINE inline Vec3 unit_or(const Vec3& v, const Vec3& otherwise) {
  const double n2 = v.squaredNorm();
  return n2 > 1e-200 && n2 < 1e200 ? Vec3(1.0 / std::sqrt(n2) * v) : otherwise;
}

}  // namespace headpin::engine
