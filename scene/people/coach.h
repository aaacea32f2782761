#pragma once

#include <optional>

#include "scene/people/arm_model.h"
#include "scene/record/details.h"

/// A throw in the words of coaches, made by the model of the arm.
///
/// The words are those that scene/play/ball_path.h finds again in a session.
namespace headpin::scene {

inline constexpr double kMostRevs = 1000.0;   ///< of a ball [1/min]
inline constexpr double kFurthestLoft = 3.0;  ///< [m]

/// A wanted value, and the standard deviation of throws from it.
struct Wanted {
  double mean = 0.0;
  std::optional<double> deviation = {};  ///< not said: the thrower's own, if it has one
};

/// What is not said is as the thrower does it.
struct CoachedThrow {
  std::optional<Wanted> speed = {};         ///< of the ball at its release [m/s]
  std::optional<Wanted> revs_per_min = {};  ///< of its spin about any axis
  Wanted rotation_deg = {}, tilt_deg = {};  ///< of that axis, as in Delivered
  std::optional<Wanted> board = {};         ///< at the release
  std::optional<Wanted> angle_deg = {};     ///< of its level velocity, to the right
  std::optional<Wanted> loft = {};  ///< how far beyond the foul line it first touches the lane [m]
};

/// One throw of these.
struct TriedThrow {
  ThrowPlan plan;
  std::optional<Delivered> spin;  ///< its revs, rotation and tilt alone
};

/// Draws the values of one throw: normally distributed, by the seed of the plan, and a value beyond
/// what the arm can do is the limit.
///
/// @throws std::invalid_argument  for a loft from a height that the arm does not reach
TriedThrow draw(const CoachedThrow& wanted, ThrowPlan plan, const Scenario& scenario);

/// The spin that the fingers add to that of the hand, so that the ball leaves with this one: in the
/// frame of the hand [rad/s].
Vec3 fingers_spin(const ThrowMotion& motion, const Hand& hand, const Delivered& spin);

/// The ball of a motion at its release, as a tracker without noise would see it, with the change of
/// the scenario's [release].
Delivered delivered_by(const ThrowMotion& motion, const Scenario& scenario);

}  // namespace headpin::scene
