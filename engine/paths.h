#pragma once

#include "engine/bodies.h"
#include "engine/workspace.h"

/// Paths of bodies within a step, from one impact to the next. Private to the engine.
namespace headpin::engine::detail {

/// Turn within a step after which a contact may have other points [rad].
inline constexpr double kFarTurn = 0.2;

/// Makes the list of bodies that take part, if it is out of date. @return whether it was made
bool know_roll(World& world);

/// Prepares `w.flight` with all bodies at the start of the step.
void depart(World& world, Workspace& w);

/// Calls `f(i)` for each body that is free and awake, by as many threads as the world has: it changes that body
/// alone.
template <typename F>
void each_mover(const World& world, Workspace& w, F&& f) {
  const std::vector<BodyId>& movers = world.roll.movers;
  w.crew.share_range(movers.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) f(movers[k]);
  });
}

/// Sets the bounds on the present speed of the body's points.
inline void note_speed(const World& world, Flight& flight, BodyId i) {
  const State& s = world.states[i];
  Flyer& flyer = flight.bodies[i];
  flyer.spin_speed = s.w_WB.norm() * world.bodies[i].shape->bounding_radius;
  flyer.top_speed = s.v_WB.norm() + flyer.spin_speed;
}

/// Acceleration of a body by gravity on its way to the next impact [m/s^2].
inline Vec3 pull_on(const World& world, const Flight& flight, BodyId i) {
  return flight.bodies[i].falls ? world.parameters.gravity_W : Vec3::Zero();
}
inline Vec3 position_at(const World& world, const Flight& flight, BodyId i, double t) {
  const State& s = world.states[i];
  const double passed = t - flight.bodies[i].clock;
  if (passed == 0.0) return s.X_WB.p;
  return s.X_WB.p + passed * s.v_WB + 0.5 * passed * passed * pull_on(world, flight, i);
}

/// State of a body at time `t` of the step on its present path; exact if nothing touches it.
State state_at(const World& world, const Flight& flight, BodyId i, double t);

/// Bodies that approach faster than this are followed to where they meet within the step: impacts,
/// and lasting contacts that would become deep before the end of the step.
inline double followed_speed(const World& world, const Flight& flight, BodyId a, BodyId b) {
  return std::min(flight.lasting_speed, deep_for(world, a, b) * world.parameters.rate_hz);
}

}  // namespace headpin::engine::detail
