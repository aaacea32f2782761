#include "scene/eyes.h"

#include <algorithm>
#include <cmath>

#include "render/display.h"

namespace headpin::scene {

namespace {

/// From one corner of the room to the opposite one, and a little for what is behind its walls.
double farthest_seen(const Room& room) {
  return 1.0 + std::hypot(room.width, room.height, room.behind + room.ahead);
}

render::DrawList list_of(const Eyes& eyes, const Glimpse& g) {
  return draw_list(eyes.looks, {.X_WB_skittles = g.X_WB_skittles,
                                .ellipsoids = g.ellipsoids,
                                .skittle_centre = g.skittle_centre,
                                .X_WB_balls = g.X_WB_balls,
                                .X_WH = g.X_WH,
                                .grips = g.grips,
                                .X_WD = g.X_WC ? std::optional(g.X_WD) : std::nullopt});
}

/// Of the head, or of the camera, which may be farther away.
std::array<render::View, 2> views_of(const Eyes& eyes, const Glimpse& g) {
  if (!g.X_WC) return render::eyes(g.X_WD, eyes.optics);
  render::Optics optics = eyes.optics;
  optics.far += g.X_WC->p.norm();
  return render::eyes(*g.X_WC, optics);
}

Pose looking_at(const Vec3& p_WC, const Vec3& target_W) {
  const Vec3 back = (p_WC - target_W).normalized();
  const Vec3 right = Vec3::UnitZ().cross(back).normalized();
  Eigen::Matrix3d R_WC;
  R_WC << right, back.cross(right), back;
  return {Quat(R_WC), p_WC};
}

}  // namespace

Eyes open_eyes(const Stage& stage) {
  return open_eyes(stage, stage.scenario.look);
}

Eyes open_eyes(const Stage& stage, const render::Quality& look, std::string_view gl) {
  render::Renderer renderer(render::open_context(gl), look);
  Looks looks(renderer, stage);
  render::Optics optics = stage.scenario.hmd.optics;
  optics.far = std::max(optics.far, farthest_seen(stage.scenario.room));
  return {std::move(renderer), std::move(looks), optics, look};
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
  const render::Frustum f = render::eyes({}, scenario.hmd.optics)[0].frustum;
  const double across = std::min(-f.left, f.right), down = std::min(-f.bottom, f.top);
  constexpr double kMargin = 1.05;
  const double above =
      kMargin * std::max(0.5 * (room.behind + room.ahead) / across, 0.5 * room.width / down);
  Eigen::Matrix3d R_WC;
  R_WC << Vec3::UnitY(), -Vec3::UnitX(), Vec3::UnitZ();
  return {Quat(R_WC), Vec3(0.0, 0.5 * (room.ahead - room.behind), above)};
}

Glimpse glimpse(const Session& session, const Pose& X_WD) {
  Glimpse g{.X_WD = X_WD,
            .ellipsoids = session.scenario().skittle.seen == "collider" &&
                          session.scenario().collision.shape == "ellipsoid",
            .skittle_centre = session.stage->skittle_centre,
            .X_WH = hand_pose(session),
            .grips = session.player.held.has_value()};
  const auto poses_of = [&](const std::vector<engine::BodyId>& bodies, std::vector<Pose>& poses) {
    for (const engine::BodyId body : bodies) poses.push_back(session.world.states[body].X_WB);
  };
  poses_of(session.stage->skittles, g.X_WB_skittles);
  poses_of(session.stage->balls, g.X_WB_balls);
  return g;
}

void BetweenTicks::keep(const Session& session) {
  stage_ = session.stage;
  time_ = session.now();
  seen_ = scene::glimpse(session, {});
  states_ = session.world.states;
}

Glimpse BetweenTicks::glimpse(const Session& session, Time at, const Pose& X_WD) const {
  Glimpse now = scene::glimpse(session, X_WD);
  if (!stage_ || at >= session.now()) return now;
  if (stage_ != session.stage) {  // another version's world begins with the tick
    now = seen_;
    now.X_WD = X_WD;
    return now;
  }
  const double dt = seconds(session.now() - time_);
  const double s = seconds(at - time_) / dt;
  const auto mix = [&](const std::vector<engine::BodyId>& bodies, const std::vector<Pose>& before,
                       std::vector<Pose>& poses) {
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const double speed =
          states_[bodies[i]].v_WB.norm() + session.world.states[bodies[i]].v_WB.norm();
      constexpr double kPushed = 0.02;  // by what overlapped it, or by the hand that carries it [m]
      const bool moved = (poses[i].p - before[i].p).norm() <= speed * dt + kPushed;
      poses[i] = moved ? interpolate(before[i], poses[i], s) : before[i];
    }
  };
  mix(session.stage->skittles, seen_.X_WB_skittles, now.X_WB_skittles);
  mix(session.stage->balls, seen_.X_WB_balls, now.X_WB_balls);
  if (now.X_WH && seen_.X_WH) now.X_WH = interpolate(*seen_.X_WH, *now.X_WH, s);
  return now;
}

std::array<render::View, 2> see(Eyes& eyes, const Glimpse& g, std::array<render::Image, 2>& out) {
  const std::array<render::View, 2> views = views_of(eyes, g);
  const render::DrawList list = list_of(eyes, g);
  if (render::is_plain(eyes.optics)) {
    eyes.renderer.draw(list, views, out);
    return views;
  }
  std::array<render::View, 2> drawn_views;
  for (std::size_t eye = 0; eye < 2; ++eye) {
    drawn_views[eye] = render::drawn_view(views[eye], eyes.optics);
  }
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
  std::array<render::Labels, 2> out;
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const render::View drawn = render::label_view(views[eye], eyes.optics);
    out[eye] = render::on_display(eyes.renderer.labels(list, drawn), views[eye], eyes.optics);
  }
  return out;
}

}  // namespace headpin::scene
