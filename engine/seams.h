#pragma once

#include <span>

#include "engine/world.h"

/// Where flat faces of fixed parts join to one plane. Private to the engine.
///
/// Each part is searched alone, so what slides over such a seam would meet the edge of the next part,
/// which the union of both does not have.
namespace headpin::engine::detail {

/// Finds the seams of all fixed polyhedra, where they are not known.
void know_seams(World& world);

/// Contact points of a candidate's bodies, from `first` on, without those that lean over a seam.
///
/// @param a, b  the bodies; normals point from A to B
void leave_out_seams(const World& world, BodyId a, BodyId b, std::size_t first,
                     std::vector<ContactPoint>& points);

}  // namespace headpin::engine::detail
