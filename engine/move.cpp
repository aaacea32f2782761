#include "engine/at_end.h"
#include "engine/stages.h"

namespace headpin::engine::detail {
namespace {

// Velocities are those at the end of the step. A falling body moves with the mean of the velocities
// at the start and the end. A carried body moves with the end velocity, for which its contacts were
// solved. A partly carried body moves with a velocity in between, which keeps its energy.
void move_to_end(const World& world, const Flight& flight, const Solved& solved, BodyId i,
                 Pose& X_WB, Vec3& w_WB) {
  const double left = step_seconds(world) - flight.bodies[i].clock;
  const double falls = 1.0 - solved.carried[i];
  X_WB.p += left * world.states[i].v_WB;
  if (falls > 0.0) X_WB.p -= (0.5 * falls * left * left) * world.parameters.gravity_W;
  turn_freely(X_WB.q, w_WB, world.inertias[i], left);
}

void drive_to_end(const World& world, BodyId i, Pose& X_WB) {
  const State& state = world.states[i];
  const double dt = step_seconds(world);
  X_WB.p += dt * state.v_WB;
  X_WB.q = (rotation(dt * state.w_WB) * X_WB.q).normalized();
}

}  // namespace

Pose pose_at_end(const World& world, const Flight& flight, const Solved& solved, BodyId i) {
  State s = world.states[i];
  if (is_mover(world, i)) {
    move_to_end(world, flight, solved, i, s.X_WB, s.w_WB);
  } else if (world.bodies[i].kind == Kind::driven) {
    drive_to_end(world, i, s.X_WB);
  }
  return s.X_WB;
}

void move(World& world, const Flight& flight, const Solved& solved) {
  for (const BodyId i : world.roll.movers) {
    move_to_end(world, flight, solved, i, world.states[i].X_WB, world.states[i].w_WB);
  }
  for (const BodyId i : world.roll.driven) drive_to_end(world, i, world.states[i].X_WB);
}

}  // namespace headpin::engine::detail
