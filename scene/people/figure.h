#pragma once

#include <array>

#include "engine/math.h"

/// The body of a virtual participant: joints that move with the least jerk, and where head and hand
/// are with them.
///
/// Frame P is the tracked space: x right, y ahead, z up, the floor at z = 0. A left-hander is the
/// mirror image. By our own series throughout: the same bits on every machine.
namespace headpin::scene {

/// Direction of a vector in a plane, from `along` towards `across` [rad], in (-pi, pi]; 0 for none.
double direction(double along, double across);

/// A value on its way to rest elsewhere with the least jerk, from however it moves now (Flash and
/// Hogan 1985: the quintic that meets place, speed and acceleration at both ends).
class Glide {
 public:
  explicit Glide(double value = 0.0) : coefficients_{value} {}

  double at(double time) const;
  double goal() const;
  /// From `now` on; keeps place, speed and acceleration there.
  void to(double value, double now, double duration);

 private:
  std::array<double, 6> coefficients_;  // of powers of the share of the way
  double begin_ = 0.0, duration_ = 1.0;
};

/// How somebody stands.
struct Posture {
  double x = 0.0, y = 0.0;  ///< feet [m]
  double facing = 0.0;      ///< of the trunk, to the left [rad]
  double crouch = 0.0;      ///< hips lowered by the knees [m]
  double lean = 0.05;       ///< of the trunk, forward [rad]
  double raise = 0.15;      ///< of the arm against the vertical, forward [rad]
  double aside = 0.05;      ///< of the arm, outward [rad]
  double reach = 0.55;      ///< shoulder to palm [m]
};

/// A posture on its way.
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

/// Who has the joints.
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

/// Between the eyes, looking to the left by `turn` and up by `pitch`: X_PD.
Pose eyes(const Build& build, const Posture& posture, double turn, double pitch);

/// Lets the arm point at a place, the palm that far before it; nearer than the arm can fold or
/// further than it stretches, it only points there.
void point_at(const Build& build, Posture& posture, const Vec3& p_PQ, double before);

}  // namespace headpin::scene
