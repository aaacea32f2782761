#include "scene/looks/eyes.h"

#include <algorithm>
#include <cmath>

#include "render/display.h"

namespace headpin::scene {

namespace {

/// The distance between opposite corners of the room, and a little more for objects behind its
/// walls: how far an eye in it sees, and an eye in it is from the world's origin at most [m].
double farthest_seen(const Room& room) {
  return 1.0 + std::hypot(room.width, room.height, room.behind + room.ahead);
}

/// The views that are drawn for these views.
std::array<render::View, 2> drawn_views_of(const Eyes& eyes,
                                           const std::array<render::View, 2>& views) {
  return {render::drawn_view(views[0], eyes.optics), render::drawn_view(views[1], eyes.optics)};
}

/// How far a camera with the optics of the scenario's display is from a rectangle that it shows [m].
double distance_to_show(const Scenario& scenario, double width, double height) {
  const render::Frustum f = render::eyes({}, scenario.hmd.optics)[0].frustum;
  const double across = std::min(-f.left, f.right), down = std::min(-f.bottom, f.top);
  constexpr double kMargin = 1.05;
  return kMargin * std::max(0.5 * width / across, 0.5 * height / down);
}

}  // namespace

Eyes open_eyes(const Stage& stage) {
  return open_eyes(stage, stage.scenario.look);
}

Eyes open_eyes(const Stage& stage, const render::Quality& look, std::string_view gl) {
  render::Renderer renderer(render::open_context(gl), look);
  Looks looks(renderer, stage);
  render::Optics optics = stage.scenario.hmd.optics;
  optics.far = std::max(optics.far, looks.room_reach + farthest_seen(stage.scenario.room));
  return {std::move(renderer), std::move(looks), optics};
}

Pose looking_at(const Vec3& p_WC, const Vec3& target_W) {
  const Vec3 back = (p_WC - target_W).normalized();
  const Vec3 right = Vec3::UnitZ().cross(back).normalized();
  Eigen::Matrix3d R_WC;
  R_WC << right, back.cross(right), back;
  return {Quat(R_WC), p_WC};
}

Pose third_person_camera(const Scenario& scenario) {
  const Room& room = scenario.room;
  constexpr double kFromWalls = 0.3;
  const Vec3 p(-std::min(1.5, 0.5 * room.width - kFromWalls),
               -std::min(2.6, room.behind - kFromWalls), std::min(2.3, room.height - kFromWalls));
  return looking_at(p, Vec3(0.15, 2.0, 0.6));
}

Pose top_camera(const Scenario& scenario) {
  const Room& room = scenario.room;
  Eigen::Matrix3d R_WC;
  R_WC << Vec3::UnitY(), -Vec3::UnitX(), Vec3::UnitZ();
  return {Quat(R_WC), Vec3(0.0, 0.5 * (room.ahead - room.behind),
                           distance_to_show(scenario, room.behind + room.ahead, room.width))};
}

Pose side_camera(const Scenario& scenario) {
  const Room& room = scenario.room;
  Eigen::Matrix3d R_WC;
  R_WC << Vec3::UnitY(), Vec3::UnitZ(), Vec3::UnitX();
  return {Quat(R_WC), Vec3(distance_to_show(scenario, room.behind + room.ahead, room.height),
                           0.5 * (room.ahead - room.behind), 0.5 * room.height)};
}

std::array<render::View, 2> views_of(const Eyes& eyes, const Glimpse& g) {
  if (!g.X_WC) return render::eyes(g.X_WD, eyes.optics);
  render::Optics optics = eyes.optics;
  optics.outward_deg = 0.0;        // both pictures of a camera look where it looks
  optics.far += g.X_WC->p.norm();  // it may be farther away than a head
  return render::eyes(*g.X_WC, optics);
}

render::DrawList list_of(const Eyes& eyes, const Glimpse& g) {
  return draw_list(eyes.looks, g);
}

std::array<render::View, 2> see(Eyes& eyes, const Glimpse& g, std::array<render::Image, 2>& out) {
  const std::array<render::View, 2> views = views_of(eyes, g);
  const render::DrawList list = list_of(eyes, g);
  if (render::is_plain(eyes.optics)) {
    eyes.renderer.draw(list, views, out);
    return views;
  }
  const std::array<render::View, 2> drawn_views = drawn_views_of(eyes, views);
  std::array<render::Image, 2> drawn;
  eyes.renderer.draw(list, drawn_views, drawn);
  for (std::size_t eye = 0; eye < 2; ++eye) {
    out[eye] = render::on_display(drawn[eye], views[eye], eyes.optics);
  }
  return views;
}

std::array<render::Labels, 2> see_labels(Eyes& eyes, const Glimpse& g) {
  const std::array<render::View, 2> views = views_of(eyes, g);
  const render::DrawList list = list_of(eyes, g);
  const std::array<render::View, 2> pictures = drawn_views_of(eyes, views);
  std::array<render::Labels, 2> out;
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const render::View drawn = render::label_view(views[eye], eyes.optics);
    out[eye] =
        render::on_display(eyes.renderer.labels(list, drawn, pictures), views[eye], eyes.optics);
  }
  return out;
}

}  // namespace headpin::scene
