#pragma once

#include <cstddef>

#include "scene/stage/convex_pieces.h"

/// How much of a volume is counted more than once.
namespace headpin::scene {

/// A polyhedron's surface, of triangles.
Surface surface_of(const engine::Polyhedron& polyhedron);

/// Adds the triangles of a closed surface to those of another one.
void append(Surface& to, const Surface& from);

/// A box.
struct Bounds {
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();  ///< [m]
};

/// The box around a surface of one point or more.
Bounds bounds_of(const Surface& surface);

/// Number of lines that measures an overlap in bounded time: 30,000, which is to about 0.1 % of it, or
/// fewer for a surface of more than 2000 triangles.
std::size_t columns_for(const Surface& surface);

/// What volume_of() counts of a surface beyond what is enclosed [m^3], as where shells overlap: the
/// volume is volume_of() less this. It is 0, but for rounding, where nothing overlaps.
///
/// It is measured along vertical lines, which are evenly spread over the box: exactly along each of
/// them. The same box has the same lines, so that differences of two surfaces are better than each.
///
/// @param columns  number of lines
double overlap_of(const Surface& closed, const Bounds& box, std::size_t columns);

}  // namespace headpin::scene
