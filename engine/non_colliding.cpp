#include "engine/non_colliding.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <type_traits>

#include "engine/gjk.h"

namespace headpin::engine {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// One evaluation: the furthest points along n and what they prove. S = p_A - p_B, h = n . S =
/// -g(n).
struct Support {
  Vec3 p_A, p_B, S;
  double h;
};

template <typename A, typename B>
struct Query2 {
  const A& a;
  const B& b;
  Mat3 R_AB;
  Vec3 p_AB;
  int evaluations = 0;

  Support operator()(const Vec3& n) {
    ++evaluations;
    Support s;
    s.p_A = support(a, n);
    s.p_B = R_AB * support(b, Vec3(-(R_AB.transpose() * n))) + p_AB;
    s.S = s.p_A - s.p_B;
    s.h = n.dot(s.S);
    return s;
  }
};

Vec3 unit_or(const Vec3& v, const Vec3& otherwise) {
  const double n2 = v.squaredNorm();
  return n2 > 0.0 && std::isfinite(n2) ? Vec3(v / std::sqrt(n2)) : otherwise;
}

Closest answer(const Support& s, const Vec3& n, int iterations) {
  return {s.h < 0.0, -s.h, s.p_A, s.p_B, n, iterations, false};
}

struct Distance {
  Simplex simplex;
  Vec3 v;  // nearest point of the set to the origin
  bool inside = false;
  bool stopped = false;  // at a direction n with h(n) < stop_below
  Vec3 n;
  Support at_n;
};

// GJK on A - B moved by -shift. Ends early where h(n) < stop_below.
template <typename A, typename B>
Distance distance_from(Query2<A, B>& query, const Vec3& shift, const Vec3& n0, double size,
                       double stop_below) {
  Distance d;
  Vec3 n = n0;
  double v2 = kInfinity;
  for (int step = 0; step < 64; ++step) {
    const Support s = query(n);
    if (s.h < stop_below) {
      d.stopped = true;
      d.n = n;
      d.at_n = s;
      return d;
    }
    const Vec3 w = s.S - shift;
    if (d.simplex.count > 0) {
      bool known = false;
      for (int i = 0; i < d.simplex.count; ++i) known = known || d.simplex.w[i] == w;
      // v . w bounds the distance from below: close enough, or nothing new.
      if (known || v2 - d.v.dot(w) <= 1e-8 * v2) return d;
    }
    const Simplex before = d.simplex;
    const int k = d.simplex.count++;
    d.simplex.w[k] = w;
    d.simplex.a[k] = s.p_A;
    d.simplex.b[k] = s.p_B;
    const Vec3 v = d.simplex.reduce();
    const double now = v.squaredNorm();
    if (d.simplex.count == 4 || now <= 1e-30 * size * size) {
      d.v = v;
      d.inside = true;
      return d;
    }
    if (now >= v2) {  // rounding: no progress any more
      d.simplex = before;
      return d;
    }
    d.v = v;
    v2 = now;
    n = -v / std::sqrt(now);
  }
  return d;
}

template <typename A, typename B>
Closest converge(Query2<A, B>& query, Vec3 n, Support best, double size, const Query& q) {
  // Look at A - B from outside, along the best normal: the nearest point has a better one.
  const double off = 0.1 * size;
  Closest c = answer(best, n, 0);
  for (int round = 0; round < 6; ++round) {
    const Distance d = distance_from(query, (best.h + off) * n, n, size, -q.margin);
    if (d.stopped) return answer(d.at_n, d.n, query.evaluations);
    if (d.inside) break;
    const Vec3 next = -d.v.normalized();
    const Support s = query(next);
    if (s.h < -q.margin) return answer(s, next, query.evaluations);
    if (s.h <= best.h) {
      c = answer(s, next, 0);
      c.p_A = d.simplex.p_A();
      c.p_B = d.simplex.p_B();
    }
    const bool better = s.h < best.h - 1e-9 * size;
    n = next;
    best = s;
    if (!better) break;
  }
  if (c.distance <= 0.0 &&
      !contains(query.a, c.p_B, 1e-9 * size)) {  // B's point in A proves that they meet
    const Distance d = distance_from(query, Vec3::Zero(), n, size, 0.0);
    if (d.stopped) return answer(d.at_n, d.n, query.evaluations);
  }
  c.iterations = query.evaluations;
  return c;
}

double size_of(const Ellipsoid& s) {
  return s.radii.minCoeff();
}
double size_of(const Cylinder& s) {
  return std::min(s.radius, s.half_height);
}
double size_of(const Cone& s) {
  return 0.5 * std::min(s.radius, s.height);
}
double size_of(const Polyhedron& s) {
  double least = kInfinity;
  for (const Polyhedron::Face& f : s.faces()) {
    least = std::min(least, f.offset - f.normal.dot(s.centre()));
  }
  return least;
}

template <typename A, typename B>
Closest closest(const A& a, const B& b, const Pose& X_AB, Vec3& n_AB_cache, const Query& q) {
  Query2<A, B> query{a, b, X_AB.q.toRotationMatrix(), X_AB.p};
  const Vec3 line = X_AB.p + query.R_AB * centre(b) - centre(a);
  Vec3 n = unit_or(n_AB_cache, unit_or(line, Vec3::UnitZ()));
  Support best{};
  Vec3 n_best = n;
  best.h = kInfinity;
  const int steps = q.mode == Query::paper ? q.cap : std::min(q.cap, 4);
  Closest c;
  for (int step = 1;; ++step) {
    const Support s = query(n);
    if (s.h < best.h || q.mode == Query::paper) {
      best = s;
      n_best = n;
    }
    const double S2 = s.S.squaredNorm();
    // Certificate; or D parallel to n.
    if (s.h < -q.margin || (s.S - s.h * n).squaredNorm() <= 1e-20 * S2) {
      n_AB_cache = n;
      return answer(s, n, step);
    }
    if (step == steps) break;
    n = unit_or(n - 1.5 * s.h / S2 * s.S, n);
  }
  if (q.mode == Query::paper) {
    c = answer(best, n_best, steps);
    c.capped = true;
  } else {
    c = converge(query, n_best, best, std::min(size_of(a), size_of(b)), q);
  }
  n_AB_cache = c.n_AB;
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

Closest closest_points(const Shape& a, const Shape& b, const Pose& X_AB, Vec3& n_AB_cache,
                       const Query& query) {
  return visit_both(a, b, [&](const auto& sa, const auto& sb) -> Closest {
    constexpr bool plane_a = std::is_same_v<std::decay_t<decltype(sa)>, HalfSpace>;
    constexpr bool plane_b = std::is_same_v<std::decay_t<decltype(sb)>, HalfSpace>;
    if constexpr (plane_a && plane_b) {
      throw std::invalid_argument("closest_points: two half-spaces");
    } else if constexpr (plane_a) {
      const Closest c = from_plane(sb, X_AB);
      n_AB_cache = c.n_AB;
      return c;
    } else if constexpr (plane_b) {
      const Closest c = from_plane(sa, X_AB.inverse());
      n_AB_cache = -(X_AB.q * c.n_AB);
      return {c.separated, c.distance, X_AB * c.p_B, X_AB * c.p_A, n_AB_cache, 1, false};
    } else {
      return closest(sa, sb, X_AB, n_AB_cache, query);
    }
  });
}

}  // namespace headpin::engine
