#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "engine/free_motion.h"
#include "engine/world.h"
#include "tests/support/bowling.h"
#include "tests/support/random_shapes.h"

// A body stands on a floor or a block, and a driven sphere (a hand) presses it down, then stops. What
// energy the body has then: of motion and of height, less what pushing overlaps apart lifted it by.
//
//   squeeze_check [EVERY]   each EVERY-th of 13,824 cases; all if not said
//
// Prints, for each body and elasticity, the largest speed that this energy is worth, as a share of what
// may be. While the hand moves that is the speed of a hoop that the hand throws (tests/laws/README.md),
// or, for a ball beside whose middle it comes down, that of a ball under a wedge. After it has stopped
// it is what was there before. An elastic body may be thrown twice before it gets away: there half as
// much again is allowed. Exit code 1 when a body has more.
namespace {

using namespace headpin;
using namespace headpin::engine;

constexpr double kHand = 0.05;  // radius [m]

struct Pressed {
  Shape shape;
  Vec3 up_B = Vec3::UnitZ();  // this axis of the body points up
  double height = 0.0;        // of its centre [m]
  const char* name = "";
};

struct Case {
  Pressed body;
  double off = 0.0;  // of the hand from the line through its centre [m]
  double speed = 0.0, elasticity = 0.0, friction = 0.0, gravity = 0.0;
  bool block = false;  // not a half-space but a box, 0.2 m thick
  std::string_view response;
  int rate = 0;
};

Body body_of(const Shape& shape, const Material& material, Kind kind) {
  Body body = solid(shape, material, 2.0);
  body.kind = kind;
  return body;
}

struct Scene {
  World world;
  BodyId body = 0, hand = 0;
};

Scene scene_of(const Case& c) {
  Scene s{make_world({.rate_hz = c.rate,
                      .gravity_W = {0.0, 0.0, -c.gravity},
                      .response = c.response,
                      .keep_ledger = true})};
  const Material material{c.elasticity, c.friction};
  Body base;
  if (c.block) {
    base = body_of(test::box({0.5, 0.5, 0.1}), material, Kind::fixed);
  } else {
    base.shape = make_compound({{HalfSpace{}, Pose{}}});
    base.material = material;
    base.kind = Kind::fixed;
  }
  add_body(s.world, base, {{Quat::Identity(), {0.0, 0.0, c.block ? -0.1 : 0.0}}});
  const Quat q = Quat::FromTwoVectors(c.body.up_B, Vec3::UnitZ());
  s.body = add_body(s.world, body_of(c.body.shape, material, Kind::free),
                    {{q, {0.0, 0.0, c.body.height}}});
  const bool round = std::holds_alternative<Ellipsoid>(c.body.shape);
  const double r = c.body.height + kHand;
  const double above = round ? std::sqrt(r * r - c.off * c.off) : r;
  s.hand = add_body(s.world, body_of(Ellipsoid{{kHand, kHand, kHand}}, material, Kind::driven),
                    {{Quat::Identity(), {c.off, 0.3 * c.off, c.body.height + above + 0.01}},
                     {0.0, 0.0, -c.speed}});
  return s;
}

/// Energy per mass that the body has above the start [m^2/s^2].
double energy(const Case& c, const Scene& s) {
  const State& state = s.world.states[s.body];
  const double turning = turning_energy(s.world.inertias[s.body], state.X_WB.q, state.w_WB);
  const double mass = s.world.bodies[s.body].mass;
  const double lifted = s.world.ledger.correction.energy / mass;
  return 0.5 * state.v_WB.squaredNorm() + turning / mass +
         c.gravity * (state.X_WB.p.z() - c.body.height) - lifted;
}

/// The largest speed that a body may have while the hand moves [m/s].
double allowed(const Case& c) {
  const double hoop = std::sqrt(2.0) * (1.0 + c.elasticity) * c.speed;
  if (!std::holds_alternative<Ellipsoid>(c.body.shape) || c.off <= 0.0) return hoop;
  // The common normal leans by this sine; the ball stays on the floor.
  const double sine = std::hypot(c.off, 0.3 * c.off) / (c.body.height + kHand);
  return std::max(hoop, (1.0 + c.elasticity) * c.speed * std::sqrt(1.0 - sine * sine) / sine);
}

struct Shares {
  double moving = 0.0;   // speed over that which is allowed
  double stopped = 0.0;  // gain after the stop, as a speed over the same
  double deepest = 0.0;
};

Shares press(const Case& c) {
  Scene s = scene_of(c);
  const double most = allowed(c);
  Shares shares;
  const int steps = static_cast<int>(std::min(2.0 * c.body.height / c.speed, 1.5) * c.rate);
  for (int k = 0; k < steps; ++k) {
    step(s.world);
    shares.moving = std::max(shares.moving, std::sqrt(2.0 * std::max(energy(c, s), 0.0)) / most);
    shares.deepest = std::max(shares.deepest, s.world.statistics.deepest_overlap);
  }
  s.world.states[s.hand].v_WB.setZero();
  const double before = energy(c, s);
  for (int k = 0; k < c.rate; ++k) {
    step(s.world);
    const double gain = std::max(energy(c, s) - before, 0.0);
    shares.stopped = std::max(shares.stopped, std::sqrt(2.0 * gain) / most);
  }
  return shares;
}

std::vector<Case> cases() {
  const std::vector<Pressed> bodies{
      {Ellipsoid{{0.108, 0.108, 0.108}}, Vec3::UnitZ(), 0.108, "ball"},
      {test::box({0.1, 0.1, 0.1}), Vec3::UnitZ(), 0.1, "box"},
      {Cylinder{0.06, 0.19}, Vec3::UnitZ(), 0.19, "standing cylinder"},
      {Cylinder{0.06, 0.19}, Vec3::UnitX(), 0.06, "lying cylinder"}};
  std::vector<Case> all;
  for (const Pressed& body : bodies)
    for (const double off : {0.0, 0.006, 0.036})
      for (const double speed : {0.05, 0.3, 1.0, 3.0})
        for (const double e : {0.0, 0.5, 0.7, 1.0})
          for (const double f : {0.0, 0.3, 1.0})
            for (const double g : {0.0, 9.81})
              for (const bool block : {false, true})
                for (const std::string_view response : {"paper", "coulomb"})
                  for (const int rate : {60, 120, 240})
                    all.push_back({body, off, speed, e, f, g, block, response, rate});
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  const std::size_t every = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 1;
  const std::vector<Case> all = cases();
  std::map<std::pair<std::string, double>, Shares> most;
  std::size_t pressed = 0;
  bool too_fast = false;
  for (std::size_t i = 0; i < all.size(); i += every, ++pressed) {
    const Case& c = all[i];
    const Shares s = press(c);
    Shares& of_kind = most[{c.body.name, c.elasticity}];
    of_kind.moving = std::max(of_kind.moving, s.moving);
    of_kind.stopped = std::max(of_kind.stopped, s.stopped);
    of_kind.deepest = std::max(of_kind.deepest, s.deepest);
    if (s.moving <= (c.elasticity < 1.0 ? 1.0 : 1.5) && s.stopped <= 1.0) continue;
    too_fast = true;
    std::printf("too fast: %s, hand %g m beside it at %g m/s, e %g, f %g, g %g, %s, %s, %d Hz\n",
                c.body.name, c.off, c.speed, c.elasticity, c.friction, c.gravity,
                c.block ? "on a block" : "on a floor", c.response.data(), c.rate);
  }
  std::printf("%zu cases\n%-20s%12s%14s%14s%14s\n", pressed, "body", "elasticity", "hand moves",
              "has stopped", "deepest [mm]");
  for (const auto& [kind, s] : most) {
    std::printf("%-20s%12g%14.2f%14.2f%14.1f\n", kind.first.c_str(), kind.second, s.moving,
                s.stopped, 1e3 * s.deepest);
  }
  return too_fast || pressed == 0 ? 1 : 0;
}
