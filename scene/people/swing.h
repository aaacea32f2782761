#pragma once

#include "scene/people/figure.h"
#include "scene/scenario/scenario.h"

/// How a virtual participant throws.
namespace headpin::scene {

/// What the hand does to throw a ball: a pendulum with the least jerk from rest behind to rest ahead.
struct Swing {
  Posture ready, back;     ///< before it, and as far back as it goes
  double through = 1.5;    ///< raise of the arm where it ends [rad]
  double back_s = 1.0;     ///< from ready to back
  double forward_s = 0.6;  ///< from there to the end
  double release_s = 0.3;  ///< of that, until the ball is let go
};

/// The swing whose ball leaves the hand with a speed, at a height, towards a place.
///
/// It leaves nearly level, a little before the arm is fastest. What the knees cannot do to the
/// height is left out.
///
/// @param stands    feet where it is thrown from, in the tracked space
/// @param target_P  where the ball is to go
/// @param speed     [m/s], of the ball's centre
/// @param height    of the ball's centre [m]
/// @param lean      of the trunk then [rad]
Swing plan_swing(const Build& build, const Hand& hand, const Posture& stands, const Vec3& target_P,
                 double speed, double height, double lean);

}  // namespace headpin::scene
