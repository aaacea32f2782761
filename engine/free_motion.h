#pragma once

#include "base/math.h"

/// Free rotation of a body without contacts.
namespace headpin::engine {

/// Principal moments of inertia about the centre of mass; the most different one is the last.
struct Inertia {
  Vec3 moments = Vec3::Ones();   ///< I1, I2, I3 [kg m^2]; I1 = I2 for a body of revolution
  Vec3 inverse = Vec3::Ones();   ///< 1/I1, 1/I2, 1/I3
  Quat q_BP = Quat::Identity();  ///< principal frame P in B
  bool aligned = true;           ///< P is B
};

/// Principal moments and axes of an inertia tensor.
///
/// The third axis is the one whose moment differs most from the other two, so that a body of
/// revolution has it as its axis. Moments within 1e-9 of each other count as equal.
///
/// @throws std::invalid_argument  unless symmetric, finite and positive definite
Inertia principal_inertia(const Mat3& inertia_B);

/// Whether all moments are equal: the angular velocity then stays constant.
inline bool is_ball(const Inertia& inertia) {
  return inertia.moments[0] == inertia.moments[1] && inertia.moments[0] == inertia.moments[2];
}

/// Third principal axis in W, unit: that of a body of revolution.
Vec3 axis_of_revolution(const Inertia& inertia, const Quat& q_WB);

/// Inverse inertia of a body with orientation q_WB, in W [1/(kg m^2)].
Mat3 inverse_inertia(const Inertia& inertia, const Quat& q_WB);

/// Angular momentum about the centre of mass [kg m^2/s] and turning energy [J].
Vec3 angular_momentum(const Inertia& inertia, const Quat& q_WB, const Vec3& w_WB);
double turning_energy(const Inertia& inertia, const Quat& q_WB, const Vec3& w_WB);

/// Rotates a body freely for `dt`. Angular momentum L is exact, the energy too if I1 = I2.
///
/// A body of revolution has the closed solution q' = exp(L dt / I1) q exp(e3 (1/I3 - 1/I1) L3 dt).
/// If I1 != I2, a turn about the second axis for half the time, at rate (1/I2 - 1/I1) L2, comes
/// before and after it. This symmetric splitting of the energy is composed to fourth order, in
/// parts of a tenth of a radian, at most 1000 of them. The energy then stays to 1e-6 up to 100 radians in
/// `dt`; beyond it, the parts are longer.
void turn_freely(Quat& q_WB, Vec3& w_WB, const Inertia& inertia, double dt);

}  // namespace headpin::engine
