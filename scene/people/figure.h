#pragma once

#include <array>

#include "base/math.h"

/// The body of a virtual participant: joints that move with minimum jerk, and the resulting poses
/// of head and hand.
///
/// Frame P is the tracked space: x right, y ahead, z up, the floor at z = 0. A left-hander is the
/// mirror image. Transcendental functions are our own series, so the bits are equal on every
/// computer.
namespace headpin::scene {

/// Direction of a vector in a plane, from `along` towards `across` [rad], in (-pi, pi]; 0 for none.
double direction(double along, double across);

/// A value that moves to another value with minimum jerk, from any initial speed and acceleration
/// (Flash and Hogan 1985: the quintic with given value, speed and acceleration at both ends).
class Glide {
 public:
  explicit Glide(double value = 0.0) : coefficients_{value} {}

  double at(double time) const;
  double goal() const;
  /// Starts at `now`; value, speed and acceleration are continuous.
  void to(double value, double now, double duration);

 private:
  std::array<double, 6> coefficients_;  // of powers of the share of the way
  double begin_ = 0.0, duration_ = 1.0;
};

/// A posture.
struct Posture {
  double x = 0.0, y = 0.0;  ///< feet [m]
  double facing = 0.0;      ///< of the trunk, to the left [rad]
  double crouch = 0.0;      ///< hips lowered by the knees [m]
  double lean = 0.05;       ///< of the trunk, forward [rad]
  double raise = 0.15;      ///< of the arm against the vertical, forward [rad]
  double aside = 0.05;      ///< of the arm, outward [rad]
  double reach = 0.55;      ///< shoulder to palm [m]
};

/// A posture that changes.
class Figure {
 public:
  explicit Figure(const Posture& posture);

  Posture at(double time) const;
  Posture goal() const;
  void to(const Posture& posture, double now, double duration);
  /// One joint alone.
  void to(double Posture::*joint, double value, double now, double duration);

 private:
  std::array<Glide, 8> joints_;
};

/// The measures of a body.
struct Build {
  double height = 1.75;  ///< [m]
  bool left_handed = false;

  double arm() const { return 0.38 * height; }  ///< shoulder to palm, stretched
  double deepest_crouch() const { return 0.2 * height; }
  /// From the middle to the shoulder of the throwing arm, to the right.
  double shoulder_aside() const { return (left_handed ? -0.129 : 0.129) * height; }
};

/// Shoulder of the throwing arm.
Vec3 shoulder(const Build& build, const Posture& posture);

/// X_PH. Hanging, the palm looks ahead: fingers (-z) down, back of the hand (y) to the rear.
Pose palm(const Build& build, const Posture& posture);

/// X_PD, the pose between the eyes, which look to the left by `turn` and up by `pitch`.
Pose eyes(const Build& build, const Posture& posture, double turn, double pitch);

/// Points the arm at a place, with the palm at a distance before it. If the arm cannot bend or
/// stretch enough, it only points there.
void point_at(const Build& build, Posture& posture, const Vec3& p_PQ, double before);

}  // namespace headpin::scene
