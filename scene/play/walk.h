#pragma once

#include "scene/scenario/scenario.h"

/// How thumbs move the player through the room.
namespace headpin::scene {

/// Where the tracked space P stands in the room: at rest W itself, and moved without being turned.
struct Walk {
  Vec3 p_WP = Vec3::Zero();
  Vec3 v_WP = Vec3::Zero();  ///< horizontal

  /// When it was there, within the last tick.
  Pose X_WP(double ago_s = 0.0) const { return {Quat::Identity(), p_WP - ago_s * v_WP}; }
};

/// One tick of walking.
///
/// The left thumb walks forward, the right one backward, along the horizontal direction of what leads
/// (`walk.along`: the head or the hand); both thumbs, or a lead straight up or down, stand still. The
/// paper says which buttons move "forward" and "backward", and not which way that is: the gaze is ours. Speed is taken up and lost at `walk.acceleration`. A step that would bring the head
/// nearer to a wall than `walk.clearance` is not made; what the head does in the tracked space is its own.
///
/// @param X_PD    the head
/// @param X_PX    what leads, along its -z: the head where it looks, or the hand where it points
/// @param thumbs  1 forward, -1 backward, 0 neither
/// @param dt      length of the tick [s]
void step(Walk& walk, const Scenario& scenario, const Pose& X_PD, const Pose& X_PX, int thumbs,
          double dt);

}  // namespace headpin::scene
