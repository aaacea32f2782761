#include "tests/support/pair_campaign.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "engine/gjk.h"
#include "tests/support/random_shapes.h"

namespace headpin::engine::test {
namespace {

constexpr double kQuarter = 1.57079632679489661923;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Points of A - B and the triangles round them: grown where it is nearest to the origin until it
/// tells how deep the origin lies, or how far off.
class Polytope {
 public:
  Polytope(const Shape& a, const Shape& b, const Pose& X_AB) : a_(a), b_(b), X_AB_(X_AB) {}

  /// Bounds on the least depth (negative: minus the distance). Stops when `low` reaches `enough`,
  /// or `high` falls below it, or they are as close as rounding lets them come.
  struct Bounds {
    double low = -kInfinity, high = kInfinity;
  };
  Bounds bounds(double enough, const Vec3& n) {
    start();
    // About the direction in question, where it matters.
    const Vec3 u = n.unitOrthogonal(), v = n.cross(u);
    add(furthest(n));
    for (const double tilt : {0.3, 0.03, 1e-3}) {
      for (const Vec3& t : {u, v, Vec3(-u), Vec3(-v)}) add(furthest(n + tilt * t));
    }
    Bounds out;
    // Convex, it has at most twice as many faces as corners; what rounding has tangled up, and might
    // double at every step, proves nothing more.
    for (int step = 0; step < 300 && !faces_.empty() && faces_.size() < 4 * points_.size();
         ++step) {
      const auto face =
          std::min_element(faces_.begin(), faces_.end(),
                           [](const Face& f, const Face& g) { return f.offset < g.offset; });
      Vec3 m = face->normal;
      out.low = face->offset;
      if (out.low < 0.0) {  // the origin is outside: as far as the nearest point, not the plane
        const Vec3 nearest = nearest_point();
        out.low = -nearest.norm();
        if (out.low < -1e3 * rounding_) m = nearest / out.low;
      }
      if (out.low >= enough) return out;
      const Vec3 s = furthest(m);
      const double h = m.dot(s);
      out.high = std::min(out.high, h);
      if (out.high < enough || h - out.low <= 10.0 * rounding_) return out;
      add(s);
    }
    return out;
  }

 private:
  struct Face {
    int v[3];
    Vec3 normal;
    double offset;
  };

  Vec3 furthest(const Vec3& n) const {
    return support(a_, n) - X_AB_ * support(b_, X_AB_.q.conjugate() * -n);
  }
  /// Of the polytope to the origin outside it.
  Vec3 nearest_point() const {
    Vec3 best = points_[0];
    for (const Face& f : faces_) {
      if (f.offset > 0.0) continue;
      Simplex s;
      for (const int i : f.v) s.add(points_[size_t(i)], Vec3::Zero(), Vec3::Zero());
      const Vec3 p = s.reduce(Vec3::Zero());
      if (p.squaredNorm() < best.squaredNorm()) best = p;
    }
    return best;
  }
  void triangle(int i, int j, int k) {
    const Vec3 n =
        (points_[size_t(j)] - points_[size_t(i)]).cross(points_[size_t(k)] - points_[size_t(i)]);
    const double length = n.norm();
    // A sliver has no plane of its own: those next to it stand for it.
    const Vec3 unit = length > 0.0 ? Vec3(n / length) : Vec3::Zero();
    faces_.push_back({{i, j, k}, unit, length > 0.0 ? unit.dot(points_[size_t(i)]) : kInfinity});
  }
  void start() {
    for (int k = 0; k < 3; ++k) {
      Vec3 axis = Vec3::Zero();
      axis[k] = 1.0;
      points_.push_back(furthest(axis));
      points_.push_back(furthest(-axis));
    }
    for (const Vec3& p : points_) rounding_ = std::max(rounding_, 1e-14 * p.norm());
    // The octahedron of the six, which is convex or grows so: a tetrahedron and the others.
    Vec3 across = points_[1] - points_[0];
    int far = 2;
    double most = 0.0;
    for (int i = 2; i < 6; ++i) {
      const double area = across.cross(points_[size_t(i)] - points_[0]).norm();
      if (area > most) most = area, far = i;
    }
    const Vec3 n = across.cross(points_[size_t(far)] - points_[0]);
    const Vec3 up = furthest(n / n.norm()), down = furthest(-n / n.norm());
    const bool is_up = n.dot(up - points_[0]) > n.dot(points_[0] - down);
    points_.push_back(is_up ? up : down);
    const int top = 6;
    if (is_up) {
      triangle(0, far, 1), triangle(0, 1, top), triangle(1, far, top), triangle(far, 0, top);
    } else {
      triangle(0, 1, far), triangle(1, 0, top), triangle(far, 1, top), triangle(0, far, top);
    }
    add(is_up ? down : up);
    const std::vector<Vec3> rest(points_.begin() + 2, points_.begin() + 6);
    for (const Vec3& p : rest) add(p);
  }
  void add(const Vec3& s) {
    const int number = static_cast<int>(points_.size());
    points_.push_back(s);
    edges_.clear();
    std::size_t kept = 0;
    for (const Face& f : faces_) {
      if (f.offset == kInfinity || f.normal.dot(s) - f.offset <= -rounding_) {
        faces_[kept++] = f;
        continue;
      }
      for (int k = 0; k < 3; ++k) {
        const std::pair<int, int> edge{f.v[k], f.v[(k + 1) % 3]};
        const auto back =
            std::find(edges_.begin(), edges_.end(), std::pair<int, int>{edge.second, edge.first});
        if (back != edges_.end()) {
          edges_.erase(back);
        } else {
          edges_.push_back(edge);
        }
      }
    }
    faces_.resize(kept);
    for (const auto& [i, j] : edges_) triangle(i, j, number);
  }

  const Shape& a_;
  const Shape& b_;
  const Pose& X_AB_;
  double rounding_ = 0.0;
  std::vector<Vec3> points_;
  std::vector<Face> faces_;
  std::vector<std::pair<int, int>> edges_;
};

double aspect(Random& random) {
  return std::pow(10.0, random.uniform(-1.0, 1.0));
}

Shape make(Random& random, Form form) {
  const double k = std::pow(10.0, random.uniform(-0.5, 0.5));
  switch (form) {
    case Form::sphere:
      return Ellipsoid{Vec3::Constant(k)};
    case Form::ellipsoid:
      return Ellipsoid{k * Vec3(aspect(random), aspect(random), aspect(random))};
    case Form::cylinder:
      return Cylinder{k * aspect(random), k * aspect(random)};
    case Form::cone:
      return Cone{k * aspect(random), 2.0 * k * aspect(random)};
    case Form::box:
      return box(k * Vec3(aspect(random), aspect(random), aspect(random)));
    case Form::hull:
      break;
  }
  const Polyhedron p = random_hull(random, 8 + index_below(random, 56));
  return stretched(p, k * Vec3(aspect(random), aspect(random), aspect(random)));
}

/// Normals at which shapes touch along faces, sides and rims; else anywhere.
Vec3 normal_of(Random& random, const Shape& shape) {
  if (index_below(random, 3) == 0) return direction(random);
  return special_normal(random, shape);
}

struct Placed {
  const Shape& a;
  const Shape& b;
  double size;  // of the smaller
  Pose X_AB;

  Closest ask(KeptNormal& n, double margin = 0.0) const {
    return closest_points(a, b, X_AB, n, {.margin = margin});
  }
  Closest ask_cold() const {
    KeptNormal n;
    return ask(n);
  }
  double depth_along(const Vec3& n) const {
    return n.dot(support(a, n) - X_AB * support(b, X_AB.q.conjugate() * -n));
  }
};

/// A quarter turn, or several, about the frame's axes.
Quat quarter_turns(Random& random) {
  Quat q = Quat::Identity();
  for (int k = index_below(random, 4); k > 0; --k) {
    Vec3 axis = Vec3::Zero();
    axis[index_below(random, 3)] = 1.0;
    q = Quat(Eigen::AngleAxisd(kQuarter * index_below(random, 4), axis)) * q;
  }
  return q;
}

Quat about_z(double angle) {
  return Quat(Eigen::AngleAxisd(angle, Vec3::UnitZ()));
}

/// Moves B along a line until it is `overlap` deeper than where the two touch.
void move_in(Placed& p, const Vec3& along, double overlap) {
  double meets = 0.0, apart = 1.01 * (bounding_radius(p.a) + bounding_radius(p.b)) +
                              2.0 * (p.X_AB.p - p.X_AB.p.dot(along) * along).norm();
  const Vec3 aside = p.X_AB.p - p.X_AB.p.dot(along) * along;
  for (int k = 0; k < 45; ++k) {
    const double middle = 0.5 * (meets + apart);
    p.X_AB.p = aside + middle * along;
    (p.ask_cold().separated ? apart : meets) = middle;
  }
  p.X_AB.p = aside + (apart - overlap) * along;
}

double gap_or_depth(Random& random, double size) {
  return (index_below(random, 2) ? 1.0 : -1.0) * size * std::pow(10.0, random.uniform(-7.0, -1.0));
}

void place(Random& random, Placed& p) {
  const double gap = gap_or_depth(random, p.size);
  switch (index_below(random, 4)) {
    case 0: {  // normals against each other
      const Vec3 n = normal_of(random, p.a), m = normal_of(random, p.b);
      p.X_AB.q = rotation(random.uniform(0.0, 6.0) * n) * Quat::FromTwoVectors(m, -n);
      const Vec3 aside = (index_below(random, 2) * p.size * direction(random)).cross(n);
      p.X_AB.p = support(p.a, n) - p.X_AB.q * support(p.b, m) + gap * n + aside;
      break;
    }
    case 1:  // first contact
      p.X_AB = {any_rotation(random), Vec3::Zero()};
      move_in(p, direction(random), random.uniform(0.005, 0.05) * p.size);
      break;
    case 2: {  // axes along or against each other
      Quat lean = Quat::Identity();
      if (index_below(random, 2)) {
        lean = rotation(std::pow(10.0, random.uniform(-15.0, -1.0)) * direction(random));
      }
      p.X_AB.q = about_z(random.uniform(0.0, 6.0)) * lean * quarter_turns(random) *
                 about_z(random.uniform(0.0, 6.0));
      Vec3 along = Vec3::Zero();
      along[index_below(random, 3)] = index_below(random, 2) ? 1.0 : -1.0;
      const double off = index_below(random, 2) * random.uniform(0.0, 1.0) * p.size;
      p.X_AB.p = off * Vec3(direction(random).cross(along));
      move_in(p, along, -gap);
      break;
    }
    default: {  // anywhere
      const double reach = bounding_radius(p.a) + bounding_radius(p.b);
      p.X_AB = {any_rotation(random), random.uniform(0.0, 1.1) * reach * direction(random)};
    }
  }
  // The question is asked in a frame that is turned about, so that rounding takes part.
  const Pose X_WA{any_rotation(random), p.size * direction(random)};
  p.X_AB.q.normalize();  // between opposite vectors FromTwoVectors is unit to 1e-9 only
  p.X_AB = relative(X_WA, X_WA * p.X_AB);
}

std::string describe(const Placed& p, const char* fault, const Closest& c, const KeptNormal& kept) {
  char text[1024];
  const auto numbers = [](const Shape& s) -> std::array<double, 3> {
    if (const auto* e = std::get_if<Ellipsoid>(&s))
      return {e->radii.x(), e->radii.y(), e->radii.z()};
    if (const auto* y = std::get_if<Cylinder>(&s)) return {y->radius, y->half_height, 0.0};
    if (const auto* k = std::get_if<Cone>(&s)) return {k->radius, k->height, 0.0};
    return {bounding_radius(s), 0.0, 0.0};
  };
  const auto a = numbers(p.a), b = numbers(p.b);
  std::snprintf(text, sizeof text,
                "%s: %s %.17g %.17g %.17g, %s %.17g %.17g %.17g, q %.17g %.17g %.17g %.17g, p "
                "%.17g %.17g %.17g, kept %d %.17g %.17g %.17g; answer %s %.6g along %.6g %.6g %.6g",
                fault, kind(p.a).c_str(), a[0], a[1], a[2], kind(p.b).c_str(), b[0], b[1], b[2],
                p.X_AB.q.w(), p.X_AB.q.x(), p.X_AB.q.y(), p.X_AB.q.z(), p.X_AB.p.x(), p.X_AB.p.y(),
                p.X_AB.p.z(), kept.of, kept.n_AB.x(), kept.n_AB.y(), kept.n_AB.z(),
                c.separated ? "apart" : "meeting", c.distance, c.n_AB.x(), c.n_AB.y(), c.n_AB.z());
  return text;
}

bool is_in_both(const Placed& p, const Vec3& p_A, double tolerance) {
  return contains(p.a, p_A, tolerance) && contains(p.b, p.X_AB.inverse() * p_A, tolerance);
}

/// Not asked of ellipsoids, of which one shrunk in its measures does not know.
bool is_ball_within(const Shape& s, const Vec3& p, double radius) {
  return !std::holds_alternative<Ellipsoid>(s) && contains(s, p, -radius);
}

/// Whether what is said to meet is no further apart than `tolerance`.
bool really_meets(const Placed& p, const Closest& c, double tolerance) {
  if (is_in_both(p, c.p_A, 0.1 * tolerance) || is_in_both(p, c.p_B, 0.1 * tolerance)) return true;
  return Polytope(p.a, p.b, p.X_AB).bounds(-tolerance, c.n_AB).high >= -tolerance;
}

class Judge {
 public:
  Judge(Tally& kept_in, const Placed& pair) : tally(kept_in), p(pair) {}

  void fault(std::int64_t& count, const char* what, const Closest& c, const KeptNormal& kept) {
    ++count;
    if (tally.example.empty()) tally.example = describe(p, what, c, kept);
  }
  void verdict(const Closest& c, const KeptNormal& kept) {
    if (c.separated) {
      const double touching = 1e-9 * (bounding_radius(p.a) + bounding_radius(p.b));
      if (!(p.depth_along(c.n_AB) < touching) || !(std::abs(c.n_AB.norm() - 1.0) < 1e-9)) {
        fault(tally.lost, "lost", c, kept);
      }
    } else if (!really_meets(p, c, 1e-6 * p.size)) {
      fault(tally.phantoms, "phantom", c, kept);
    }
  }
  /// Returns a depth that nothing lies below; cached, as the same pair is judged several times.
  void depth(const Closest& c, const KeptNormal& kept, std::int64_t& count, const char* what) {
    const double d = -c.distance;
    if (c.separated || d > 0.05 * p.size) return;
    const double rounding = 1e-8 * (bounding_radius(p.a) + bounding_radius(p.b));
    if (std::abs(p.depth_along(c.n_AB) - d) > rounding) return fault(count, what, c, kept);
    const double enough = d / 1.01 - rounding;
    if (enough <= std::max(0.0, proven_)) return;  // what is apart is the verdict's
    if (is_ball_within(p.a, c.p_B, enough) ||
        is_ball_within(p.b, p.X_AB.inverse() * c.p_A, enough)) {
      proven_ = std::max(proven_, enough);
      return;
    }
    const auto bounds = Polytope(p.a, p.b, p.X_AB).bounds(enough, c.n_AB);
    proven_ = std::max(proven_, bounds.low);
    if (bounds.high >= enough) return;
    tally.worst = std::max(tally.worst, d / bounds.high);
    fault(count, what, c, kept);
  }

 private:
  Tally& tally;
  const Placed& p;
  double proven_ = -kInfinity;
};

void judge(Random& random, Tally& tally, const Placed& p) {
  Judge judge(tally, p);
  KeptNormal left;
  const Closest cold = p.ask(left);
  ++tally.pairs;
  tally.meeting += !cold.separated;
  tally.capped += cold.capped;
  const bool shallow = !cold.separated && -cold.distance <= 0.05 * p.size;
  tally.shallow += shallow;
  judge.verdict(cold, {});
  judge.depth(cold, {}, tally.deep, "deep");

  Placed before = p;
  before.X_AB.q = (rotation(1e-2 * direction(random)) * p.X_AB.q).normalized();
  before.X_AB.p += 1e-2 * p.size * direction(random);
  KeptNormal of_before;
  before.ask(of_before);
  const KeptNormal::Of of = index_below(random, 2) ? KeptNormal::met : KeptNormal::apart;
  bool disagreed = false;
  const std::int64_t deep_before = tally.deep_kept;
  for (const KeptNormal& kept : {left, of_before, KeptNormal{direction(random), of}}) {
    KeptNormal n = kept;
    const Closest warm = p.ask(n);
    judge.verdict(warm, kept);
    judge.depth(warm, kept, tally.deep_kept, "deep, kept");
    const double gap =
        std::max(cold.separated ? cold.distance : 0.0, warm.separated ? warm.distance : 0.0);
    if (warm.separated != cold.separated && gap > 1e-6 * p.size && !disagreed) {
      disagreed = true;
      judge.fault(tally.disagreed, "disagreed", warm, kept);
    }
  }
  tally.deep_kept = std::min(tally.deep_kept, deep_before + 1);  // pairs, not answers

  KeptNormal n;
  const Closest near = p.ask(n, 0.02 * p.size);
  if (near.separated && near.distance <= 0.02 * p.size) {
    const double most = 1.01 * near.distance + 1e-6 * p.size;
    const bool close = (near.p_B - near.p_A).norm() <= most ||
                       Polytope(p.a, p.b, p.X_AB).bounds(-most, near.n_AB).high >= -most;
    if (!close) judge.fault(tally.loose, "loose", near, {});
  }
}

}  // namespace

const char* name(Form form) {
  constexpr const char* kNames[] = {"sphere", "ellipsoid", "cylinder", "cone", "box", "hull"};
  return kNames[static_cast<int>(form)];
}

Tally try_pairs(Form a, Form b, std::int64_t pairs, std::uint64_t seed) {
  Random random(seed * 1000003 + static_cast<std::uint64_t>(a) * 16 +
                static_cast<std::uint64_t>(b));
  // Making a hull takes longer than asking a thousand questions of it.
  const double scales[] = {1e-3, 1.0, 1e3};
  const int many = static_cast<int>(std::clamp<std::int64_t>(pairs / 500, 12, 60));
  std::vector<Shape> pool_a[3], pool_b[3];
  for (int i = 0; i < many; ++i) {
    const Shape sa = make(random, a), sb = make(random, b);
    for (int k = 0; k < 3; ++k) {
      pool_a[k].push_back(scaled(sa, scales[k]));
      pool_b[k].push_back(scaled(sb, scales[k]));
    }
  }
  Tally tally;
  for (std::int64_t i = 0; i < pairs; ++i) {
    const int k = index_below(random, 3);
    const Shape& sa = pool_a[k][static_cast<std::size_t>(index_below(random, many))];
    const Shape& sb = pool_b[k][static_cast<std::size_t>(index_below(random, many))];
    const bool swapped = index_below(random, 2) != 0;
    Placed p{swapped ? sb : sa,
             swapped ? sa : sb,
             std::min(bounding_radius(sa), bounding_radius(sb)),
             {}};
    place(random, p);
    judge(random, tally, p);
  }
  return tally;
}

}  // namespace headpin::engine::test
