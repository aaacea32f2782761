#pragma once

#include <cstdint>
#include <vector>

#include "engine/shape.h"

namespace headpin::scene {

/// Points of a mesh within this part of its size are one point.
inline constexpr double kWelded = 1e-6;

/// Merges points that are near each other; STL has no shared corners.
///
/// @param apart     points within this distance are equal [m]
/// @param distinct  the points that are left are appended here
/// @return the index among these of each corner
std::vector<std::uint32_t> weld(const std::vector<Vec3>& corners, double apart,
                                std::vector<Vec3>& distinct);

/// The convex hull of points, by Qhull. Triangles in one plane are one face.
///
/// @param points  [m], in any order; points inside the hull, and several in one place, are allowed
/// @throws std::invalid_argument  if they have no volume
engine::Polyhedron convex_hull(const std::vector<Vec3>& points);

}  // namespace headpin::scene
