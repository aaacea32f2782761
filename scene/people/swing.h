#pragma once

#include "scene/people/figure.h"
#include "scene/scenario/scenario.h"

/// How a virtual participant throws.
namespace headpin::scene {

/// The motion of the hand in a throw: a pendulum with minimum jerk, from rest at the back to rest
/// in front.
struct Swing {
  Posture ready, back;     ///< before it, and as far back as it goes
  double through = 1.5;    ///< raise of the arm where it ends [rad]
  double back_s = 1.0;     ///< from ready to back
  double forward_s = 0.6;  ///< from there to the end
  double release_s = 0.3;  ///< of that, until the release
};

/// Finds the swing that releases the ball with a given speed, at a given height, towards a target.
///
/// The ball's velocity is nearly level, and the release is a little before the arm is fastest. The
/// height is only reached as far as the knees can bend.
///
/// @param stands    feet where it is thrown from, in the tracked space
/// @param target_P  where the ball is to go
/// @param speed     [m/s], of the ball's centre
/// @param height    of the ball's centre [m]
/// @param lean      of the trunk then [rad]
Swing plan_swing(const Build& build, const Hand& hand, const Posture& stands, const Vec3& target_P,
                 double speed, double height, double lean);

}  // namespace headpin::scene
