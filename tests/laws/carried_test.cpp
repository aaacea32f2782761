#include <gtest/gtest.h>

#include "tests/support/bowling.h"
#include "tests/support/random_shapes.h"

namespace headpin::engine {
namespace {

/// A driven plate whose upper side is at z = 0 at the start, and what stands on it.
struct Carried {
  World world;
  BodyId plate = 0;
  std::vector<BodyId> bodies = {};
  Workspace workspace = {};
};

Carried on_plate(const Parameters& parameters, double elasticity) {
  Carried c{make_world(parameters)};
  Body plate = ball_body({elasticity, 0.9});
  plate.shape = make_compound({{test::box({3.0, 3.0, 0.05}), Pose{}}});
  plate.kind = Kind::driven;
  c.plate = add_body(c.world, plate, at(Vec3(0.0, 0.0, -0.05)));
  return c;
}

Body box_of(double elasticity) {
  return solid(test::box({0.1, 0.1, 0.1}), Material{elasticity, 0.9}, 2.0);
}

/// The plate is accelerated for a time.
void accelerate(Carried& c, const Vec3& a, double seconds) {
  const double dt = 1.0 / c.world.parameters.rate_hz;
  const std::int64_t end = c.world.tick + std::llround(seconds / dt);
  while (c.world.tick < end) {
    c.world.states[c.plate].v_WB += dt * a;
    step(c.world, c.workspace);
  }
}

Vec3 place_on_plate(const Carried& c, BodyId i) {
  return c.world.states[i].X_WB.p - c.world.states[c.plate].X_WB.p;
}

// A body of no elasticity has the speed of a throw when it is carried.
TEST(ALift, CarriesWhatStandsOnIt) {
  for (const std::string_view response : {"paper", "coulomb"}) {
    for (const double elasticity : {0.0, 0.01}) {
      for (const double a : {0.2, 3.0}) {
        for (const int rate : {60, 240}) {
          Carried c = on_plate({.rate_hz = rate, .response = response}, elasticity);
          const Body box = box_of(elasticity);
          const BodyId lower = add_body(c.world, box, at(Vec3(0.0, 0.0, 0.1)));
          const BodyId upper = add_body(c.world, box, at(Vec3(0.0, 0.0, 0.3)));
          accelerate(c, a * Vec3::UnitZ(), 2.0);
          EXPECT_NEAR(place_on_plate(c, lower).z(), 0.15, 1e-4) << response << a << " " << rate;
          EXPECT_NEAR(place_on_plate(c, upper).z(), 0.35, 2e-4) << response << a << " " << rate;
          EXPECT_NEAR(c.world.states[upper].v_WB.z(), 2.0 * a, 1e-4) << response << a;
        }
      }
    }
  }
}

// Coulomb's friction of 0.81 carries what is accelerated by less than 0.81 g.
TEST(ACart, TakesAlongWhatStandsOnIt) {
  for (const double elasticity : {0.0, 0.01}) {
    for (const double a : {0.5, 3.0}) {
      Carried c = on_plate({.rate_hz = 240, .response = "coulomb"}, elasticity);
      const BodyId box = add_body(c.world, box_of(elasticity), at(Vec3(0.0, 0.0, 0.1)));
      accelerate(c, a * Vec3::UnitX(), 2.0);
      EXPECT_NEAR(c.world.states[box].v_WB.x(), 2.0 * a, 1e-5) << elasticity << " " << a;
      EXPECT_NEAR(place_on_plate(c, box).x(), 0.0, 1e-4) << elasticity << " " << a;
      EXPECT_NEAR(place_on_plate(c, box).z(), 0.15, 1e-4) << elasticity << " " << a;
    }
  }
}

// Only twist takes coaxial discs along, from each to the next.
TEST(AStackOfDiscs, TurnsWithItsTurntable) {
  for (const int count : {5, 10}) {
    Carried c = on_plate({.rate_hz = 240, .response = "coulomb", .sleep = false}, 0.0);
    const Body disc = solid(Cylinder{0.1, 0.01}, Material{0.0, 0.9}, 0.5);
    for (int k = 0; k < count; ++k) {
      c.bodies.push_back(add_body(c.world, disc, at(Vec3(0.0, 0.0, 0.01 + 0.02 * k))));
    }
    const double turns = 3.0;  // [rad/s]
    for (int k = 1; k <= 480; ++k) {
      c.world.states[c.plate].w_WB.z() = turns * std::min(1.0, k / 240.0);
      step(c.world, c.workspace);
      const double now = c.world.states[c.plate].w_WB.z();
      for (const BodyId i : c.bodies) {
        ASSERT_NEAR(c.world.states[i].w_WB.z(), now, 1e-4) << count << " at tick " << k;
      }
    }
    EXPECT_NEAR(place_on_plate(c, c.bodies.back()).head<2>().norm(), 0.0, 1e-6);
  }
}

}  // namespace
}  // namespace headpin::engine
