#pragma once

#include <algorithm>
#include <span>

#include "scene/scenario/scenario.h"

/// How the virtual hand takes a ball, carries it and lets it go.
namespace headpin::scene {

/// What the release velocity is fitted over.
///
/// The shortest that does: a swing is no parabola for long, so over 120 ms the fit errs by 0.6 m/s
/// whatever the tracker. But four samples of a Fastrak 2.5 m away, 18 mm of noise, tell it to 2.8
/// m/s only, and the longer fit to 1.2.
struct ReleaseWindow {
  Time least{60'000};     ///< holds four samples of one of two 120 Hz receivers
  Time most{120'000};     ///< how far it grows when they are too noisy
  double accuracy = 0.3;  ///< it grows while the speed along an axis is known worse than this [m/s]

  Time longest() const { return std::max(least, most); }
};

inline ReleaseWindow release_window(const Hand& hand) {
  return {microseconds(hand.release_window_s), microseconds(hand.release_window_most_s),
          hand.release_accuracy};
}

/// Velocity the ball leaves the hand with.
///
/// Fits a parabola to the hand's positions and turns of the last `window` and carries its slope at
/// the release over to the centre of the ball. A straight line would lag by half the window: a
/// swing gains some 40 m/s2, so it would throw 1.2 m/s too slow. Fewer than four samples still get
/// the line. How well the slope is known is told by what the parabola leaves of the positions;
/// where that is not well enough, or only one sample is in it, the window takes in one more, and
/// so on.
///
/// @param track   hand poses X_WH, oldest first; the last one is the release
/// @param p_HB    centre of the ball in the hand [m]
/// @param window  how far back to look
/// @return        v_WB [m/s] and w_WB [rad/s]
/// @throws std::invalid_argument  with fewer than two samples in the longest window
Twist release_velocity(std::span<const Stamped<Pose>> track, const Vec3& p_HB,
                       const ReleaseWindow& window);

}  // namespace headpin::scene
