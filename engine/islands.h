#pragma once

#include "engine/workspace.h"
#include "engine/world.h"

/// Islands: free and awake bodies joined by touches. Private to the engine.
namespace headpin::engine::detail {

/// Finds the islands and sorts the touches by island.
void find_islands(const World& world, const std::vector<Touch>& touches, Islands& islands);

/// Representative of a body's island: the smallest number in it.
BodyId island_root(std::vector<BodyId>& parent, BodyId i);

}  // namespace headpin::engine::detail
