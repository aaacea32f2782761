#pragma once

#include "engine/world.h"

/// What all parts of a step ask of a world's bodies. Private to the engine.
namespace headpin::engine::detail {

/// Gap up to which one body lies on another [m].
inline constexpr double kRests = 1e-4;

/// The one place where kind and sleep of a body change: who moves is then found anew.
void become(World& world, BodyId i, Kind kind, bool asleep);

/// Its number and name, for messages.
std::string title(const World& world, BodyId i);

/// Free and awake: forces move it.
inline bool is_mover(const World& world, BodyId i) {
  return world.bodies[i].kind == Kind::free && world.asleep[i] == 0;
}

/// Energy of motion of a body, per mass [m^2/s^2].
inline double energy_per_mass(const World& world, BodyId i, const State& s) {
  return 0.5 * s.v_WB.squaredNorm() +
         turning_energy(world.inertias[i], s.X_WB.q, s.w_WB) / world.bodies[i].mass;
}
/// The same of a hoop that rolls at a speed: nothing that rolls or is thrown turns with more.
inline double hoop_energy(double speed) {
  return speed * speed;
}

/// Overlap that is deep for two bodies: a fiftieth of the smaller one [m].
inline double deep_for(const World& world, BodyId a, BodyId b) {
  return 0.02 *
         std::min(world.bodies[a].shape->bounding_radius, world.bodies[b].shape->bounding_radius);
}

}  // namespace headpin::engine::detail
