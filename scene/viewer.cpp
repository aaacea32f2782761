#include "scene/viewer.h"

namespace headpin::scene {

namespace {

using devices::ViewerGeometry;

const Vec3 kWood(0.80, 0.62, 0.38), kDark(0.10, 0.14, 0.25), kBlue(0.13, 0.30, 0.72),
    kIvory(0.95, 0.93, 0.88), kSkin(0.85, 0.62, 0.50);

std::vector<float> floats(const Vec3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

ViewerGeometry geometry_of(const engine::Part& part, const Vec3& colour) {
  ViewerGeometry g{.X_BG = part.X_BG, .measures = {}, .colour = colour};
  if (const auto* ellipsoid = std::get_if<engine::Ellipsoid>(&part.shape)) {
    g.type = ViewerGeometry::ellipsoid;
    g.measures = floats(ellipsoid->radii);
  } else if (const auto* cylinder = std::get_if<engine::Cylinder>(&part.shape)) {
    g.type = ViewerGeometry::cylinder;
    g.measures = {static_cast<float>(cylinder->radius),
                  static_cast<float>(2.0 * cylinder->half_height)};
  } else if (const auto* cone = std::get_if<engine::Cone>(&part.shape)) {
    g.type = ViewerGeometry::cylinder;  // the viewer has no cones
    g.measures = {static_cast<float>(0.5 * cone->radius), static_cast<float>(cone->height)};
  } else if (const auto* polyhedron = std::get_if<engine::Polyhedron>(&part.shape)) {
    Eigen::AlignedBox3d box;
    for (const Vec3& vertex : polyhedron->vertices()) box.extend(vertex);
    g.measures = floats(box.sizes());
    g.X_BG.p += g.X_BG.q * box.center();
  }
  return g;
}

}  // namespace

std::vector<devices::ViewerLink> viewer_links(const Session& session) {
  const Scenario& s = session.scenario;
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
    if (!std::isfinite(body.shape->bounding_radius)) continue;  // floor and walls
    const Vec3 colour = i == session.ball ? kBlue : i < session.ball ? kDark : kIvory;
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
    const engine::Body& body = session.world.bodies[i];
    if (!std::isfinite(body.shape->bounding_radius)) continue;
    poses.push_back({body.name, session.world.states[i].X_WB});
  }
  poses.push_back({"head", head_pose(session).value_or(Pose{})});
  poses.push_back({"hand", hand_pose(session).value_or(Pose{})});
  return poses;
}

}  // namespace headpin::scene
