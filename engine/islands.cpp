#include "engine/islands.h"

#include <algorithm>

namespace headpin::engine::detail {

BodyId island_root(std::vector<SolvedBody>& bodies, BodyId i) {
  while (bodies[i].parent != i) {
    bodies[i].parent = bodies[bodies[i].parent].parent;
    i = bodies[i].parent;
  }
  return i;
}

void find_islands(const World& world, const std::vector<Touch>& touches,
                  std::vector<SolvedBody>& bodies, Islands& islands) {
  for (const BodyId i : world.roll.movers) bodies[i] = {.parent = i, .island = kNone};
  for (const Touch& touch : touches) {
    if (!touch.b_moves) continue;
    const BodyId a = island_root(bodies, touch.a), b = island_root(bodies, touch.b);
    bodies[std::max(a, b)].parent = std::min(a, b);
  }
  // Number the islands by their first touch, count, and deal the touches out.
  islands.end.clear();
  islands.of.resize(touches.size());
  for (std::size_t k = 0; k < touches.size(); ++k) {
    std::uint32_t& n = bodies[island_root(bodies, touches[k].a)].island;
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
  // Each start is now the end of its island.
}

}  // namespace headpin::engine::detail
