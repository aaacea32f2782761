#include "engine/paths.h"

#include <limits>

#include "engine/rules.h"
#include "engine/seams.h"

namespace headpin::engine::detail {
namespace {

/// @param shape  with a half-space
Plane surface_of(const Compound& shape, const Pose& X_WB) {
  if (shape.parts.size() > 1) return {Vec3::Zero(), std::numeric_limits<double>::infinity()};
  const Pose X_WG = X_WB * shape.parts[0].X_BG;
  const Vec3 up = z_axis(X_WG.q);
  return {up, up.dot(X_WG.p)};
}

/// Lists the bodies that take part in a step, and their bounds.
void call_roll(World& world) {
  Roll& roll = world.roll;
  roll.movers.clear();
  roll.driven.clear();
  roll.unbounded.clear();
  roll.bounded.clear();
  roll.bounds_W.clear();
  roll.moving.clear();
  roll.limits_W.clear();
  roll.planes_W.clear();
  for (BodyId i = 0; i < world.bodies.size(); ++i) {
    const Body& body = world.bodies[i];
    const bool driven = body.kind == Kind::driven, free = is_mover(world, i);
    if (driven) roll.driven.push_back(i);
    if (free) roll.movers.push_back(i);
    if (!std::isfinite(body.shape->bounding_radius)) {
      roll.unbounded.push_back(i);
      roll.planes_W.push_back(surface_of(*body.shape, world.states[i].X_WB));
      continue;
    }
    roll.bounded.push_back(i);
    roll.moving.push_back(free || driven);
    roll.bounds_W.push_back(world.states[i].X_WB * body.shape->bounds);
    if (!bounds_flat_bodies(world.parameters)) continue;
    const bool flat = body.kind == Kind::fixed && body.shape->faceted;
    roll.limits_W.push_back(flat ? world.states[i].X_WB * body.shape->box : Box{});
  }
  roll.made = true;
}

}  // namespace

bool know_roll(World& world) {
  if (world.roll.made) return false;
  call_roll(world);
  return true;
}

void depart(World& world, Workspace& w) {
  Flight& flight = w.flight;
  know_roll(world);
  know_seams(world);
  const Parameters& p = world.parameters;
  const double dt = step_seconds(world), g = p.gravity_W.norm();
  flight.lasting_speed = std::max(p.impact_speed, 2.5 * g * dt);  // above gravity's part in a step
  flight.fall = g * dt * dt;
  flight.struck.clear();
  flight.touches.clear();
  flight.bodies.assign(world.bodies.size(), {});
  flight.mobility.resize(world.bodies.size());
  each_mover(world, w, [&](BodyId i) {
    flight.mobility[i] = {1.0 / world.bodies[i].mass,
                          inverse_inertia(world.inertias[i], world.states[i].X_WB.q)};
    Flyer& flyer = flight.bodies[i];
    flyer.falls = !world.memory.bodies[i].supported;
    note_speed(world, flight, i);
    flyer.sought = flyer.top_speed * dt;
  });
  for (const BodyId i : world.roll.driven) note_speed(world, flight, i);
}

State state_at(const World& world, const Flight& flight, BodyId i, double t) {
  State s = world.states[i];
  const double passed = t - flight.bodies[i].clock;
  const bool moves = is_mover(world, i) || world.bodies[i].kind == Kind::driven;
  if (passed == 0.0 || !moves) return s;
  s.X_WB.p = position_at(world, flight, i, t);
  s.v_WB += passed * pull_on(world, flight, i);
  if (world.bodies[i].kind == Kind::free) {
    turn_freely(s.X_WB.q, s.w_WB, world.inertias[i], passed);
  } else {
    s.X_WB.q = (rotation(passed * s.w_WB) * s.X_WB.q).normalized();
  }
  return s;
}

}  // namespace headpin::engine::detail
