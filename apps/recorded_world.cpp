#include "apps/recorded_world.h"

#include <algorithm>

namespace headpin::apps {

RecordedWorld::RecordedWorld(const scene::Scenario& scenario)
    : stage_(scene::make_stage(scenario)) {
  for (const engine::BodyId ball : stage_.balls) {
    engine::set_kind(stage_.world, ball, engine::Kind::free);  // so that it also counts in the hand
  }
}

RecordedWorld::Energy RecordedWorld::energy(const scene::TickState& state) {
  engine::World& world = stage_.world;
  Energy energy;
  const std::size_t bodies = std::min(world.states.size(), state.bodies.size());
  for (std::size_t i = 0; i < bodies; ++i) {
    const scene::BodyState& body = state.bodies[i];
    world.states[i] = {body.X_WB, body.V_WB.v, body.V_WB.w};
    if (world.bodies[i].kind != engine::Kind::free) continue;
    energy.height -= world.bodies[i].mass * world.parameters.gravity_W.dot(body.X_WB.p);
  }
  energy.all = engine::balance(world).energy;
  return energy;
}

}  // namespace headpin::apps
