#pragma once

#include "engine/world.h"

/// Functions on a world's bodies that all parts of a step use. Private to the engine.
namespace headpin::engine::detail {

/// Largest gap at which one body counts as resting on another [m].
inline constexpr double kRests = 1e-4;

/// Sets kind and sleep of a body. All such changes go through here, because the `Roll` must then be
/// made again.
void become(World& world, BodyId i, Kind kind, bool asleep);

/// Number and name of a body, for messages.
std::string title(const World& world, BodyId i);

/// Whether a body is free and awake, so that forces move it.
inline bool is_mover(const World& world, BodyId i) {
  return world.bodies[i].kind == Kind::free && world.asleep[i] == 0;
}

/// Kinetic energy of a body, per mass [m^2/s^2].
inline double energy_per_mass(const World& world, BodyId i, const State& s) {
  return 0.5 * s.v_WB.squaredNorm() +
         turning_energy(world.inertias[i], s.X_WB.q, s.w_WB) / world.bodies[i].mass;
}
/// The same for a hoop that rolls at a speed. No body that rolls or is thrown has more rotational
/// energy at that speed.
inline double hoop_energy(double speed) {
  return speed * speed;
}

/// Overlap that counts as deep for two bodies: 2 % of the smaller bounding radius [m].
inline double deep_for(const World& world, BodyId a, BodyId b) {
  return 0.02 *
         std::min(world.bodies[a].shape->bounding_radius, world.bodies[b].shape->bounding_radius);
}

}  // namespace headpin::engine::detail
