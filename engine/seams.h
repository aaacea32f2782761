#pragma once

#include <vector>

#include "engine/world.h"

/// Where flat faces of fixed parts join to one plane. Private to the engine.
///
/// Each part is searched alone, so what slides over such a seam would meet the edge of the next part,
/// which the union of both does not have.
namespace headpin::engine::detail {

/// Finds the seams of all fixed polyhedra, where they are not known.
void know_seams(World& world);

struct Placed {
  BodyId body;
  const Pose& X_WB;
};

/// Mends the contact points of two bodies, from `first` on, whose normals lean over a seam: what is lowest
/// over the part itself meets its face, and what is lowest over the next part is left to that.
///
/// @param a, b  normals point from A to B
void mend_at_seams(const World& world, const Placed& a, const Placed& b, std::size_t first,
                   std::vector<ContactPoint>& points);

}  // namespace headpin::engine::detail
