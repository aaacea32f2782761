#pragma once

#include "engine/shape.h"

/// The method that the paper compares the non-colliding one with: polyhedra only, every vertex and
/// every edge of one object tested against the inside of the other [BARA 90; GANT 93].
namespace headpin::engine {

enum class EarlyOut {
  no,  ///< every vertex and every edge against every face, as the cost m n of the paper has it
  yes  ///< a vertex or edge is done with at the first face that it is outside of, the pair at the
       ///< first vertex or edge found inside
};

/// Whether two polyhedra have a point in common: a vertex of one lies inside the other, or an edge
/// of one passes through it. Both settings give the same verdict. It gives no contact point and no
/// depth.
///
/// Used only for comparison. Cost: O(vertices and edges of a * faces of b), and the reverse.
///
/// @param X_AB  frame of b in the frame of a
bool intersect_by_features(const Polyhedron& a, const Polyhedron& b, const Pose& X_AB,
                           EarlyOut early_out = EarlyOut::yes);

}  // namespace headpin::engine
