#include <gtest/gtest.h>

#include "engine/world.h"
#include "tests/support/random_shapes.h"

namespace headpin::engine {
namespace {

World floor_at_60_hz(std::string_view response) {
  World world = make_world({.rate_hz = 60, .response = response, .keep_ledger = true});
  Body floor;
  floor.shape = make_compound({{HalfSpace{}, Pose{}}});
  floor.material = {1.0, 1.0};
  floor.kind = Kind::fixed;
  add_body(world, floor);
  return world;
}

Vec3 vector(test::Random& random, double most) {
  return {random.uniform(-most, most), random.uniform(-most, most), random.uniform(-most, most)};
}

Body body_of(const Shape& shape, double mass, const Material& material) {
  Body body;
  body.shape = make_compound({{shape, Pose{}}});
  const MassProperties m = mass_properties(shape, 1000.0);
  body.mass = mass > 0.0 ? mass : m.mass;
  body.inertia = body.mass / m.mass * m.inertia;
  body.material = material;
  return body;
}

/// A box of 0.4 g under two that are up to 30 kg and come down on it from both sides.
World wedge(std::uint64_t seed) {
  test::Random random(seed);
  World world = floor_at_60_hz("coulomb");
  const auto add = [&](double size, double mass, State at, double speed) {
    const Vec3 half = size * Vec3{random.uniform(0.1, 1.0), random.uniform(0.1, 1.0), 1.0};
    at.X_WB.q = random.rotation();
    at.v_WB += vector(random, speed);
    at.w_WB = vector(random, 10.0);
    add_body(world, body_of(test::box(half), mass, {random.uniform(0.0, 1.0), 1.0}), at);
  };
  add(0.03, 4e-4, {{Quat::Identity(), {0.0, 0.0, 0.05}}}, 1.0);
  for (const double side : {-1.0, 1.0}) {
    const Vec3 p{side * 0.3, random.uniform(-0.1, 0.1), random.uniform(0.3, 0.5)};
    add(0.15, std::pow(10.0, random.uniform(-1.0, 1.5)),
        {{Quat::Identity(), p}, Vec3(-2.0 * side, 0.0, 0.0)}, 0.5);
  }
  return world;
}

// Friction brings load and load friction: passes over such islands may run away.
TEST(LightBodyBetweenHeavyOnes, GainsNothingThoughItsContactsAreNotSolved) {
  double left = 0.0;  // largest change of a last pass [m/s]
  for (std::uint64_t seed = 100; seed < 150; ++seed) {
    World world = wedge(seed);
    const double start = balance(world).energy;
    for (int k = 0; k < 90; ++k) {
      step(world);
      left = std::max(left, world.statistics.residual);
      const double energy = balance(world).energy - world.ledger.correction.energy;
      ASSERT_LE(energy, start * (1.0 + 1e-6)) << "seed " << seed << " tick " << world.tick;
    }
  }
  EXPECT_GT(left, 0.01);  // or nothing was tried
}

/// How far an ellipsoid reaches below z = 0 [m].
double depth_of(const Ellipsoid& shape, const Pose& X_WB) {
  const Vec3 up_B = X_WB.q.conjugate() * Vec3::UnitZ();
  return shape.radii.cwiseProduct(up_B).norm() - X_WB.p.z();
}

// It rocks faster than the step can follow: the point that carries it at the step's start is not
// the one that goes deep at its end.
TEST(ThinEllipsoid, FallsFlatWithoutSinkingIntoTheFloor) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    test::Random random(seed);
    const double radius = 0.024;
    const Ellipsoid shape{
        {radius, radius * random.uniform(0.1, 1.0), radius * random.uniform(0.1, 0.15)}};
    World world = floor_at_60_hz(seed % 2 == 0 ? "paper" : "coulomb");
    State s;
    s.X_WB = {rotation(vector(random, 0.5)), {0.0, 0.0, 0.03}};
    s.v_WB = vector(random, 0.3);
    s.w_WB = vector(random, 10.0);
    const Material material{random.uniform(0.0, 1.0), random.uniform(0.0, 1.0)};
    const BodyId i = add_body(world, body_of(shape, 0.0, material), s);
    double deepest = 0.0;
    for (int k = 0; k < 120; ++k) {
      step(world);
      deepest = std::max(deepest, depth_of(shape, world.states[i].X_WB));
    }
    ASSERT_LE(deepest, radius / 3.0) << "seed " << seed;
    ASSERT_LE(depth_of(shape, world.states[i].X_WB), radius / 5.0) << "seed " << seed;
  }
}

/// A box of 2 kg that stands 5 mm before a wall, and a driven sphere that presses it against that.
struct Pressed {
  World world;
  BodyId box = 0, hand = 0;
};

Pressed pressed(double speed, double off, int rate_hz, std::string_view response) {
  Pressed p{make_world({.rate_hz = rate_hz, .response = response, .keep_ledger = true})};
  const Material material{0.7, 0.7};
  Body wall;
  wall.shape = make_compound({{HalfSpace{}, Pose{}}});
  wall.material = material;
  wall.kind = Kind::fixed;
  add_body(p.world, wall);
  add_body(p.world, wall, {{Quat::FromTwoVectors(Vec3::UnitZ(), -Vec3::UnitX()), {0.3, 0.0, 0.0}}});
  p.box = add_body(p.world, body_of(test::box({0.1, 0.1, 0.1}), 2.0, material),
                   {{Quat::Identity(), {0.195, 0.0, 0.1}}});
  Body hand = body_of(Ellipsoid{{0.05, 0.05, 0.05}}, 1.0, material);
  hand.kind = Kind::driven;
  p.hand =
      add_body(p.world, hand, {{Quat::Identity(), {0.025, off, 0.1 + off}}, {speed, 0.0, 0.0}});
  return p;
}

// What is driven insists for two seconds or through the box; then it stands still.
TEST(BoxBetweenHandAndWall, GetsNoFasterThanTheHandWouldThrowIt) {
  for (const std::string_view response : {"paper", "coulomb"}) {
    for (const int rate : {60, 120, 240, 480, 1000}) {
      for (const double speed : {0.05, 1.0}) {
        for (const double off : {0.0, 0.03}) {
          Pressed p = pressed(speed, off, rate, response);
          double fastest = 0.0, deepest = 0.0;
          for (int k = 0; k < 3 * rate; ++k) {
            if (k == 2 * rate || p.world.states[p.hand].X_WB.p.x() > 0.3) {
              p.world.states[p.hand].v_WB.setZero();
            }
            step(p.world);
            if (k < 2 * rate) fastest = std::max(fastest, p.world.states[p.box].v_WB.norm());
            deepest = std::max(deepest, p.world.statistics.deepest_overlap);
          }
          const std::string what = std::string(response) + " " + std::to_string(rate) + " Hz, " +
                                   std::to_string(speed) + " m/s, off by " + std::to_string(off);
          EXPECT_LE(fastest, 2.0 * speed) << what;
          EXPECT_GT(deepest, 0.02) << what;  // or nothing was squeezed
          EXPECT_LE(p.world.ledger.sustained.energy, 1e-9) << what;
        }
      }
    }
  }
}

}  // namespace
}  // namespace headpin::engine
