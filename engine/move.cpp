#include "engine/at_end.h"
#include "engine/stages.h"

namespace headpin::engine::detail {

void move(World& world, const Flight& flight, const Solved& solved) {
  const auto to_end = [&](BodyId i) { world.states[i] = state_at_end(world, flight, solved, i); };
  for (const BodyId i : world.roll.movers) to_end(i);
  for (const BodyId i : world.roll.driven) to_end(i);
}

}  // namespace headpin::engine::detail
