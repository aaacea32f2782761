#pragma once

#include "engine/math.h"

/// Distance of a convex set from the origin, from its support points alone (Gilbert, Johnson and
/// Keerthi 1988). The fallback of the non-colliding method.
namespace headpin::engine {

/// Up to four points of the set A - B with the points of A and B they come from.
struct Simplex {
  Vec3 w[4], a[4], b[4];
  double weight[4] = {0.0, 0.0, 0.0, 0.0};
  int count = 0;

  /// Keeps the smallest part of the simplex that holds its point nearest to the origin, weights it,
  /// and returns that point. With four points left the origin is inside.
  Vec3 reduce();

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
