#pragma once

#include <cstdint>

#include "base/random.h"
#include "engine/shape.h"

/// Seeded shapes, directions and poses for properties that must hold for all of them.
namespace headpin {

/// Below `n`.
inline int index_below(Random& random, int n) {
  return static_cast<int>(random.next() % static_cast<std::uint64_t>(n));
}
/// Evenly over the sphere.
Vec3 direction(Random& random);
/// Evenly over all rotations.
Quat any_rotation(Random& random);

}  // namespace headpin

namespace headpin::engine::test {

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
