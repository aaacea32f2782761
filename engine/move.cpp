#include "engine/at_end.h"
#include "engine/stages.h"

namespace headpin::engine::detail {

void move(World& world, const Flight& flight, const Solved& solved, Workspace& w) {
  each_mover(world, w, [&](BodyId i) { to_end(world, flight, solved, i, world.states[i]); });
  for (const BodyId i : world.roll.driven) to_end(world, flight, solved, i, world.states[i]);
}

}  // namespace headpin::engine::detail
