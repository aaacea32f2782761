#include "scene/watch/viewer.h"

namespace headpin::scene {

namespace {

using devices::ViewerGeometry;

const Vec3 kWood(0.80, 0.62, 0.38), kDark(0.10, 0.14, 0.25), kBlue(0.13, 0.30, 0.72),
    kIvory(0.95, 0.93, 0.88), kSkin(0.85, 0.62, 0.50);

std::vector<float> floats(const Vec3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

Vec3 colour_of(Role role) {
  switch (role) {
    case Role::lane:
      return kWood;
    case Role::wall:
      return kDark;
    case Role::ball:
      return kBlue;
    case Role::skittle:
      return kIvory;
    case Role::hand:
      return kSkin;
  }
  return kDark;
}

// What a shape looks like in its own frame G; an overload for each, so that a new one is asked for.

ViewerGeometry looks_of(const engine::Ellipsoid& e) {
  return {.type = ViewerGeometry::ellipsoid, .X_BG = {}, .measures = floats(e.radii)};
}

ViewerGeometry looks_of(const engine::Cylinder& c) {
  return {.type = ViewerGeometry::cylinder,
          .X_BG = {},
          .measures = {static_cast<float>(c.radius), static_cast<float>(2.0 * c.half_height)}};
}

/// A cylinder of half its radius: the viewer has no cones.
ViewerGeometry looks_of(const engine::Cone& c) {
  return {.type = ViewerGeometry::cylinder,
          .X_BG = {},
          .measures = {static_cast<float>(0.5 * c.radius), static_cast<float>(c.height)}};
}

/// The box around it.
ViewerGeometry looks_of(const engine::Polyhedron& polyhedron) {
  Eigen::AlignedBox3d box;
  for (const Vec3& vertex : polyhedron.vertices()) box.extend(vertex);
  return {.X_BG = {Quat::Identity(), box.center()}, .measures = floats(box.sizes())};
}

/// Nothing: whoever looks must see past floors and walls.
ViewerGeometry looks_of(const engine::HalfSpace&) {
  return {.X_BG = {}, .measures = floats(Vec3::Zero())};
}

ViewerGeometry geometry_of(const engine::Part& part, const Vec3& colour) {
  ViewerGeometry g = std::visit([](const auto& shape) { return looks_of(shape); }, part.shape);
  g.X_BG = part.X_BG * g.X_BG;
  g.colour = colour;
  return g;
}

/// Not floors and walls; and lane and hand are shown whatever bodies they are.
bool is_shown(const Session& session, engine::BodyId body) {
  const Role role = session.stage->roles[body];
  return std::isfinite(session.world.bodies[body].shape->bounding_radius) && role != Role::lane &&
         role != Role::hand;
}

}  // namespace

std::vector<devices::ViewerLink> viewer_links(const Session& session) {
  const Scenario& s = session.scenario();
  const double length = s.room.ahead + s.room.behind;
  std::vector<devices::ViewerLink> links;
  links.push_back(
      {"lane",
       {{.type = ViewerGeometry::box,
         .X_BG = {Quat::Identity(), Vec3(0.0, 0.5 * (s.room.ahead - s.room.behind), -0.01)},
         .measures = floats(Vec3(s.lane.width, length, 0.02)),
         .colour = kWood}}});
  for (engine::BodyId i = 0; i < session.world.bodies.size(); ++i) {
    const engine::Body& body = session.world.bodies[i];
    if (!is_shown(session, i)) continue;
    const Vec3 colour = colour_of(session.stage->roles[i]);
    devices::ViewerLink link{body.name, {}};
    for (const engine::Part& part : body.shape->parts)
      link.geometries.push_back(geometry_of(part, colour));
    links.push_back(std::move(link));
  }
  links.push_back({"head",
                   {{.type = ViewerGeometry::box,
                     .X_BG = {},
                     .measures = {0.18F, 0.10F, 0.12F},
                     .colour = kDark}}});
  links.push_back({"hand",
                   {{.type = ViewerGeometry::box,
                     .X_BG = {},
                     .measures = {0.09F, 0.03F, 0.18F},
                     .colour = kSkin}}});
  return links;
}

std::vector<devices::ViewerPose> viewer_poses(const Session& session) {
  std::vector<devices::ViewerPose> poses{{"lane", {}}};
  for (std::size_t i = 0; i < session.world.bodies.size(); ++i) {
    if (!is_shown(session, static_cast<engine::BodyId>(i))) continue;
    const engine::Body& body = session.world.bodies[i];
    poses.push_back({body.name, session.world.states[i].X_WB});
  }
  poses.push_back({"head", head_pose(session).value_or(Pose{})});
  poses.push_back({"hand", hand_pose(session).value_or(Pose{})});
  return poses;
}

}  // namespace headpin::scene
