#pragma once

#include <span>

#include "engine/workspace.h"
#include "engine/world.h"

/// Islands: free and awake bodies joined by touches. Private to the engine.
namespace headpin::engine::detail {

/// Finds the islands and sorts the touches by island.
void find_islands(const World& world, const std::vector<Touch>& touches, Islands& islands);

/// Numbers of an island's touches, in ascending order.
inline std::span<const std::uint32_t> touches_of(const Islands& islands, std::uint32_t island) {
  const std::uint32_t begin = island == 0 ? 0 : islands.end[island - 1];
  return std::span(islands.order).subspan(begin, islands.end[island] - begin);
}
/// The same for all islands of a part.
inline std::span<const std::uint32_t> touches_of(const Islands& islands, const IslandPart& part) {
  const std::uint32_t begin = part.begin == 0 ? 0 : islands.end[part.begin - 1];
  const std::uint32_t end = part.end == 0 ? 0 : islands.end[part.end - 1];
  return std::span(islands.order).subspan(begin, end - begin);
}

/// Representative of a body's island: the smallest number in it.
BodyId island_root(std::vector<BodyId>& parent, BodyId i);

}  // namespace headpin::engine::detail
