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

// A body that moves along the lift is faster than the lift would throw it.
TEST(ALift, CarriesWhatMovesAlongIt) {
  for (const double elasticity : {0.0, 0.7}) {
    for (const int rate : {60, 240}) {
      Carried c = on_plate({.rate_hz = rate, .response = "coulomb", .sleep = false}, elasticity);
      const Body smooth = solid(test::box({0.1, 0.1, 0.1}), Material{elasticity, 0.0}, 2.0);
      const Body ball = ball_body({elasticity, 0.5});
      const Vec3 v(1.0, 0.0, 0.5);
      const BodyId slides = add_body(c.world, smooth, at(Vec3(-1.0, -1.0, 0.1), v));
      const BodyId rolls = add_body(c.world, ball, at(Vec3(-1.0, 1.0, kBallRadius), v));
      c.world.states[rolls].w_WB.y() = v.x() / kBallRadius;
      c.world.states[c.plate].v_WB.z() = v.z();
      accelerate(c, Vec3::Zero(), 2.0);
      EXPECT_NEAR(place_on_plate(c, slides).z(), 0.15, 1e-4) << elasticity << " " << rate;
      EXPECT_NEAR(place_on_plate(c, rolls).z(), 0.05 + kBallRadius, 1e-4) << elasticity << rate;
      for (const BodyId i : {slides, rolls}) {
        EXPECT_NEAR(c.world.states[i].v_WB.x(), 1.0, 1e-3) << elasticity << " " << rate;
        EXPECT_NEAR(c.world.states[i].v_WB.z(), 0.5, 1e-4) << elasticity << " " << rate;
      }
    }
  }
}

// 48 bricks are a crowd. At 60 Hz its passes converge slowly.
TEST(ALift, CarriesAWallOfBricks) {
  for (const double elasticity : {0.0, 0.5}) {
    Carried c = on_plate({.rate_hz = 60, .response = "coulomb", .sleep = false}, elasticity);
    const Body brick = solid(test::box({0.1, 0.1, 0.05}), Material{elasticity, 0.7}, 1.0);
    for (int k = 0; k < 48; ++k) {
      const int course = k / 8;
      const Vec3 p(0.2001 * (k % 8) + 0.1 * (course % 2) - 0.8, 0.0, 0.05 + 0.1 * course);
      c.bodies.push_back(add_body(c.world, brick, at(p)));
    }
    accelerate(c, 0.1 * Vec3::UnitZ(), 0.5);
    accelerate(c, Vec3::Zero(), 1.5);
    for (const BodyId i : c.bodies) {
      const double high = place_on_plate(c, i).z() - 0.05;  // a multiple of a course, to its middle
      EXPECT_NEAR(std::remainder(high - 0.05, 0.1), 0.0, 1e-3) << elasticity << " " << i;
      EXPECT_NEAR(c.world.states[i].v_WB.z(), 0.05, 1e-2) << elasticity << " " << i;
    }
  }
}

// A heavy free body has the energy to make a light one fast, which a hand presses on it beside the middle.
TEST(BodyBetweenHandAndFreeAnvil, GainsNoMoreEnergyThanAHoopThatTheHandThrows) {
  const Shape shapes[] = {test::box({0.1, 0.1, 0.1}), Cylinder{0.06, 0.1}};
  for (int k = 0; k < 64; ++k) {
    const double mass = k & 1 ? 1e4 : 100.0, elasticity = k & 2 ? 0.7 : 0.0;
    const int rate = k & 4 ? 240 : 60;
    const double speed = k & 8 ? 3.0 : 0.3, aside = k & 32 ? 0.04 : 0.015;
    const Material smooth{elasticity, 0.0};
    World world = make_world({.rate_hz = rate, .gravity_W = Vec3::Zero(), .response = "coulomb"});
    add_body(world, solid(test::box({0.5, 0.5, 0.1}), smooth, mass), at(Vec3(0.0, 0.0, -0.1)));
    const Body body = solid(shapes[k & 16 ? 1 : 0], smooth, 2.0);
    const BodyId pressed = add_body(world, body, at(Vec3(0.0, 0.0, 0.1)));
    Body hand = ball_body(smooth, 0.05, 1.0);
    hand.kind = Kind::driven;
    add_body(world, hand, at(Vec3(aside, 0.3 * aside, 0.253), Vec3(0.0, 0.0, -speed)));
    double most = 0.0;  // energy per mass
    for (double t = 0.0; t < std::min(0.4 / speed, 0.6); t += 1.0 / rate) {
      step(world);
      const State& s = world.states[pressed];
      most = std::max(most, 0.5 * s.v_WB.squaredNorm() +
                                turning_energy(world.inertias[pressed], s.X_WB.q, s.w_WB) / 2.0);
    }
    const double thrown = (1.0 + elasticity) * speed;
    EXPECT_LT(most, 1.03 * thrown * thrown) << k;
  }
}

// Two layers of boxes before a slow plate: it moves them, and does not go into them.
TEST(ASlowPlate, PushesACrowdAlong) {
  World world = make_world({.rate_hz = 60, .response = "coulomb", .sleep = false});
  add_body(world, floor_body({0.0, 0.5}));
  Body plate = solid(test::box({0.05, 2.0, 0.3}), Material{0.0, 0.5}, 1.0);
  plate.kind = Kind::driven;
  const Vec3 v(0.05, 0.0, 0.0);
  const BodyId pushes = add_body(world, plate, at(Vec3(-0.051, 0.0, 0.3), v));
  const Body box = solid(test::box({0.1, 0.1, 0.1}), Material{0.0, 0.5}, 1.0);
  for (int k = 0; k < 98; ++k) {
    const int layer = k / 49, row = k / 7 % 7;
    add_body(world, box,
             at(Vec3(0.1 + 0.2 * row + 0.03 * layer, 0.2 * (k % 7 - 3) + 0.02 * layer,
                     0.1 + 0.2 * layer)));
  }
  run(world, 1.0);
  const double face = world.states[pushes].X_WB.p.x() + 0.05;
  for (BodyId i = pushes + 1; i < world.bodies.size(); ++i) {
    EXPECT_GT(world.states[i].X_WB.p.x() - 0.1, face - 1e-3) << i;
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
