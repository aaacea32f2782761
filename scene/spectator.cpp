#include "scene/spectator.h"

#include <vector>

#include "scene/bodies.h"

namespace headpin::scene {

render::Optics optics(const Hmd& hmd) {
  render::Optics o;
  o.width = static_cast<int>(hmd.width);
  o.height = static_cast<int>(hmd.height);
  o.horizontal_fov_deg = hmd.horizontal_fov_deg;
  o.vertical_fov_deg = hmd.vertical_fov_deg;
  o.eye_distance = hmd.eye_distance;
  o.outward_deg = hmd.outward_deg;
  return o;
}

Spectator make_spectator(const Scenario& scenario) {
  render::Renderer renderer(render::osmesa_context());
  Looks looks(renderer, scenario, centre_height(scenario));
  return {std::move(renderer), std::move(looks), optics(scenario.hmd)};
}

std::array<render::View, 2> see(Spectator& spectator, const Session& session, const Pose& X_WD,
                                std::array<render::Image, 2>& out) {
  std::vector<Pose> X_WB_skittles;
  for (std::size_t i = session.first_skittle; i < session.world.states.size(); ++i) {
    X_WB_skittles.push_back(session.world.states[i].X_WB);
  }
  const Moving moving{.X_WB_skittles = X_WB_skittles,
                      .ellipsoids = session.scenario.collision.shape == "ellipsoid",
                      .X_WB_ball = session.world.states[session.ball].X_WB,
                      .X_WH = hand_pose(session),
                      .grips = session.player.grips};
  const std::array<render::View, 2> views = render::eyes(X_WD, spectator.optics);
  spectator.renderer.draw(draw_list(spectator.looks, moving), views, out);
  return views;
}

}  // namespace headpin::scene
