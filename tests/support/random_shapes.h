#pragma once

#include <cstdint>

#include "engine/shape.h"

/// Seeded shapes, directions and poses for properties that must hold for all of them.
namespace headpin::engine::test {

/// A small generator of our own (splitmix64), so that a seed means the same everywhere.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t bits() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(bits() >> 11) * 0x1p-53;
  }
  /// Mean 0, deviation 1, |x| <= 6: the sum of twelve uniform ones. The distributions of the standard
  /// library differ between implementations.
  double normal() {
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) sum += uniform(0.0, 1.0);
    return sum;
  }
  int index(int n) { return static_cast<int>(bits() % static_cast<std::uint64_t>(n)); }

  /// Evenly over the sphere.
  Vec3 direction();
  /// Evenly over all rotations.
  Quat rotation();

 private:
  std::uint64_t state_;
};

/// Convex hull of `count` points on an ellipsoid with random semi-axes 0.3..0.6 m: triangles.
Polyhedron random_hull(Random& random, int count);

Polyhedron box(const Vec3& half);

enum class ShapeKind { ellipsoid, cylinder, cone, hull };
inline constexpr ShapeKind kShapeKinds[] = {ShapeKind::ellipsoid, ShapeKind::cylinder,
                                            ShapeKind::cone, ShapeKind::hull};

/// About one metre across; hulls have 64 vertices.
Shape random_shape(Random& random, ShapeKind kind);

/// A normal at which the shape touches along a face, a side or a rim, or anywhere.
Vec3 special_normal(Random& random, const Shape& shape);

/// The shape scaled about its origin.
Shape scaled(const Shape& shape, double factor);

/// A polyhedron drawn out along its axes, each by its factor above 0.
Polyhedron stretched(const Polyhedron& shape, const Vec3& factors);

/// The shape mirrored in the plane x = 0 of its own frame.
Shape mirrored(const Shape& shape);

}  // namespace headpin::engine::test
