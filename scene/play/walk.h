#pragma once

#include "scene/scenario/scenario.h"

/// Walking with the thumb buttons.
namespace headpin::scene {

/// The place of the tracked space P in the world: at first that of W, then translated without
/// rotation.
struct Walk {
  Vec3 p_WP = Vec3::Zero();
  Vec3 v_WP = Vec3::Zero();  ///< horizontal

  /// Its place at a time within the last tick.
  Pose X_WP(double ago_s = 0.0) const { return {Quat::Identity(), p_WP - ago_s * v_WP}; }
};

/// Walks for one tick.
///
/// The left thumb walks forward, the right one backward, in the horizontal direction of head or
/// hand (`walk.along`). With both thumbs, or if that direction is vertical, the player stands
/// still. The paper says which buttons move "forward" and "backward", but not in which direction;
/// the gaze is our choice. The speed changes by `walk.acceleration`. A step that would bring the
/// head nearer to a wall than `walk.clearance` is not made; the player's own movements are not
/// limited.
///
/// @param X_PD    the head
/// @param X_PX    head or hand, whose -z is the direction
/// @param thumbs  1 forward, -1 backward, 0 neither
/// @param dt      length of the tick [s]
void step(Walk& walk, const Scenario& scenario, const Pose& X_PD, const Pose& X_PX, int thumbs,
          double dt);

}  // namespace headpin::scene
