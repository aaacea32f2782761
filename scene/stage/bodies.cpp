#include "scene/stage/bodies.h"

#include <algorithm>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

#include "engine/non_colliding.h"
#include "scene/stage/outline.h"
#include "scene/stage/room.h"

namespace headpin::scene {

namespace {

Vec3 z(double height) {
  return {0.0, 0.0, height};
}

engine::Part make_part(const SkittlePart& part) {
  if (part.shape == PartShape::polyhedron)
    return {engine::Polyhedron(part.corners, part.faces), {}};
  const double half = 0.5 * (part.high - part.low);
  const Pose X_BG{Quat::Identity(), z(part.low + half)};
  if (part.shape == PartShape::cylinder) return {engine::Cylinder{part.radius, half}, X_BG};
  if (part.shape == PartShape::cone) return {engine::Cone{part.radius, 2.0 * half}, X_BG};
  return {engine::Ellipsoid{Vec3(part.radius, part.radius, half)}, X_BG};
}

/// Whether two parts overlap by more than the rounding of planes between them.
bool overlap(const engine::Part& a, const engine::Part& b) {
  constexpr double kTouch = 1e-6;  // [m]
  engine::KeptNormal n;
  const Pose X_AB = a.X_BG.inverse() * b.X_BG;
  return engine::closest_points(a.shape, b.shape, X_AB, n, {}).distance < -kTouch;
}

/// Whether all parts are convex pieces of one mesh file. Pieces of one shell touch and do not overlap;
/// shells may.
engine::Overlaps overlaps_of(const std::vector<SkittlePart>& parts,
                             const engine::Compound& compound) {
  const auto is_piece = [&](const SkittlePart& part) {
    return part.shape == PartShape::polyhedron && !part.mesh.file.empty() &&
           part.mesh.file == parts[0].mesh.file && part.mesh.sha256 == parts[0].mesh.sha256;
  };
  if (!std::all_of(parts.begin(), parts.end(), is_piece)) return engine::Overlaps::maybe;
  for (std::size_t i = 0; i < compound.parts.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (overlap(compound.parts[i], compound.parts[j])) return engine::Overlaps::maybe;
    }
  }
  return engine::Overlaps::none;
}

/// Rules 1 to 13 weighed parts that overlap by even rods, which missed thin parts.
engine::Rods rods_of(const Scenario& scenario) {
  return scenario.collision.rules < 14 ? engine::Rods::even : engine::Rods::between_bends;
}

/// Mass properties of the skittle: from its outline, its parts, or its one ellipsoid.
engine::MassProperties skittle_mass(const Scenario& scenario, const engine::Compound& shape) {
  const Skittle& skittle = scenario.skittle;
  const auto of_parts = [&](const engine::Compound& parts) {
    const engine::Overlaps overlaps = overlaps_of(skittle.parts, parts);
    const engine::Rods rods = rods_of(scenario);
    const double volume = engine::mass_properties(parts, 1.0, overlaps, rods).mass;
    return engine::mass_properties(parts, skittle.mass / volume, overlaps, rods);
  };
  const bool is_ellipsoid = scenario.collision.shape == SkittleShape::ellipsoid;
  if (is_ellipsoid && skittle.ellipsoid_weighed == WeighedEllipsoid::itself) return of_parts(shape);
  if (skittle.weighed == Weighed::profile) {
    return turned_mass(smooth_outline(skittle.profile), skittle.mass);
  }
  return of_parts(is_ellipsoid ? skittle_shape(skittle, SkittleShape::parts) : shape);
}

/// Rules 1 to 8 turned a skittle until its principal axes were those of the world. Its mesh then collided otherwise than
/// it stood in its file and was drawn.
bool turns_skittles(const Scenario& scenario) {
  return scenario.collision.rules < 9;
}

/// @param p_BG  the origin of the parts' old frame in their new one
engine::Compound moved(const engine::Compound& shape, const Vec3& p_BG) {
  std::vector<engine::Part> parts = shape.parts;
  for (engine::Part& part : parts) part.X_BG.p += p_BG;
  return engine::make_compound(std::move(parts));
}

engine::Material surface(const Coefficients& material, double rolling_arm = 0.0) {
  return {material.elasticity, material.friction, rolling_arm};
}

/// A box about the origin.
engine::Polyhedron box(const Vec3& half) {
  std::vector<Vec3> corners;
  corners.reserve(8);
  for (int i = 0; i < 8; ++i) {
    corners.emplace_back(i & 1 ? half.x() : -half.x(), i & 2 ? half.y() : -half.y(),
                         i & 4 ? half.z() : -half.z());
  }
  return {corners,
          {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
}

/// A prism along y, about its middle.
engine::Part prism(const Slab& slab) {
  const auto n = static_cast<std::uint32_t>(slab.section.size());
  const double half = 0.5 * (slab.end - slab.begin);
  Vec2 low = slab.section[0], high = low;
  for (const Vec2& p : slab.section) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const Vec2 middle = 0.5 * (low + high);
  std::vector<Vec3> corners;
  std::vector<std::vector<std::uint32_t>> faces(2);
  for (const double y : {-half, half}) {
    for (const Vec2& p : slab.section)
      corners.emplace_back(p.x() - middle.x(), y, p.y() - middle.y());
  }
  for (std::uint32_t i = 0; i < n; ++i) {  // the section is counterclockwise, seen by the player
    const std::uint32_t next = (i + 1) % n;
    faces[0].push_back(i);
    faces[1].push_back(2 * n - 1 - i);
    faces.push_back({i, i + n, next + n, next});
  }
  return {engine::Polyhedron(corners, faces),
          {Quat::Identity(), Vec3(middle.x(), slab.begin + half, middle.y())}};
}

/// The areas of an oiled lane: the oil, then the whole lane before the skittles, which is dry where
/// there is no oil.
std::vector<engine::FrictionArea> areas_of_lane(const RoomMeasures& room) {
  std::vector<engine::FrictionArea> areas;
  for (const OiledArea& oil : room.oil) areas.push_back({oil.low, oil.high, oil.friction});
  if (areas.empty()) return areas;
  const double half = 0.5 * room.lane_width;
  areas.push_back({{-half, 0.0}, {half, room.deck_begin()}, room.dry});
  return areas;
}

/// About the centre, along the axes of B [kg m^2]. Radii of gyration are smallest about the pin axis
/// and largest across it and the mass bias (USBC, Equipment Specifications Manual).
Mat3 ball_inertia(const Ball& ball) {
  if (ball.rg == 0.0) {
    return Vec3::Constant(0.4 * ball.mass * ball.radius * ball.radius).asDiagonal();
  }
  const double largest = ball.rg + ball.differential;
  const Vec3 radii(ball.rg, largest, largest - ball.intermediate);
  Mat3 axes;  // pin, across both, mass bias
  axes.col(0) = ball.pin.normalized();
  axes.col(1) = ball.mass_bias.cross(axes.col(0)).normalized();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return axes * (ball.mass * radii.cwiseAbs2()).asDiagonal() * axes.transpose();
}

}  // namespace

engine::Compound skittle_shape(const Skittle& skittle, SkittleShape shape) {
  if (shape == SkittleShape::ellipsoid) {
    double radius = 0.0;
    for (const SkittlePart& part : skittle.parts) radius = std::max(radius, part.radius);
    const double half = 0.5 * skittle.height;
    return engine::make_compound(
        {{engine::Ellipsoid{Vec3(radius, radius, half)}, {Quat::Identity(), z(half)}}});
  }
  std::vector<engine::Part> parts;
  for (const SkittlePart& part : skittle.parts) parts.push_back(make_part(part));
  return engine::make_compound(std::move(parts));
}

SkittleBody skittle_body(const Scenario& scenario) {
  const engine::Compound shape = skittle_shape(scenario.skittle, scenario.collision.shape);
  const engine::MassProperties mass = skittle_mass(scenario, shape);
  const engine::Centred centred = engine::about_centre(shape, mass);
  constexpr double kBeside = 1e-3;  // [m]
  const double off = centred.X_BC.p.head<2>().norm();
  if (off > kBeside) {
    throw std::invalid_argument(fmt::format(
        "skittle.parts have their centre of mass {:.4g} m beside the axis, expected within {:g}; "
        "move the mesh so that its axis is at x = 0, y = 0, or weigh the profile "
        "(skittle.weighed). A hollow mesh is weighed as the convex pieces that it is cut into, which "
        "may be lopsided",
        off, kBeside));
  }
  constexpr double kUpright = 1e-3;  // [1]
  const double tilt = (centred.X_BC.q * Vec3::UnitZ() - Vec3::UnitZ()).norm();
  if (turns_skittles(scenario) && tilt > kUpright) {
    throw std::invalid_argument(fmt::format(
        "skittle.parts have a principal axis {:.4g} rad from the vertical, expected within {:g} with "
        "collision.rules 1 to 8, which turn it upright; 9 does not",
        tilt, kUpright));
  }
  SkittleBody skittle{
      {.name = std::string(kSkittleName),
       .shape = centred.compound,
       .mass = centred.mass,
       .inertia = centred.inertia.asDiagonal(),
       .material = surface(scenario.material.skittle, scenario.skittle.rolling_arm)},
      centred.X_BC.p.z()};
  const bool is_turned = centred.X_BC.q.w() != 1.0;
  if (is_turned && !turns_skittles(scenario)) {
    skittle.body.shape = moved(shape, -centred.X_BC.p);
    skittle.body.inertia = mass.inertia;
  }
  return skittle;
}

engine::Body ball_body(const Scenario& scenario) {
  const Ball& ball = scenario.ball;
  return {.name = std::string(kBallName),
          .shape = engine::make_compound({{engine::Ellipsoid{Vec3::Constant(ball.radius)}, {}}}),
          .mass = ball.mass,
          .inertia = ball_inertia(ball),
          .material = surface(scenario.material.ball)};
}

engine::Body hand_body(const Scenario& scenario) {
  const auto part = [](const Vec3& p_HG, const Vec3& radii) {
    return engine::Part{engine::Ellipsoid{radii}, {Quat::Identity(), p_HG}};
  };
  return {.name = std::string(kHandName),
          .shape = engine::make_compound({part({0.0, 0.0, -0.005}, {0.042, 0.016, 0.050}),
                                          part({-0.020, 0.0, -0.085}, {0.020, 0.010, 0.042}),
                                          part({0.020, 0.0, -0.080}, {0.020, 0.010, 0.038}),
                                          part({-0.052, 0.0, -0.015}, {0.014, 0.012, 0.034})}),
          .material = surface({scenario.hand.elasticity, scenario.hand.friction}),
          .kind = engine::Kind::driven};
}

std::vector<Fixture> room_fixtures(const Scenario& scenario) {
  const Room& room = scenario.room;
  const Materials& m = scenario.material;
  const double quarter = 0.5 * std::numbers::pi;
  std::vector<Fixture> fixtures;
  const auto add_parts = [&](const char* name, Role role, std::vector<engine::Part> parts,
                             const Pose& X_WB) {
    fixtures.push_back({role,
                        {.name = name,
                         .shape = engine::make_compound(std::move(parts)),
                         .material = surface(role == Role::lane ? m.lane : m.wall),
                         .kind = engine::Kind::fixed,
                         .exact = true},
                        X_WB});
  };
  const auto add = [&](const char* name, Role role, const engine::Shape& shape, const Pose& X_WB) {
    add_parts(name, role, {{shape, {}}}, X_WB);
  };
  const auto add_plane = [&](const char* name, Role role, const Vec3& turn, const Vec3& p_WB) {
    add(name, role, engine::HalfSpace{}, {rotation(turn), p_WB});
  };
  // A half-space is solid below its own z = 0, so its z is turned into the room.
  const RoomMeasures measures = room_measures(scenario);
  if (measures.gutter_depth == 0.0) {
    add_plane("lane", Role::lane, Vec3::Zero(), Vec3::Zero());
  } else {
    for (const Floor& floor : floors(measures)) {
      std::vector<engine::Part> parts;
      for (const Slab& slab : floor.slabs) parts.push_back(prism(slab));
      add_parts(floor.name, Role::lane, std::move(parts), {});
    }
    add_plane("gutters", Role::lane, Vec3::Zero(), {0.0, 0.0, -measures.gutter_depth});
  }
  fixtures.front().body.areas = areas_of_lane(measures);  // its frame is the world's
  add_plane("left wall", Role::wall, {0.0, quarter, 0.0}, {-0.5 * room.width, 0.0, 0.0});
  add_plane("right wall", Role::wall, {0.0, -quarter, 0.0}, {0.5 * room.width, 0.0, 0.0});
  add_plane("wall behind", Role::wall, {-quarter, 0.0, 0.0}, {0.0, -room.behind, 0.0});
  add_plane("wall ahead", Role::wall, {quarter, 0.0, 0.0}, {0.0, room.ahead, 0.0});
  if (room.solid_ceiling) {
    add_plane("ceiling", Role::wall, {2.0 * quarter, 0.0, 0.0}, {0.0, 0.0, room.height});
  }

  for (const Block& block : front_blocks(measures)) {
    add(block.name, Role::wall, box(0.5 * (block.high_W - block.low_W)),
        {Quat::Identity(), 0.5 * (block.low_W + block.high_W)});
  }
  return fixtures;
}

engine::Parameters world_parameters(const Scenario& scenario) {
  const Collision& c = scenario.collision;
  engine::Parameters p;
  p.rate_hz = static_cast<int>(scenario.rates.physics_hz);
  p.gravity_W = Vec3(0.0, 0.0, -c.gravity);
  p.response = engine::response_named(c.response).name;
  p.query.mode = c.detection;
  p.query.cap = static_cast<int>(c.iterations);
  p.query.warm = c.warm;
  p.query.last = c.answer == PlaneAtCap::last;
  p.friction_tau = c.friction_tau_s;
  p.sleep = c.sleep;
  p.rules = static_cast<int>(c.rules);
  p.keep_ledger = true;
  return p;
}

}  // namespace headpin::scene
