#pragma once

#include <cstdint>
#include <vector>

#include "engine/compound.h"

/// The data sets of the paper's comparison, made by code.
///
/// The paper has 7 compound objects of 22 polyhedral primitives with 419 and with 970 polygons in
/// all and does not say which objects; ours are six skittles (cylinder foot, ellipsoid belly, cone
/// head) and a hand of four (ellipsoid palm, two cylinder fingers, cone thumb).
namespace headpin::engine::test {

struct PaperData {
  std::vector<Compound> parametric;  ///< 7 objects of 22 primitives
  std::vector<Compound>
      polyhedral;    ///< the same, each primitive tessellated, corners on its surface
  int polygons = 0;  ///< faces of all polyhedra together
};

/// @param polygons  exactly so many in all, 120 or more
/// @throws std::invalid_argument  below that
PaperData paper_data(int polygons);

/// Random poses of the objects, each frame's anew, in a cube of this side [m].
std::vector<std::vector<Pose>> paper_frames(std::uint64_t seed, int frames, double side);

/// Lathe tessellations with corners on the surface.
Polyhedron prism(const Cylinder& s, int sides);              ///< sides + 2 faces
Polyhedron pyramid(const Cone& s, int sides);                ///< sides + 1 faces
Polyhedron globe(const Ellipsoid& s, int sides, int bands);  ///< sides * bands faces

}  // namespace headpin::engine::test
