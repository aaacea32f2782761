#include "scene/spectator.h"

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

Spectator make_spectator(const Scenario& scenario, const render::Quality& quality) {
  render::Renderer renderer(render::osmesa_context(), quality);
  Looks looks(renderer, scenario, centre_height(scenario));
  return {std::move(renderer), std::move(looks), optics(scenario.hmd)};
}

Glimpse glimpse(const Session& session, const Pose& X_WD) {
  Glimpse g{.X_WD = X_WD,
            .X_WB_skittles = {},
            .ellipsoids = session.scenario.collision.shape == "ellipsoid",
            .X_WB_ball = session.world.states[session.ball].X_WB,
            .X_WH = hand_pose(session),
            .grips = session.player.grips};
  for (std::size_t i = session.first_skittle; i < session.world.states.size(); ++i) {
    g.X_WB_skittles.push_back(session.world.states[i].X_WB);
  }
  return g;
}

std::array<render::View, 2> see(Spectator& spectator, const Glimpse& g,
                                std::array<render::Image, 2>& out) {
  const std::array<render::View, 2> views = render::eyes(g.X_WD, spectator.optics);
  const Moving moving{.X_WB_skittles = g.X_WB_skittles,
                      .ellipsoids = g.ellipsoids,
                      .X_WB_ball = g.X_WB_ball,
                      .X_WH = g.X_WH,
                      .grips = g.grips};
  spectator.renderer.draw(draw_list(spectator.looks, moving), views, out);
  return views;
}

}  // namespace headpin::scene
