#pragma once

#include <span>

#include "engine/math.h"

/// How the virtual hand takes a ball, carries it and lets it go.
namespace headpin::scene {

/// Velocity the ball leaves the hand with.
///
/// Fits a parabola to the hand's positions and turns of the last `window` and carries its slope at
/// the release over to the centre of the ball. A straight line would lag by half the window: a
/// swing gains some 40 m/s2, so it would throw 1.2 m/s too slow. Fewer than four samples still get
/// the line.
///
/// @param track   hand poses X_WH, oldest first; the last one is the release
/// @param p_HB    centre of the ball in the hand [m]
/// @param window  how far back to look; 60 ms holds four samples of one of two 120 Hz receivers
/// @return        v_WB [m/s] and w_WB [rad/s]
/// @throws std::invalid_argument  with fewer than two samples in the window
Twist release_velocity(std::span<const Stamped<Pose>> track, const Vec3& p_HB, Time window);

}  // namespace headpin::scene
