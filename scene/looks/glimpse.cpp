#include "scene/looks/glimpse.h"

#include <algorithm>
#include <cmath>

#include "scene/looks/score_board.h"

namespace headpin::scene {

namespace {

double closed_hand(const Session& session) {
  const Player& player = session.player;
  if (!player.grip_changed) return 0.0;
  return how_closed(player.held.has_value(), seconds(session.now() - *player.grip_changed));
}

/// The rings of oil that the last throw left on its ball.
void add_rings(const Session& session, Glimpse& g) {
  if (!session.game.ringed) return;
  const RingedBall& ringed = *session.game.ringed;
  const std::vector<engine::BodyId>& balls = session.stage->balls;
  g.ringed = static_cast<std::size_t>(std::ranges::find(balls, ringed.body) - balls.begin());
  const double radius = session.scenario().ball.radius;
  for (const OilRing& ring : ringed.rings) {
    g.X_BG_rings.push_back(
        {Quat::FromTwoVectors(Vec3::UnitZ(), ring.n_B), radius * ring.height * ring.n_B});
  }
}

}  // namespace

double how_closed(bool holds, double since) {
  constexpr double kTakes = 0.1;  // [s]
  const double share = std::clamp(since / kTakes, 0.0, 1.0);
  return holds ? share : 1.0 - share;
}

bool shows_ellipsoids(const Scenario& scenario) {
  return scenario.skittle.seen == SeenSkittle::collider &&
         scenario.collision.shape == SkittleShape::ellipsoid;
}

Glimpse glimpse(const Session& session, const Pose& X_WD) {
  Glimpse g{.X_WD = X_WD,
            .ellipsoids = shows_ellipsoids(session.scenario()),
            .skittle_centre = session.stage->skittle_centre,
            .X_WH = hand_pose(session),
            .closed = closed_hand(session),
            .board = board_text(session)};
  const auto poses_of = [&](const std::vector<engine::BodyId>& bodies, std::vector<Pose>& poses) {
    for (const engine::BodyId body : bodies) poses.push_back(session.world.states[body].X_WB);
  };
  poses_of(session.stage->skittles, g.X_WB_skittles);
  poses_of(session.stage->balls, g.X_WB_balls);
  add_rings(session, g);
  return g;
}

double ring_radius(double ball_radius, const Pose& X_BG) {
  return std::sqrt(std::max(0.0, ball_radius * ball_radius - X_BG.p.squaredNorm()));
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
  if (stage_ != session.stage) {  // the world of another version begins with this tick
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
      constexpr double kPushed = 0.02;  // limit of a push by an overlap or by the carrying hand [m]
      const bool moved = (poses[i].p - before[i].p).norm() <= speed * dt + kPushed;
      poses[i] = moved ? interpolate(before[i], poses[i], s) : before[i];
    }
  };
  mix(session.stage->skittles, seen_.X_WB_skittles, now.X_WB_skittles);
  mix(session.stage->balls, seen_.X_WB_balls, now.X_WB_balls);
  now.board = seen_.board;
  now.closed = seen_.closed + s * (now.closed - seen_.closed);
  if (now.X_WH && seen_.X_WH) now.X_WH = interpolate(*seen_.X_WH, *now.X_WH, s);
  return now;
}

}  // namespace headpin::scene
