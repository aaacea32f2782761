#pragma once

#include "engine/workspace.h"
#include "engine/world.h"

/// Movers joined by touches. Private to the engine.
namespace headpin::engine::detail {

/// Sorts the touches by island, each island's in their own order.
///
/// @param bodies  as many as the world has; gets those of the movers anew
void find_islands(const World& world, const std::vector<Touch>& touches,
                  std::vector<SolvedBody>& bodies, Islands& islands);

/// Representative of a body's island: the smallest number in it.
BodyId island_root(std::vector<SolvedBody>& bodies, BodyId i);

}  // namespace headpin::engine::detail
