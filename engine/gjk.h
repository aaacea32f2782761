#pragma once

#include "base/math.h"

/// Distance of a convex set from the origin, from its support points alone (Gilbert, Johnson and
/// Keerthi 1988). The fallback of the non-colliding method.
namespace headpin::engine {

/// Up to four points of the set A - B with the points of A and B they come from.
struct Simplex {
  Vec3 w[4], a[4], b[4];
  double weight[4] = {0.0, 0.0, 0.0, 0.0};
  int count = 0;

  void add(const Vec3& point, const Vec3& of_A, const Vec3& of_B) {
    w[count] = point;
    a[count] = of_A;
    b[count] = of_B;
    weight[count] = 1.0;
    ++count;
  }

  /// Reduces the simplex to the smallest part that contains its point nearest to `from`, and sets
  /// the weights. Returns that point minus `from`. If four points are left, `from` is inside.
  Vec3 reduce(const Vec3& from);

  bool holds(const Vec3& point) const {
    for (int i = 0; i < count; ++i) {
      if (w[i] == point) return true;
    }
    return false;
  }

  Vec3 p_A() const { return mix(a); }
  Vec3 p_B() const { return mix(b); }

 private:
  Vec3 mix(const Vec3 (&p)[4]) const {
    Vec3 sum = Vec3::Zero();
    for (int i = 0; i < count; ++i) sum += weight[i] * p[i];
    return sum;
  }
};

}  // namespace headpin::engine
