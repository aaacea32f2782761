#include <cstdio>

#include "engine/workspace.h"
#include "engine/world.h"

// A ball that falls, rolls and strikes three pins: prints the hash of every tick, for test_engine.py.
using namespace headpin;
using namespace headpin::engine;

int main() {
  World world = make_world({.rate_hz = 240});
  const double r = 0.1085, m = 6.8;  // of a bowling ball [m, kg]
  add_body(world,
           {.name = "lane", .shape = make_compound({{HalfSpace{}, Pose{}}}), .kind = Kind::fixed});
  add_body(world,
           {.name = "ball",
            .shape = make_compound({{Ellipsoid{{r, r, r}}, Pose{}}}),
            .mass = m,
            .inertia = 0.4 * m * r * r * Mat3::Identity()},
           {.X_WB = {Quat::Identity(), {0, 0, 0.5}}, .v_WB = {0, 5, 0}});
  const Compound pin =
      make_compound({{Cylinder{0.06, 0.15}, {Quat::Identity(), {0, 0, -0.04}}},
                     {Ellipsoid{{0.05, 0.05, 0.05}}, {Quat::Identity(), {0, 0, 0.14}}}});
  for (int k = -1; k <= 1; ++k) {
    add_body(world,
             {.name = "pin",
              .shape = pin,
              .mass = 1.5,
              .inertia = Vec3(0.01, 0.01, 0.003).asDiagonal(),
              .material = {0.8, 0.3, 0.0}},
             {.X_WB = {Quat::Identity(), {0.3 * k, 3.0, 0.19}}});
  }
  Workspace workspace;
  while (world.tick < 2 * 240) {
    step(world, workspace);
    std::printf("%016llx\n", static_cast<unsigned long long>(state_hash(world)));
  }
}
