#include <cstdio>

#include "engine/workspace.h"
#include "engine/world.h"

using namespace headpin;
using namespace headpin::engine;

int main() {
  World world = make_world({.rate_hz = 240});
  const double r = 0.1085, m = 6.8;  // of a bowling ball [m, kg]
  add_body(world,
           {.name = "lane", .shape = make_compound({{HalfSpace{}, Pose{}}}), .kind = Kind::fixed});
  const BodyId ball = add_body(world,
                               {.name = "ball",
                                .shape = make_compound({{Ellipsoid{{r, r, r}}, Pose{}}}),
                                .mass = m,
                                .inertia = 0.4 * m * r * r * Mat3::Identity()},
                               {.X_WB = {Quat::Identity(), {0, 0, 1}}, .v_WB = {0, 5, 0}});
  Workspace workspace;  // of the steps
  while (world.tick < 2 * 240) {
    step(world, workspace);
    for (const ContactEvent& e : world.events) {
      if (e.first)
        std::printf("lands after %.3f s at %.2f m/s\n", world.tick / 240.0, e.approach_speed);
    }
  }
  const State& s = world.states[ball];
  std::printf("after 2 s: %.2f m down the lane, %.2f m/s\n", s.X_WB.p.y(), s.v_WB.norm());
  return s.X_WB.p.z() > 0.1 && s.v_WB.y() > 3.0 ? 0 : 1;
}
