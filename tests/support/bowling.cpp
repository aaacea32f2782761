#include "tests/support/bowling.h"

#include <cmath>

namespace headpin::engine {

Compound skittle_shape() {
  const auto at = [](double height) {
    return Pose{Quat::Identity(), Vec3(0.0, 0.0, height - kSkittleHeight)};
  };
  return make_compound({{Cylinder{kBaseRadius, 0.03}, at(0.03)},
                        {Ellipsoid{{0.0605, 0.0605, 0.110}}, at(0.116)},
                        {Cylinder{0.0235, 0.08}, at(0.26)},
                        {Ellipsoid{{0.0325, 0.0325, 0.0325}}, at(0.3485)}});
}

Compound floor_shape() {
  return make_compound({{HalfSpace{}, Pose{}}});
}

Compound sphere_shape(double radius) {
  return make_compound({{Ellipsoid{Vec3::Constant(radius)}, Pose{}}});
}

Body skittle_body(const Material& material) {
  return {.name = "skittle",
          .shape = skittle_shape(),
          .mass = 1.5,
          .inertia = Vec3(0.0145, 0.0145, 0.0021).asDiagonal(),
          .material = material,
          .kind = Kind::free};
}

Body ball_body(const Material& material, double radius, double mass) {
  return {.name = "ball",
          .shape = sphere_shape(radius),
          .mass = mass,
          .inertia = 0.4 * mass * radius * radius * Mat3::Identity(),
          .material = material,
          .kind = Kind::free};
}

Body floor_body(const Material& material) {
  return {.name = "lane",
          .shape = floor_shape(),
          .mass = 1.0,
          .inertia = Mat3::Identity(),
          .material = material,
          .kind = Kind::fixed};
}

Body solid(const Shape& shape, const Material& material, std::optional<double> mass) {
  Body body;
  body.shape = make_compound({{shape, Pose{}}});
  const MassProperties m = mass_properties(*body.shape, 1000.0);
  body.mass = mass.value_or(m.mass);
  body.inertia = body.mass / m.mass * m.inertia;
  body.material = material;
  return body;
}

State at(const Pose& X_WB, const Vec3& v_WB, const Vec3& w_WB) {
  return {X_WB, v_WB, w_WB};
}

State at(const Vec3& p_WB, const Vec3& v_WB, const Vec3& w_WB) {
  return at(Pose{Quat::Identity(), p_WB}, v_WB, w_WB);
}

Bowling bowling(const RackOptions& o) {
  Bowling b;
  b.world = make_world(o.parameters);
  b.lane = add_body(b.world, floor_body(o.material));
  Material heavy = o.material;
  heavy.rolling_arm = 0.008;
  const Body skittle = skittle_body(heavy);
  const int across = static_cast<int>(std::ceil(std::sqrt(o.racks)));
  for (int rack = 0; rack < o.racks; ++rack) {
    const Vec3 origin(4.0 * (rack % across), 8.0 * (rack / across), 0.0);
    for (int row = 0; row < 4; ++row) {
      for (int k = 0; k <= row; ++k) {
        const Vec3 spot(kSpacing * (k - 0.5 * row), kSpacing * 0.5 * std::sqrt(3.0) * row,
                        kSkittleHeight);
        b.skittles.push_back(add_body(b.world, skittle, at(origin + spot)));
      }
    }
    if (!o.ball) continue;
    b.balls.push_back(
        add_body(b.world, ball_body(o.material),
                 at(origin + Vec3(o.ball_offset, -o.ball_distance, kBallRadius),
                    Vec3(0.0, o.ball_speed, 0.0), Vec3(-o.ball_speed / kBallRadius, 0.0, 0.0))));
  }
  return b;
}

int skittles_down(const Bowling& b, int rack) {
  int down = 0;
  for (std::size_t k = 0; k < 10; ++k) {
    const State& s = b.world.states[b.skittles[static_cast<std::size_t>(rack) * 10 + k]];
    down += upright(s) < std::cos(30.0 * 3.14159265358979 / 180.0) || s.X_WB.p.z() < 0.0;
  }
  return down;
}

void run(World& world, double seconds) {
  Workspace workspace;
  run(world, workspace, seconds);
}

void run(World& world, Workspace& workspace, double seconds) {
  const std::int64_t end = world.tick + std::llround(seconds * world.parameters.rate_hz);
  while (world.tick < end) step(world, workspace);
}

double upright(const State& state) {
  return (state.X_WB.q * Vec3::UnitZ()).z();
}

}  // namespace headpin::engine
