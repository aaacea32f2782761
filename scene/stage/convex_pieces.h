#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/shape.h"

namespace headpin::scene {

/// A surface of triangles.
struct Surface {
  std::vector<Vec3> points;                             ///< [m]
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counterclockwise from outside
};

/// What a closed surface encloses [m^3]; below 0 if it is turned inside out.
double volume_of(const Surface& surface);

/// What a polyhedron encloses [m^3].
double volume_of(const engine::Polyhedron& polyhedron);

/// Convex polyhedra in place of a closed surface that is not convex.
///
/// The box around it is cut by planes across its axes, at edges where the surface bends inwards, and
/// each piece is the hull of what a cell of the box contains. The cell whose hull adds most volume is
/// cut first, where the hulls of its halves add least, until all hulls add less than `added` of the
/// volume, or there are `most` pieces. The pieces do not overlap. A surface of several closed shells is cut
/// shell by shell, and pieces overlap where shells do; of more than `most` shells, those pieces become one
/// whose common hull adds least.
///
/// @param most   number of pieces, 1 or more; with 1 it is the hull
/// @param added  part of the volume [1]
/// @throws std::invalid_argument  for a surface that is not closed, is turned inside out or has no
///                                volume
std::vector<engine::Polyhedron> convex_pieces(const Surface& surface, std::size_t most,
                                              double added = 0.01);

}  // namespace headpin::scene
