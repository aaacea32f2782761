#pragma once

#include <span>

#include "engine/math.h"

/// How the virtual hand takes a ball, carries it and lets it go.
namespace headpin::scene {

/// Velocity the ball leaves the hand with.
///
/// Fits a line through the hand positions of the last `window` and carries its slope, and the
/// turn from first to last sample, over to the centre of the ball.
///
/// @param track   hand poses X_WH, oldest first; the last one is the release
/// @param p_HB    centre of the ball in the hand [m]
/// @param window  how far back to look; 60 ms holds four samples of one of two 120 Hz receivers
/// @return        v_WB [m/s] and w_WB [rad/s]
/// @throws std::invalid_argument  with fewer than two samples in the window
Twist release_velocity(std::span<const Stamped<Pose>> track, const Vec3& p_HB, Time window);

}  // namespace headpin::scene
