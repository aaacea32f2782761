#pragma once

#include <cstddef>
#include <vector>

#include "engine/shape.h"

namespace headpin::scene {

/// At most `most` convex polyhedra that contain the given ones: again and again the two become their
/// common hull where it adds least volume.
///
/// What a hull adds is told by its outermost corners in 26 directions; of more than 64 polyhedra by the
/// boxes around them.
///
/// @param most  number of polyhedra, 1 or more
std::vector<engine::Polyhedron> merged_pieces(const std::vector<engine::Polyhedron>& pieces,
                                              std::size_t most);

}  // namespace headpin::scene
