#include "engine/non_colliding.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <type_traits>

#include "engine/gjk.h"
#include "engine/hull_feature.h"
#include "engine/polytope.h"
#include "engine/posed.h"
#include "engine/stratified_newton.h"
#include "engine/way_out.h"

namespace headpin::engine {
namespace {

template <typename S>
inline constexpr bool kHull = std::is_same_v<S, posed::Hull>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// One evaluation: the furthest points along n and what they prove. S = p_A - p_B, h = n . S =
/// -g(n).
struct Support {
  Vec3 s_A, s_B;  // S = s_A + s_B, B mirrored
  Vec3 S;
  double h = kInfinity;
};

/// Two posed shapes and how often they were asked.
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

/// Steps of the paper's iteration after the first one before Newton's.
constexpr int kPaperSteps = 1;

template <typename B>
Vec3 centre_B(const B& b, const Pose& X_AB) {
  if constexpr (std::is_same_v<B, Polyhedron>) return X_AB * centre(b);
  return X_AB.p;
}

HEADPIN_INLINE inline Vec3 unit_or(const Vec3& v, const Vec3& otherwise) {
  const double n2 = v.squaredNorm();
  return n2 > 1e-200 && n2 < 1e200 ? Vec3(1.0 / std::sqrt(n2) * v) : otherwise;
}

/// Walks to a local minimum of h round the outside of A - B.
///
/// From a point p = (h + off) n outside, beyond the best plane so far, the nearest point of A - B
/// has a normal whose plane is lower still, or p is already above a minimum. GJK finds that nearest
/// point, and its simplex stays valid when p moves on, so p moves as soon as a step finds a lower
/// plane.
template <typename S>
HEADPIN_FLATTEN __attribute__((noinline)) Closest from_outside(S& search, Vec3 n, Support best,
                                                               double size, double margin,
                                                               double tolerance) {
  const double off = 0.1 * size;
  Simplex simplex;
  Vec3 best_n = n;
  // Well apart, the origin itself is outside, and its nearest point is the answer.
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
    // The plane across n keeps A - B at least this far from p; v is that far at most.
    const double gap = length - (n.dot(p) - s.h);
    const double gain = best.h - s.h;
    if (gain > 0.0) {
      best = s;
      best_n = n;
    }
    if (gap <= tolerance && gain <= tolerance) break;
    const bool known = simplex.holds(s.S);
    if (known ? gain <= 0.0 : simplex.count == 4) break;  // rounding: no way on
    if (gain > 0.0) p = outside();
    if (!known) simplex.add(s.S, s.s_A, s.s_B);
    v = simplex.reduce(p);
  }
  Closest c = search.answer(best, best_n);
  // The points of A and B that make up the nearest point: with flat faces, S alone is some corner.
  c.p_A = simplex.p_A();
  c.p_B = -simplex.p_B();
  return c;
}

/// Newton's method with a hull's feature in place of the hull. The result counts when the whole
/// hull reaches no further along the normal found; false when the guess was wrong.
template <typename A, typename B>
bool by_feature(Search<A, B>& search, Vec3 n, double size, const Query& q, double near,
                Closest& c) {
  constexpr bool hull_a = kHull<A>, hull_b = kHull<B>;
  Feature fa, fb;
  if constexpr (hull_a) fa = in_view(search.a, n, near);
  if constexpr (hull_b) fb = in_view(search.b, n, near);
  // A face: its normal is known, and what touches it must lie within it.
  if (fa.face != nullptr || fb.face != nullptr) {
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
  }
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

/// One step of the paper's iteration. S = A - B looked at from the plane's normal n; the point S
/// lies on the wrong side of the origin when h >= 0. The mirror image of n in S (Chung and Wong
/// 1996) would take away 2 (h / S.S) S; 1.5 was measured to leave fewest pairs unresolved.
Vec3 turned(const Vec3& n, const Support& s) {
  return unit_or(n - 1.5 * s.h / s.S.squaredNorm() * s.S, n);
}

/// The points lie along the normal: equations (1), (2).
bool parallel(const Support& s, const Vec3& n) {
  return (s.S - s.h * n).squaredNorm() <= 1e-12 * s.S.squaredNorm();
}

/// Up to the cap, as the paper has it: D parallel to N ends it, and so does a proof of separation.
///
/// Where S lies nearly along n, as it does where shapes meet, the steps towards a proof turn n over.
/// So after half of the cap, as soon as one leads to no lower plane, the search goes on from the lowest: n is turned by the
/// part of S across it over both arms, which for two spheres is the way to the line of centres, and
/// by half as much each time that this leads to no lower plane. The answer is the lowest plane.
///
/// @param c_A, c_B  from where the arms of the furthest points are measured, in A's frame
template <typename S>
Closest paper(S& search, Vec3 n, const Support& first, const Vec3& c_A, const Vec3& c_B, int cap) {
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

/// As old trials have it: the depth of the best plane, normal and points of the last.
template <typename S>
Closest paper_last(S& search, Vec3 n, const Support& first, int cap) {
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

template <typename A, typename B>
Closest settle_round(Search<A, B>& search, Vec3 n, double size, bool warm, const Query& q) {
  if (warm) n = onto_kinks(search.a, search.b, n);
  const Descent d = descend(search.a, search.b, n, size, q.margin, q.cap);
  search.evaluations += d.evaluations;
  Support best{d.s_A, d.s_B, d.s_A + d.s_B, d.h};
  // At a kink h is that of one side of it, which proves no gap as small as rounding.
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
  // A warm start is near the feature that the pair touched with.
  if (warm && by_feature(search, n, size, q, 0.03, c)) return c;
  // Polyhedra alone end exactly; with round shapes it is enough to come near the feature.
  constexpr bool flat = kHull<A> && kHull<B>;
  c = from_outside(search, n, first, size, q.margin, flat ? 1e-8 * size : 1e-2 * size);
  if (flat || c.distance > q.margin || by_feature(search, c.n_AB, size, q, 0.05, c)) return c;
  return from_outside(search, c.n_AB, search(c.n_AB), size, q.margin, 1e-8 * size);
}

/// From a normal that proves nothing to the closest points. A warm one is near.
template <typename A, typename B>
Closest settle(Search<A, B>& search, const Vec3& n, const Support& first, double size, bool warm,
               const Query& q) {
  if constexpr (kHull<A> || kHull<B>) {
    return settle_hull(search, n, first, size, warm, q);
  } else {
    return settle_round(search, n, size, warm, q);
  }
}

/// From the line of centres: the paper's steps, which are cheap and the end of most pairs that are
/// apart, and the way on from the best of them.
template <typename A, typename B>
Closest from_centres(Search<A, B>& search, Vec3 n, Support best, double size, const Query& q) {
  Vec3 raw = n;  // not unit: furthest points only ask for the direction
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

/// The first look at a pair, along n of any length. Most pairs that are apart end here, so nothing
/// is prepared that only a second look needs.
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

/// Distance of shapes that are apart: GJK from the origin.
template <typename S>
Closest from_origin(S& search, const Closest& start, double size) {
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

/// Most ways out looked at, each shorter than the one before, and most polytopes for them.
constexpr int kWaysOut = 20, kAttempts = 3;

template <typename S>
Vec3 furthest_of(void* search, const Vec3& n) {
  return (*static_cast<S*>(search))(n).S;
}

/// Replaces a way out by shorter ones until none is; false when it had to give up before that was
/// proven. Two edges lie across each other, or a minimum is not the least, or there is none: one may
/// even be found where the shapes are apart.
template <typename A, typename B, typename S>
HEADPIN_FLATTEN __attribute__((noinline)) bool shorten(const A& a, const B& b, const Pose& X_AB,
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
    // From where it was nearest, and if that leads on, round there.
    const Closest there = settle(search, shorter, search(shorter), size, false, q);
    c.capped = true;
    if (there.distance <= c.distance) return false;
    c = there;
    c.capped = true;
  }
  return false;
}

/// Carries on from a normal that proves nothing: until the closest points are found, and proven, or
/// in the paper's mode to its cap.
template <typename A, typename B, typename Look>
HEADPIN_FLATTEN __attribute__((noinline)) Closest carry_on(const A& a, const B& b, const Pose& X_AB,
                                                           Look& look, const Vec3& n,
                                                           const Support& first, bool warm,
                                                           const Query& q) {
  auto&& search = look.search();
  if (q.mode == Query::paper) {
    return q.last ? paper_last(search, n, first, q.cap)
                  : paper(search, n, first, centre(a), centre_B(b, X_AB), q.cap);
  }
  const double size = std::min(size_of(a), size_of(b));
  Closest c =
      warm ? settle(search, n, first, size, true, q) : from_centres(search, n, first, size, q);
  if (!is_proven(a, b, X_AB, c, size) && !shorten(a, b, X_AB, search, c, size, q) && warm) {
    // Nothing proven, as between round shapes that nearly share an axis: the line of centres may
    // lead to less than a kept normal did.
    const Vec3 line = unit_or(centre_B(b, X_AB) - centre(a), n);
    Closest cold = from_centres(search, line, search(line), size, q);
    if (!is_proven(a, b, X_AB, cold, size)) shorten(a, b, X_AB, search, cold, size, q);
    if (cold.distance > c.distance) c = cold;
    c.capped = true;
  }
  if (c.separated && c.distance <= q.margin && !is_distance(c, size)) {
    const bool capped = c.capped;
    c = from_origin(search, c, size);
    c.capped = capped;
  }
  c.iterations = search.evaluations;
  return c;
}

/// Round shapes that were closer than the margin go without the first look, as it would prove
/// nothing.
template <typename A, typename B>
HEADPIN_FLATTEN Closest closest(const A& a, const B& b, const Pose& X_AB, KeptNormal& kept,
                                const Query& q) {
  constexpr bool hull = std::is_same_v<A, Polyhedron> || std::is_same_v<B, Polyhedron>;
  const double c2 = kept.n_AB.squaredNorm();
  const bool warm = starts_warm(q) && kept.of != KeptNormal::none && c2 > 0.5 && c2 < 2.0;
  const bool met = warm && kept.of == KeptNormal::met;
  const Vec3 line = centre_B(b, X_AB) - centre(a);
  // Furthest points only ask for the direction: no need to wait for the unit vector.
  Vec3 n = warm ? kept.n_AB : line;
  double n2 = warm ? c2 : line.squaredNorm();
  if (!(n2 > 1e-200 && n2 < 1e200)) {
    n = Vec3::UnitZ();
    n2 = 1.0;
  }
  auto look = [&] {
    if constexpr (hull) {
      return Search{posed::pose_A(a), posed::pose_B(b, X_AB)};  // it remembers the vertex
    } else {
      return Glance<A, B>{a, b, X_AB};
    }
  }();
  Support first;
  const bool looked = hull || !met || q.mode == Query::paper;
  if (looked) first = look(n);
  if (met || std::abs(n2 - 1.0) > 1e-14) {
    const double inverse = 1.0 / std::sqrt(n2);
    n *= inverse;
    first.h *= inverse;
  }
  if (looked && first.h < -q.margin) {
    kept = {n, KeptNormal::apart};
    return {first.h < 0.0, -first.h, first.s_A, -first.s_B, n, 1, false};
  }
  const Closest c = carry_on(a, b, X_AB, look, n, first, warm, q);
  kept = {c.n_AB, c.distance > q.margin ? KeptNormal::apart : KeptNormal::met};
  return c;
}

// The half-space is its plane: the normal is known.
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
