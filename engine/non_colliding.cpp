#include "engine/non_colliding.h"

#include <algorithm>
#include <stdexcept>
#include <type_traits>

#include "engine/by_feature.h"
#include "engine/paper_mode.h"
#include "engine/polytope.h"
#include "engine/round_the_outside.h"
#include "engine/way_out.h"

namespace headpin::engine {
namespace {

/// Number of steps of the paper's iteration between the first evaluation and Newton's method.
constexpr int kPaperSteps = 1;

template <typename B>
Vec3 centre_B(const B& b, const Pose& X_AB) {
  if constexpr (std::is_same_v<B, Polyhedron>) return X_AB * centre(b);
  return X_AB.p;
}

double size_of(const Ellipsoid& s) {
  return s.radii.sum() / 3.0;
}
double size_of(const Cylinder& s) {
  return std::max(s.radius, s.half_height);
}
double size_of(const Cone& s) {
  return std::max(s.radius, 0.5 * s.height);
}
double size_of(const Polyhedron& s) {
  return s.vertices().front().norm();
}

template <typename A, typename B>
Closest settle_round(Search<A, B>& search, Vec3 n, double size, bool warm, const Query& q) {
  if (warm) n = onto_kinks(search.a, search.b, n);
  const Descent d = descend(search.a, search.b, n, size, q.margin, q.cap);
  search.evaluations += d.evaluations;
  Support best{d.s_A, d.s_B, d.s_A + d.s_B, d.h};
  // At a kink, h belongs to one side of it and does not prove a gap as small as rounding.
  if (d.h < 0.0 && d.h > -1e-7 * size) best.h = search(d.n).h;
  if (d.end != Descent::unresolved) return search.answer(best, d.n);
  Closest c = from_outside(search, d.n, best, size, q.margin, 1e-9 * size);
  c.capped = true;
  return c;
}

template <typename A, typename B>
Closest settle_hull(Search<A, B>& search, const Vec3& n, const Support& first, double size,
                    bool warm, const Query& q) {
  Closest c;
  // A warm start is near the feature at which the pair touched.
  if (warm && by_feature(search, n, size, q, 0.03, c)) return c;
  // Two polyhedra need the exact end of this search. With a round shape it is enough to come near
  // the feature.
  constexpr bool flat = kHull<A> && kHull<B>;
  c = from_outside(search, n, first, size, q.margin, flat ? 1e-8 * size : 1e-2 * size);
  if (flat || c.distance > q.margin || by_feature(search, c.n_AB, size, q, 0.05, c)) return c;
  return from_outside(search, c.n_AB, search(c.n_AB), size, q.margin, 1e-8 * size);
}

/// Finds the closest points, from a normal that does not yet prove separation. A warm start is
/// close to the solution.
template <typename A, typename B>
HEADPIN_FLATTEN HEADPIN_OUT_OF_LINE Closest settle(Search<A, B>& search, const Vec3& n,
                                                   const Support& first, double size, bool warm,
                                                   const Query& q) {
  if constexpr (kHull<A> || kHull<B>) {
    return settle_hull(search, n, first, size, warm, q);
  } else {
    return settle_round(search, n, size, warm, q);
  }
}

/// Searches from the line of centres. It first makes the paper's steps, which are cheap and
/// separate most pairs that are apart. Then it continues from the best of them.
template <typename A, typename B>
Closest from_centres(Search<A, B>& search, Vec3 n, Support best, double size, const Query& q) {
  Vec3 raw = n;  // not unit: support points depend only on the direction
  Support s = best;
  for (int step = 0; step < kPaperSteps; ++step) {
    const double along = raw.dot(s.S), S2 = s.S.squaredNorm();
    if (!(S2 > 0.0)) break;
    raw -= 1.5 * along / S2 * s.S;
    const double inverse = 1.0 / raw.norm();
    s = search(raw);
    s.h *= inverse;
    if (s.h < -q.margin) return search.answer(s, inverse * raw);
    if (s.h < best.h) {
      best = s;
      n = inverse * raw;
    }
  }
  return settle(search, n, best, size, false, q);
}

/// The first evaluation of a pair, along n of any length. Most pairs that are apart end here, so it
/// prepares nothing that only later evaluations need.
template <typename A, typename B>
struct Glance {
  const A& a;
  const B& b;
  const Pose& X_AB;
  int evaluations = 0;

  HEADPIN_INLINE Vec3 s_A(const Vec3& n) const { return posed::pose_A(a).support(n); }
  HEADPIN_INLINE Vec3 s_B(const Vec3& n) const {  // mirrored
    if constexpr (std::is_same_v<B, Ellipsoid>) {
      const Mat3 R_AB = X_AB.q.toRotationMatrix();
      return R_AB * posed::pose_A(b).support(R_AB.transpose() * n) - X_AB.p;
    } else {
      return posed::pose_B(b, X_AB).support(n);
    }
  }
  HEADPIN_INLINE Support operator()(const Vec3& n) {
    ++evaluations;
    Support s{s_A(n), s_B(n), Vec3::Zero(), 0.0};
    s.S = s.s_A + s.s_B;
    s.h = n.dot(s.S);
    return s;
  }
  Search<decltype(posed::pose_A(a)), decltype(posed::pose_B(b, X_AB))> search() const {
    return {posed::pose_A(a), posed::pose_B(b, X_AB), evaluations};
  }
};

/// Largest number of ways out per polytope, each shorter than the one before, and of polytopes.
constexpr int kWaysOut = 20, kAttempts = 3;

template <typename S>
Vec3 furthest_of(void* search, const Vec3& n) {
  return (*static_cast<S*>(search))(n).S;
}

/// Replaces a way out by shorter ones until there is no shorter one. This is needed where two edges
/// cross, where a minimum is not the least, or where there is no minimum; the shapes may even be
/// apart.
///
/// @return  false if it gave up before this was proven
template <typename A, typename B, typename S>
HEADPIN_FLATTEN HEADPIN_OUT_OF_LINE bool shorten(const A& a, const B& b, const Pose& X_AB,
                                                 S& search, Closest& c, double size,
                                                 const Query& q) {
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    Polytope around(&furthest_of<S>, &search, c.n_AB, c.p_A - c.p_B);
    Vec3 shorter;
    int k = 0;
    for (; k < kWaysOut && around.find_shorter(to_beat(c, size), shorter); ++k) {
      const Support s = search(shorter);
      const Closest there = settle(search, shorter, s, size, false, q);
      const bool capped = c.capped || there.capped;
      c = -there.distance <= s.h ? there : search.answer(s, shorter);
      c.capped = capped;
      if (is_proven(a, b, X_AB, c, size)) return true;
    }
    if (k < kWaysOut && !around.gave_up()) return true;
    // Continue from the last direction. If the result is shorter, build a new polytope around it.
    const Closest there = settle(search, shorter, search(shorter), size, false, q);
    c.capped = true;
    if (there.distance <= c.distance) return false;
    c = there;
    c.capped = true;
  }
  return false;
}

/// The search from a kept normal proved nothing, as for round shapes that nearly share an axis. The
/// line of centres may lead to a smaller depth.
template <typename A, typename B, typename S>
HEADPIN_OUT_OF_LINE void try_from_centres(const A& a, const B& b, const Pose& X_AB, S& search,
                                          const Vec3& n, Closest& c, double size, const Query& q) {
  const Vec3 line = unit_or(centre_B(b, X_AB) - centre(a), n);
  Closest cold = from_centres(search, line, search(line), size, q);
  if (!is_proven(a, b, X_AB, cold, size)) shorten(a, b, X_AB, search, cold, size, q);
  if (cold.distance > c.distance) c = cold;
  c.capped = true;
}

/// Continues from a normal that does not prove separation, until the closest points are found and
/// proven. In paper mode it stops at the cap.
template <typename A, typename B, typename Supports>
HEADPIN_FLATTEN HEADPIN_OUT_OF_LINE Closest carry_on(const A& a, const B& b, const Pose& X_AB,
                                                     Supports& supports, const Vec3& n,
                                                     const Support& first, bool warm,
                                                     const Query& q) {
  auto&& search = supports.search();
  if (q.mode == Query::paper) {
    return q.last ? paper_last(search, n, first, q.cap)
                  : paper(search, n, first, centre(a), centre_B(b, X_AB), q.cap);
  }
  const double size = std::min(size_of(a), size_of(b));
  Closest c =
      warm ? settle(search, n, first, size, true, q) : from_centres(search, n, first, size, q);
  if (!is_proven(a, b, X_AB, c, size) && !shorten(a, b, X_AB, search, c, size, q) && warm) {
    try_from_centres(a, b, X_AB, search, n, c, size, q);
  }
  if (c.separated && c.distance <= q.margin && !is_distance(c, size)) {
    const bool capped = c.capped;
    c = from_origin(search, c, size);
    c.capped = capped;
  }
  c.iterations = search.evaluations;
  return c;
}

/// Round shapes that were closer than the margin skip the first evaluation, because it would prove
/// nothing.
template <typename A, typename B>
HEADPIN_FLATTEN Closest closest(const A& a, const B& b, const Pose& X_AB, KeptNormal& kept,
                                const Query& q) {
  constexpr bool hull = std::is_same_v<A, Polyhedron> || std::is_same_v<B, Polyhedron>;
  const double c2 = kept.n_AB.squaredNorm();
  const bool warm = starts_warm(q) && kept.of != KeptNormal::none && c2 > 0.5 && c2 < 2.0;
  const bool met = warm && kept.of == KeptNormal::met;
  const Vec3 line = centre_B(b, X_AB) - centre(a);
  // Support points depend only on the direction, so the unit vector is not needed yet.
  Vec3 n = warm ? kept.n_AB : line;
  double n2 = warm ? c2 : line.squaredNorm();
  if (!(n2 > 1e-200 && n2 < 1e200)) {
    n = Vec3::UnitZ();
    n2 = 1.0;
  }
  auto supports = [&] {
    if constexpr (hull) {
      return Search{posed::pose_A(a), posed::pose_B(b, X_AB)};  // it remembers the vertex
    } else {
      return Glance<A, B>{a, b, X_AB};
    }
  }();
  Support first;
  const bool evaluated = hull || !met || q.mode == Query::paper;
  if (evaluated) first = supports(n);
  if (met || std::abs(n2 - 1.0) > 1e-14) {
    const double inverse = 1.0 / std::sqrt(n2);
    n *= inverse;
    first.h *= inverse;
  }
  if (evaluated && first.h < -q.margin) {
    kept = {n, KeptNormal::apart};
    return {first.h < 0.0, -first.h, first.s_A, -first.s_B, n, 1, false};
  }
  const Closest c = carry_on(a, b, X_AB, supports, n, first, warm, q);
  kept = {c.n_AB, c.distance > q.margin ? KeptNormal::apart : KeptNormal::met};
  return c;
}

// Against a half-space the normal is known: that of its plane.
template <typename B>
Closest from_plane(const B& b, const Pose& X_AB) {
  const Vec3 n = Vec3::UnitZ();
  const Vec3 p_B = X_AB * support(b, Vec3(X_AB.q.conjugate() * -n));
  return {p_B.z() > 0.0, p_B.z(), {p_B.x(), p_B.y(), 0.0}, p_B, n, 1, false};
}

}  // namespace

Closest closest_points(const Shape& a, const Shape& b, const Pose& X_AB, KeptNormal& kept,
                       const Query& query) {
  const auto keep = [&](const Closest& c) {
    kept = {c.n_AB, c.distance > query.margin ? KeptNormal::apart : KeptNormal::met};
    return c;
  };
  return visit_both(a, b, [&](const auto& sa, const auto& sb) -> Closest {
    constexpr bool plane_a = std::is_same_v<std::decay_t<decltype(sa)>, HalfSpace>;
    constexpr bool plane_b = std::is_same_v<std::decay_t<decltype(sb)>, HalfSpace>;
    if constexpr (plane_a && plane_b) {
      throw std::invalid_argument("closest_points: two half-spaces");
    } else if constexpr (plane_a) {
      return keep(from_plane(sb, X_AB));
    } else if constexpr (plane_b) {
      const Closest c = from_plane(sa, X_AB.inverse());
      const Vec3 n_AB = -(X_AB.q * c.n_AB);
      return keep({c.separated, c.distance, X_AB * c.p_B, X_AB * c.p_A, n_AB, 1, false});
    } else {
      return closest(sa, sb, X_AB, kept, query);
    }
  });
}

}  // namespace headpin::engine
