#include <algorithm>
#include <cmath>
#include <string>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "engine/world.h"
#include "tests/support/bowling.h"
#include "tests/support/random_shapes.h"
#include "tests/support/scale.h"

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

Vec3 vector(Random& random, double most) {
  return {random.uniform(-most, most), random.uniform(-most, most), random.uniform(-most, most)};
}

/// A box of 0.4 g under two that are up to 30 kg and come down on it from both sides.
World wedge(std::uint64_t seed) {
  Random random(seed);
  World world = floor_at_60_hz("coulomb");
  const auto add = [&](double size, double mass, State at, double speed) {
    const Vec3 half = size * Vec3{random.uniform(0.1, 1.0), random.uniform(0.1, 1.0), 1.0};
    at.X_WB.q = any_rotation(random);
    at.v_WB += vector(random, speed);
    at.w_WB = vector(random, 10.0);
    add_body(world, solid(test::box(half), {random.uniform(0.0, 1.0), 1.0}, mass), at);
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
    Random random(seed);
    const double radius = 0.024;
    const Ellipsoid shape{
        {radius, radius * random.uniform(0.1, 1.0), radius * random.uniform(0.1, 0.15)}};
    World world = floor_at_60_hz(seed % 2 == 0 ? "paper" : "coulomb");
    State s = at(Pose{rotation(vector(random, 0.5)), {0.0, 0.0, 0.03}});
    s.v_WB = vector(random, 0.3);
    s.w_WB = vector(random, 10.0);
    const Material material{random.uniform(0.0, 1.0), random.uniform(0.0, 1.0)};
    const BodyId i = add_body(world, solid(shape, material), s);
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
  p.box = add_body(p.world, solid(test::box({0.1, 0.1, 0.1}), material, 2.0),
                   {{Quat::Identity(), {0.195, 0.0, 0.1}}});
  Body hand = solid(Ellipsoid{{0.05, 0.05, 0.05}}, material, 1.0);
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

/// A body that touches something fixed, and a driven sphere that comes straight at that.
struct Squeezed {
  World world;
  BodyId body = 0, hand = 0;
  double size = 0.0;  // of the body along the way of the hand [m]
};

constexpr double kHand = 0.05;  // radius [m]
const Ellipsoid kBall{{0.108, 0.108, 0.108}};

struct Squeeze {
  Shape shape;
  Vec3 up_B = Vec3::UnitZ();  // this axis of the body points out of what is fixed
  double height = 0.0;        // of its centre above that [m]
  double off = 0.0;           // of the hand from the line through its centre [m]
  double speed = 0.05, elasticity = 0.0, friction = 0.0;
  Vec3 gravity_W = Vec3::Zero();
  bool block = false;  // not a half-space but a box, 0.2 m thick
};

Squeezed squeezed(const Squeeze& c, int rate_hz, std::string_view response) {
  Squeezed p{make_world(
      {.rate_hz = rate_hz, .gravity_W = c.gravity_W, .response = response, .keep_ledger = true})};
  const Material material{c.elasticity, c.friction};
  Body base = c.block ? solid(test::box({0.5, 0.5, 0.1}), material, 1.0) : Body{};
  if (!c.block) base.shape = make_compound({{HalfSpace{}, Pose{}}});
  base.material = material;
  base.kind = Kind::fixed;
  add_body(p.world, base, {{Quat::Identity(), {0.0, 0.0, c.block ? -0.1 : 0.0}}});
  const Quat q = Quat::FromTwoVectors(c.up_B, Vec3::UnitZ());
  p.body = add_body(p.world, solid(c.shape, material, 2.0), {{q, {0.0, 0.0, c.height}}});
  const bool round = std::holds_alternative<Ellipsoid>(c.shape);
  const double r = c.height + kHand;
  const double above = round ? std::sqrt(r * r - c.off * c.off) : r;
  Body hand = solid(Ellipsoid{{kHand, kHand, kHand}}, material, 1.0);
  hand.kind = Kind::driven;
  p.hand = add_body(
      p.world, hand,
      {{Quat::Identity(), {c.off, 0.3 * c.off, c.height + above + 0.01}}, {0.0, 0.0, -c.speed}});
  p.size = 2.0 * c.height;
  return p;
}

/// Speed with the energy of motion of all of a body [m/s].
double vigour(const World& world, BodyId i) {
  const State& s = world.states[i];
  const double turning = turning_energy(world.inertias[i], s.X_WB.q, s.w_WB);
  return std::sqrt(s.v_WB.squaredNorm() + 2.0 * turning / world.bodies[i].mass);
}

std::vector<Squeeze> squeezes() {
  std::vector<Squeeze> all;
  const std::vector<Squeeze> bodies{{kBall, Vec3::UnitZ(), 0.108},
                                    {test::box({0.1, 0.1, 0.1}), Vec3::UnitZ(), 0.1},
                                    {Cylinder{0.06, 0.19}, Vec3::UnitZ(), 0.19},
                                    {Cylinder{0.06, 0.19}, Vec3::UnitX(), 0.06}};
  for (Squeeze c : bodies) {
    for (const double off : {0.006, 0.036}) {
      for (const double speed : {0.3, 3.0}) {
        for (const double e : {0.0, 1.0}) {
          for (const double f : {0.0, 1.0}) {
            c.off = off;
            c.speed = speed;
            c.elasticity = e;
            c.friction = f;
            all.push_back(c);
          }
        }
      }
    }
  }
  return all;
}

// Without gravity all energy is from the hand. It may throw a body, to (1 + e) times its speed; what
// is thrown so may roll as well, and nothing that rolls has more energy than a hoop, 1/2 m (2 v^2).
TEST(BodyBetweenHandAndFloor, GainsNoMoreEnergyThanAHoopThatTheHandThrows) {
  double deepest = 0.0;
  for (const Squeeze& c : squeezes()) {
    for (const std::string_view response : {"paper", "coulomb"}) {
      for (const int rate : {120, 240}) {
        if (!kThorough && rate == 240) continue;
        Squeezed p = squeezed(c, rate, response);
        const double thrown = (1.0 + c.elasticity) * c.speed;
        const int steps = static_cast<int>(std::min(p.size / c.speed, 1.5) * rate);
        double most = 0.0;
        for (int k = 0; k < steps; ++k) {
          step(p.world);
          most = std::max(most, vigour(p.world, p.body));
          deepest = std::max(deepest, p.world.statistics.deepest_overlap);
        }
        EXPECT_LE(most, 1.01 * std::sqrt(2.0) * thrown)
            << response << " " << rate << " Hz, height " << c.height << " m, " << c.speed
            << " m/s, off by " << c.off << " m, elasticity " << c.elasticity << ", friction "
            << c.friction;
      }
    }
  }
  EXPECT_GT(deepest, 0.05);  // or nothing was squeezed
}

// The hand's normal n stands at the angle a to the floor's. The edge along which their planes meet
// runs at u = V cot a over the floor, and seen from it neither plane moves along its normal: without
// friction nothing there adds energy. The ball comes at u, so it leaves at most at u: at 2 u over the
// floor, and at u, in touch with both, where nothing is elastic. The angle grows as the ball moves out.
TEST(BallPinchedOffCentre, LeavesNoFasterThanTheWedgeDrivesIt) {
  int left = 0;
  for (const double sine : {0.1, 0.3, 0.6}) {
    for (const double e : {0.0, 0.7, 1.0}) {
      for (const double speed : {0.05, 0.3, 3.0}) {
        for (const int rate : {60, 240, 1000}) {
          Squeeze c{kBall, Vec3::UnitZ(), 0.108};
          c.off = sine * (0.108 + kHand);
          c.speed = speed;
          c.elasticity = e;
          Squeezed p = squeezed(c, rate, "paper");
          const double off = std::hypot(c.off, 0.3 * c.off) / (0.108 + kHand);
          const double u = speed * std::sqrt(1.0 - off * off) / off;
          double fastest = 0.0;
          for (int k = 0; k < std::min(0.2 / speed, 2.0) * rate; ++k) {
            step(p.world);
            fastest = std::max(fastest, p.world.states[p.body].v_WB.norm());
          }
          EXPECT_LE(fastest, 1.01 * std::max(1.0, u / speed) * (1.0 + e * e) * speed)
              << "sine " << sine << ", elasticity " << e << ", " << speed << " m/s, " << rate
              << " Hz";
          left += fastest > speed ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GT(left, 20);  // or nothing was driven out
}

// It is held on both sides and lies on the floor: no push there may stand it up, to fall from there.
TEST(BoxPressedFarIntoABlock, IsPushedApartWithoutSpeedWhenTheHandStops) {
  for (const std::string_view response : {"paper", "coulomb"}) {
    for (const int rate : {60, 240}) {
      for (const double friction : {0.0, 1.0}) {
        Squeeze c{test::box({0.1, 0.1, 0.1}), Vec3::UnitZ(), 0.1};
        c.speed = 0.1;
        c.friction = friction;
        c.block = true;
        c.gravity_W = {9.81, 0.0, 0.0};
        Squeezed p = squeezed(c, rate, response);
        Body floor;
        floor.shape = make_compound({{HalfSpace{}, Pose{}}});
        floor.material = {0.0, friction};
        floor.kind = Kind::fixed;
        add_body(p.world, floor,
                 {{Quat::FromTwoVectors(Vec3::UnitZ(), -Vec3::UnitX()), {0.1, 0.0, 0.0}}});
        for (int k = 0; k < 3 * rate / 2; ++k) step(p.world);
        EXPECT_GT(p.world.statistics.deepest_overlap, 0.05);
        p.world.states[p.hand].v_WB.setZero();
        double fastest = 0.0;
        for (int k = 0; k < 2 * rate; ++k) {
          step(p.world);
          fastest = std::max(fastest, p.world.states[p.body].v_WB.norm());
        }
        EXPECT_LE(fastest, c.speed) << response << " " << rate << " Hz, friction " << friction;
      }
    }
  }
}

}  // namespace
}  // namespace headpin::engine
