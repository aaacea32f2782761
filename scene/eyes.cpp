#include "scene/eyes.h"

namespace headpin::scene {

Eyes open_eyes(const Stage& stage) {
  render::Renderer renderer(render::osmesa_context(), stage.scenario.look);
  Looks looks(renderer, stage);
  return {std::move(renderer), std::move(looks), stage.scenario.hmd.optics};
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

std::array<render::View, 2> see(Eyes& eyes, const Glimpse& g, std::array<render::Image, 2>& out) {
  const std::array<render::View, 2> views = render::eyes(g.X_WD, eyes.optics);
  const Moving moving{.X_WB_skittles = g.X_WB_skittles,
                      .ellipsoids = g.ellipsoids,
                      .skittle_centre = g.skittle_centre,
                      .X_WB_balls = g.X_WB_balls,
                      .X_WH = g.X_WH,
                      .grips = g.grips};
  eyes.renderer.draw(draw_list(eyes.looks, moving), views, out);
  return views;
}

}  // namespace headpin::scene
