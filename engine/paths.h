#pragma once

#include "engine/bodies.h"
#include "engine/workspace.h"

/// Where bodies are within a step, which they go through one impact after the other. Private to the
/// engine.
namespace headpin::engine::detail {

/// Turn within a step after which the points of a contact are others [rad].
inline constexpr double kFarTurn = 0.2;

/// Makes the list of who takes part, if it does not hold. @return whether it was made
bool know_roll(World& world);

/// All bodies at the start of the step.
void depart(World& world, Flight& flight);

/// Notes bounds on how fast the body's points move, now.
inline void note_speed(const World& world, Flight& flight, BodyId i) {
  const State& s = world.states[i];
  Flyer& flyer = flight.bodies[i];
  flyer.swing = s.w_WB.norm() * world.bodies[i].shape->bounding_radius;
  flyer.top_speed = s.v_WB.norm() + flyer.swing;
}

/// What gravity does to the velocity of a body on its way to the next impact [m/s^2].
inline Vec3 pull_on(const World& world, const Flight& flight, BodyId i) {
  return flight.bodies[i].falls ? world.parameters.gravity_W : Vec3::Zero();
}
inline Vec3 position_at(const World& world, const Flight& flight, BodyId i, double t) {
  const State& s = world.states[i];
  const double passed = t - flight.bodies[i].clock;
  if (passed == 0.0) return s.X_WB.p;
  return s.X_WB.p + passed * s.v_WB + 0.5 * passed * passed * pull_on(world, flight, i);
}

/// A body at time `t` of the step, on the path it now has: exact where nothing touches it.
State state_at(const World& world, const Flight& flight, BodyId i, double t);

/// What approaches faster is followed to where it meets within the step: impacts, and lasting
/// contacts that would go deep before the step's end.
inline double followed_speed(const World& world, const Flight& flight, BodyId a, BodyId b) {
  return std::min(flight.lasting_speed, deep_for(world, a, b) * world.parameters.rate_hz);
}

}  // namespace headpin::engine::detail
