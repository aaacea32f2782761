#include "engine/islands.h"

#include <algorithm>

namespace headpin::engine::detail {

BodyId island_root(std::vector<BodyId>& parent, BodyId i) {
  while (parent[i] != i) {
    parent[i] = parent[parent[i]];
    i = parent[i];
  }
  return i;
}

void find_islands(const World& world, const std::vector<Touch>& touches, Islands& islands) {
  std::vector<BodyId>& parent = islands.parent;
  parent.resize(world.bodies.size());
  islands.number.resize(world.bodies.size());
  for (const BodyId i : world.roll.movers) {
    parent[i] = i;
    islands.number[i] = kNone;
  }
  for (const Touch& touch : touches) {
    if (!touch.b_moves) continue;
    const BodyId a = island_root(parent, touch.a), b = island_root(parent, touch.b);
    parent[std::max(a, b)] = std::min(a, b);
  }
  // Number the islands by their first touch, count their touches, and sort the touches by island.
  islands.end.clear();
  islands.of.resize(touches.size());
  for (std::size_t k = 0; k < touches.size(); ++k) {
    std::uint32_t& n = islands.number[island_root(parent, touches[k].a)];
    if (n == kNone) {
      n = static_cast<std::uint32_t>(islands.end.size());
      islands.end.push_back(0);
    }
    islands.of[k] = n;
    ++islands.end[n];
  }
  std::uint32_t sum = 0;
  for (std::uint32_t& start : islands.end) {
    const std::uint32_t count = start;
    start = sum;
    sum += count;
  }
  islands.order.resize(touches.size());
  for (std::size_t k = 0; k < touches.size(); ++k) {
    islands.order[islands.end[islands.of[k]]++] = static_cast<std::uint32_t>(k);
  }
  // Each entry of `end` is now the end of its island.
}

}  // namespace headpin::engine::detail
