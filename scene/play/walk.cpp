#include "scene/play/walk.h"

#include <algorithm>
#include <cmath>

#include "scene/stage/room.h"

namespace headpin::scene {

namespace {

/// Horizontal direction in which a head looks or a hand points; zero straight up or down.
Vec3 level_ahead(const Pose& X_PX) {
  Vec3 ahead = X_PX.q * -Vec3::UnitZ();
  ahead.z() = 0.0;
  const double length = ahead.norm();
  constexpr double kStraightUp = 1e-3;
  return length < kStraightUp ? Vec3::Zero() : Vec3(ahead / length);
}

/// How far the head is inside a forbidden area, seen from above [m].
double depth(const Vec3& p_WD, const Scenario& scenario) {
  const Room& room = scenario.room;
  const double clear = scenario.walk.clearance;
  const double x = p_WD.x(), y = p_WD.y();
  const double beside = std::abs(x) - (0.5 * room.width - clear);
  const double behind = clear - room.behind - y, ahead = y - (room.ahead - clear);
  double deep = std::max(0.0, beside) + std::max({0.0, behind, ahead});
  for (const Block& block : front_blocks(room_measures(scenario))) {
    const double in = std::min({x - block.low_W.x(), block.high_W.x() - x, y - block.low_W.y(),
                                block.high_W.y() - y}) +
                      clear;
    deep += std::max(0.0, in);
  }
  return deep;
}

}  // namespace

void step(Walk& walk, const Scenario& scenario, const Pose& X_PD, const Pose& X_PX, int thumbs,
          double dt) {
  const Vec3 wanted = thumbs * scenario.walk.speed * level_ahead(X_PX);
  const Vec3 change = wanted - walk.v_WP;
  const double most = scenario.walk.acceleration * dt;
  walk.v_WP = change.norm() <= most ? wanted : Vec3(walk.v_WP + most * change.normalized());
  if (walk.v_WP.isZero(0.0)) return;
  for (const int axis : {0, 1}) {  // separately, so that walking along a wall is possible
    Vec3 there = walk.p_WP;
    there[axis] += walk.v_WP[axis] * dt;
    if (depth(there + X_PD.p, scenario) > depth(walk.p_WP + X_PD.p, scenario)) {
      walk.v_WP[axis] = 0.0;
    } else {
      walk.p_WP = there;
    }
  }
}

}  // namespace headpin::scene
