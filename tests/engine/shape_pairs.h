#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "engine/non_colliding.h"
#include "tests/support/random_shapes.h"

/// Pairs of shapes to ask about, and what is asked of them.
namespace headpin::engine::test {

#ifdef HEADPIN_SANITIZED
inline constexpr int kThin = 50;  // long properties in a fiftieth of the pairs
#else
inline constexpr int kThin = 1;
#endif

inline Closest query(const Shape& a, const Shape& b, const Pose& X_AB, const Query& q = {}) {
  KeptNormal kept;
  return closest_points(a, b, X_AB, kept, q);
}

/// Depth of the pair along n, straight from the definition: negative is a gap.
inline double depth_along(const Shape& a, const Shape& b, const Pose& X_AB, const Vec3& n) {
  return n.dot(support(a, n) - X_AB * support(b, X_AB.q.conjugate() * -n));
}

/// A few of each kind: making a hull takes longer than asking a thousand questions of it.
struct Pool {
  explicit Pool(std::uint64_t seed) : random(seed) {
    for (const ShapeKind k : kShapeKinds) {
      for (int i = 0; i < 25; ++i) shapes[static_cast<int>(k)].push_back(random_shape(random, k));
    }
  }
  const Shape& pick(int kind) {
    const auto& of_kind = shapes[kind];
    return of_kind[static_cast<std::size_t>(index_below(random, static_cast<int>(of_kind.size())))];
  }
  Random random;
  std::vector<Shape> shapes[4];
};

/// Distance at which two shapes touch when the second moves in along a line.
inline double touching_distance(const Shape& a, const Shape& b, const Quat& q, const Vec3& along) {
  double meets = 0.0, apart = 4.0;
  for (int k = 0; k < 55; ++k) {
    const double middle = 0.5 * (meets + apart);
    (query(a, b, {q, middle * along}).separated ? apart : meets) = middle;
  }
  return apart;
}

/// A pair that overlaps by 0.005 to 0.05 of its size along a random line.
struct Shallow {
  Shape a, b;
  Pose X_AB;
};

inline Shallow shallow(Pool& pool, int ka, int kb) {
  const Shape &a = pool.pick(ka), &b = pool.pick(kb);
  const Quat q = any_rotation(pool.random);
  const Vec3 along = direction(pool.random);
  const double t = touching_distance(a, b, q, along);
  return {a, b, {q, (t - pool.random.uniform(0.005, 0.05)) * along}};
}

/// Rows of hard cases, each at a gap, in a random pose.
struct HardCase {
  const char* name;
  Shape a, b;
  Pose X_AB;  // at gap zero
  Vec3 n = Vec3::UnitZ();
  double least = 1.0;  // least way out of an overlap, over the overlap along n
};

inline std::vector<HardCase> hard_cases() {
  const Quat I = Quat::Identity();
  const Quat upside_down(0.0, 1.0, 0.0, 0.0);
  return {
      {"coaxial cylinders, flat on flat", Cylinder{0.5, 0.5}, Cylinder{0.3, 0.4}, {I, {0, 0, 0.9}}},
      {"cylinders flat on flat, off centre",
       Cylinder{0.5, 0.5},
       Cylinder{0.3, 0.4},
       {I, {0.3, 0.1, 0.9}}},
      {"parallel cylinders, side by side",
       Cylinder{0.5, 0.5},
       Cylinder{0.3, 0.4},
       {I, {0.8, 0, 0.1}},
       Vec3::UnitX()},
      {"cone base on cap", Cylinder{0.5, 0.5}, Cone{0.4, 0.8}, {I, {0.1, 0.2, 0.9}}},
      {"apex on cap", Cylinder{0.5, 0.5}, Cone{0.4, 0.8}, {upside_down, {0.1, 0.2, 0.9}}},
      {"disc 1:100 against ellipsoid",
       Cylinder{1.0, 0.005},
       Ellipsoid{{0.3, 0.4, 0.5}},
       {I, {0.4, -0.3, 0.505}}},
      {"slab of radius 20 and ball of 0.1",
       Cylinder{20.0, 0.5},
       Ellipsoid{{0.1, 0.1, 0.1}},
       {I, {11.0, 7.0, 0.6}}},
      {"box on box", test::box({0.5, 0.4, 0.3}), test::box({0.3, 0.3, 0.2}), {I, {0.1, 0.1, 0.5}}},
      {"apex to apex",  // the way out is across the slant
       Cone{0.4, 0.8},
       Cone{0.4, 0.8},
       {upside_down, {0, 0, 0.8}},
       Vec3::UnitZ(),
       0.4 / std::sqrt(0.4 * 0.4 + 0.8 * 0.8)},
  };
}

struct Least {
  double depth;
  Vec3 n;
};

/// The least depth over the sphere, by search: many directions, then ever smaller steps from the
/// best.
inline Least searched(Random& random, const Shallow& p, const Vec3& also) {
  double least = depth_along(p.a, p.b, p.X_AB, also);
  Vec3 best = also;
  for (int k = 0; k < 1500; ++k) {
    const Vec3 n = direction(random);
    const double d = depth_along(p.a, p.b, p.X_AB, n);
    if (d < least) {
      least = d;
      best = n;
    }
  }
  double step = 0.1;
  for (int k = 0; k < 1500; ++k) {
    const Vec3 n = (best + step * direction(random)).normalized();
    const double d = depth_along(p.a, p.b, p.X_AB, n);
    if (d < least) {
      least = d;
      best = n;
    } else {
      step = std::max(0.985 * step, 1e-10);
    }
  }
  return {least, best};
}

inline double percentile(std::vector<double> v, double p) {
  std::sort(v.begin(), v.end());
  return v[static_cast<std::size_t>(p * static_cast<double>(v.size() - 1))];
}

inline double degrees_between(const Vec3& a, const Vec3& b) {
  return 2.0 * std::asin(std::min(1.0, 0.5 * (a - b).norm())) * 57.29577951308232;
}

}  // namespace headpin::engine::test
