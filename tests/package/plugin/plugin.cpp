// What another program loads while it runs: it has the engine in it, or beside it.
#include "engine/world.h"

using namespace headpin;
using namespace headpin::engine;

/// Height of a ball of 10 cm, `ticks` ticks after it was let go 1 m above a floor [m].
extern "C" double height_of_a_ball(int ticks) {
  World world = make_world({.rate_hz = 240});
  const double r = 0.1, m = 6.0;  // [m, kg]
  add_body(world,
           {.name = "floor", .shape = make_compound({{HalfSpace{}, Pose{}}}), .kind = Kind::fixed});
  const BodyId ball = add_body(world,
                               {.name = "ball",
                                .shape = make_compound({{Ellipsoid{{r, r, r}}, Pose{}}}),
                                .mass = m,
                                .inertia = 0.4 * m * r * r * Mat3::Identity()},
                               {.X_WB = {Quat::Identity(), {0, 0, 1}}});
  while (world.tick < ticks) step(world);
  return world.states[ball].X_WB.p.z();
}
