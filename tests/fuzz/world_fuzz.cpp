#include <cmath>
#include <cstdio>
#include <stdexcept>

#include <fuzzer/FuzzedDataProvider.h>

#include "engine/world.h"

using namespace headpin;
using namespace headpin::engine;

namespace {

constexpr double kHalf = 2.0;  // of the closed room [m]

/// A fuzzed world: a room, bodies of any shape in it, and what is done to them.
class Case {
 public:
  Case(const std::uint8_t* data, std::size_t size) : bytes_(data, size) {
    const int rates[] = {60, 120, 240, 480, 1000};
    world_ = make_world({.rate_hz = bytes_.PickValueInArray(rates),
                         .response = bytes_.ConsumeBool() ? "paper" : "coulomb",
                         .keep_ledger = true});
  }

  void run() {
    build_room();
    const int bodies = bytes_.ConsumeIntegralInRange(1, 10);
    for (int k = 0; k < bodies; ++k) add();
    const int steps = bytes_.ConsumeIntegralInRange(10, 240);
    for (int k = 0; k < steps; ++k) {
      if (bytes_.remaining_bytes() > 0 && bytes_.ConsumeIntegralInRange(0, 15) == 0) meddle();
      step(world_);
      check();
    }
  }

 private:
  double between(double low, double high) { return bytes_.ConsumeFloatingPointInRange(low, high); }
  Vec3 vector(double most) {
    return {between(-most, most), between(-most, most), between(-most, most)};
  }
  Quat turn() { return rotation(vector(3.0)); }

  Shape shape(double size) {
    const double a = size * between(0.1, 1.0), b = size * between(0.1, 1.0);
    switch (bytes_.ConsumeIntegralInRange(0, 3)) {
      case 0:
        return Ellipsoid{{a, b, size}};
      case 1:
        return Cylinder{a, b};
      case 2:
        return Cone{a, b};
      default: {
        std::vector<Vec3> corners;
        for (int k = 0; k < 8; ++k) {
          corners.emplace_back(k & 1 ? a : -a, k & 2 ? b : -b, k & 4 ? size : -size);
        }
        return Polyhedron(
            corners,
            {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}});
      }
    }
  }

  void build_room() {
    for (int side = 0; side < 6; ++side) {
      Body wall;
      wall.name = "wall";
      wall.shape = make_compound({{HalfSpace{}, Pose{}}});
      wall.kind = Kind::fixed;
      wall.material = {1.0, 1.0};
      const double sign = side % 2 ? -1.0 : 1.0;
      const Vec3 inward = sign * Vec3::Unit(side / 2);
      State s;
      s.X_WB = {Quat::FromTwoVectors(Vec3::UnitZ(), inward), -kHalf * inward};
      add_body(world_, wall, s);
    }
  }

  void add() {
    Body body;
    const double size = std::pow(10.0, between(-1.7, -0.5));
    std::vector<Part> parts{{shape(size), Pose{}}};
    if (bytes_.ConsumeBool()) {  // a second beside or in it: channels, dumb-bells
      parts.push_back({shape(size), {turn(), vector(1.5 * size)}});
    }
    const int kind = bytes_.ConsumeIntegralInRange(0, 7);
    body.kind = kind == 0 ? Kind::fixed : kind == 1 ? Kind::driven : Kind::free;
    if (body.kind == Kind::fixed && bytes_.ConsumeBool()) {  // a thin plate
      parts = {{Cylinder{10.0 * size, 0.001}, Pose{}}};
    }
    body.material = {between(0.0, 1.0), between(0.0, 1.0)};
    if (bytes_.ConsumeBool()) body.material.rolling_arm = 0.01;
    body.shape = make_compound(parts);
    MassProperties m;
    for (const Part& part : parts) {  // of its parts, wherever they overlap: any body is allowed
      const MassProperties one = mass_properties(part.shape, 1000.0);
      m.mass += one.mass;
      m.inertia += one.inertia + one.mass * (part.X_BG.p.squaredNorm() * Mat3::Identity());
    }
    const double heavier = std::pow(10.0, between(-1.5, 1.5));
    body.mass = std::max(1e-6, heavier * m.mass);
    body.inertia = body.mass / m.mass * 0.5 * (m.inertia + m.inertia.transpose());
    State s;
    s.X_WB = {turn(), vector(kHalf - 0.5)};
    if (body.kind != Kind::fixed) {
      s.v_WB = vector(body.kind == Kind::driven ? 1.0 : 12.0);
      s.w_WB = vector(body.kind == Kind::driven ? 3.0 : 60.0);
    }
    driven_ = driven_ || body.kind == Kind::driven;
    try {
      add_body(world_, body, s);
    } catch (const std::invalid_argument&) {
      // It would lie deep in another, or is too light: refused, as promised.
    }
  }

  void meddle() {
    const auto i = bytes_.ConsumeIntegralInRange<BodyId>(
        6, static_cast<BodyId>(std::max<std::size_t>(6, world_.bodies.size() - 1)));
    if (i >= world_.bodies.size() || world_.bodies[i].kind == Kind::fixed) return;
    switch (bytes_.ConsumeIntegralInRange(0, 4)) {
      case 0: {
        State s;
        s.X_WB = {turn(), vector(kHalf - 0.7)};
        s.v_WB = vector(3.0);
        set_state(world_, i, s);
        meddled_ = true;
        break;
      }
      case 1:
        wake(world_, i);
        break;
      case 2:
        if (world_.bodies[i].kind == Kind::free) put_to_sleep(world_, i);
        break;
      default:
        set_kind(world_, i, bytes_.ConsumeBool() ? Kind::driven : Kind::free);
        driven_ = true;
    }
  }

  void check() {
    const Ledger& l = world_.ledger;
    scale_ = std::max(scale_, world_.memory.balance.energy + height_energy());
    if (l.impact.energy > 1e-9 * scale_) fail("impacts gain energy [J]", l.impact.energy);
    // What is carried gains the fall of a step, which its contacts take away again.
    const double gain = l.gravity.energy + l.sustained.energy;
    if (gain > 1e-3 * scale_) fail("free motion and contacts gain energy [J]", gain);
    if (driven_ || meddled_) return;  // a hand may push a body through a wall
    for (BodyId i = 0; i < world_.bodies.size(); ++i) {
      const double out = world_.states[i].X_WB.p.cwiseAbs().maxCoeff() - kHalf;
      // A thin one that turns by half a radian a step goes some millimetres into what it lies on.
      if (world_.bodies[i].kind == Kind::free &&
          out > 0.1 * world_.bodies[i].shape->bounding_radius) {
        fail("a body left the room [m]", out);
      }
    }
  }

  /// What the free bodies would give up by falling from the middle of the room to its floor [J].
  double height_energy() const {
    double sum = 0.0;
    for (const Body& body : world_.bodies) {
      if (body.kind == Kind::free) sum += body.mass * 9.81 * kHalf;
    }
    return sum;
  }

  [[noreturn]] void fail(const char* what, double much) {
    char text[200];
    std::snprintf(text, sizeof text, "tick %lld of %d Hz, %s: %s %g of %g",
                  static_cast<long long>(world_.tick), world_.parameters.rate_hz,
                  world_.parameters.response.data(), what, much, scale_);
    throw std::runtime_error(text);
  }

  FuzzedDataProvider bytes_;
  World world_;
  bool driven_ = false, meddled_ = false;
  double scale_ = 1e-3;  // of the energies that went in [J]
};

}  // namespace

// Whatever stands, flies or is moved about in a room: it stays finite (a step that does not
// throws), stays inside, and no account of the ledger gains energy but the hand's. What breaks that
// is thrown, which ends a fuzzer and is counted by worlds_check.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Case(data, size).run();
  return 0;
}
