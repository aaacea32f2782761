#pragma once

#include <algorithm>
#include <span>

#include "scene/scenario/scenario.h"

/// How the virtual hand grabs, carries and releases a ball.
namespace headpin::scene {

/// The time window of the fit for the release velocity.
///
/// It is as short as the noise allows. A swing is a parabola only for a short time, so a fit over
/// 120 ms has an error of 0.6 m/s with any tracker. But four samples of a Fastrak at 2.5 m (noise
/// of 18 mm) have an error of 2.8 m/s, and the longer fit has 1.2 m/s.
struct ReleaseWindow {
  Time least{60'000};  ///< holds four samples of one of two 120 Hz receivers
  Time most{120'000};  ///< longest window, for noisy samples
  /// The window grows while the standard error along an axis is above this [m/s].
  double accuracy = 0.3;

  Time longest() const { return std::max(least, most); }
};

inline ReleaseWindow release_window(const Hand& hand) {
  return {microseconds(hand.release_window_s), microseconds(hand.release_window_most_s),
          hand.release_accuracy};
}

/// The velocity of the ball at the release.
///
/// Fits a parabola to the hand's positions and rotations in the last `window`; its slope at the
/// release gives the velocity of the ball's centre. A straight line would lag by half the window: a
/// swing accelerates by about 40 m/s2, so the ball would be 1.2 m/s too slow. Fewer than four
/// samples are fitted with a line. The residuals of the positions give the standard error of the
/// slope. If it is too large, or the window has only one sample, the window is extended by one
/// sample, and so on.
///
/// @param track   hand poses X_PH, oldest first; the last one is the release
/// @param p_HB    centre of the ball in the hand [m]
/// @param window  lengths of the window
/// @return        in the tracked space, v_PB [m/s] and w_WB [rad/s]
/// @throws std::invalid_argument  with fewer than two samples in the longest window
Twist release_velocity(std::span<const Stamped<Pose>> track, const Vec3& p_HB,
                       const ReleaseWindow& window);

}  // namespace headpin::scene
