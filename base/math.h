#pragma once

#include <chrono>
#include <cmath>
#include <cstdint>

// The library is compiled with these flags. With other flags, memory layouts and results would
// differ without an error message.
#ifndef EIGEN_DONT_VECTORIZE
#error \
    "headpin: add what `pkg-config --cflags headpin-engine` says, at least -DEIGEN_DONT_VECTORIZE -ffp-contract=off"
#endif
#ifdef __FAST_MATH__
#error \
    "headpin: leave out -ffast-math (or add -fno-fast-math): results are equal bits, and NaN is refused"
#endif

#include <Eigen/Dense>

/// Poses, vectors and time: the only thing every folder shares.
///
/// Inside headpin: metre, kilogram, second, radian, double; stamps are integer microseconds.
namespace headpin {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Quat = Eigen::Quaterniond;

static_assert(sizeof(Quat) == 4 * sizeof(double) && alignof(Quat) == alignof(double) &&
                  !Mat3::IsRowMajor,
              "headpin: leave out the EIGEN_ macros that change alignment or storage order");

/// A stamp or a span. Simulated time never reads the wall clock.
using Time = std::chrono::microseconds;

inline double seconds(Time t) {
  return 1e-6 * static_cast<double>(t.count());
}

/// The same, rounded once: prints as the decimal number it stands for.
inline double nearest_seconds(Time t) {
  return static_cast<double>(t.count()) / 1e6;
}

/// The stamp nearest to `s` seconds.
inline Time microseconds(double s) {
  return Time{std::llround(s * 1e6)};
}

/// Stamp of tick `n` of a clock of `rate_hz`: n / rate, rounded down to a whole microsecond.
///
/// Whole ratios stay whole: tick 2 n of 240 Hz and tick n of 120 Hz have the same stamp.
inline Time tick_time(std::int64_t n, std::int64_t rate_hz) {
  return Time{n / rate_hz * 1'000'000 + n % rate_hz * 1'000'000 / rate_hz};
}

/// Where frame B stands in frame A: a rotation, then a translation. X_AC = X_AB * X_BC.
struct Pose {
  Quat q = Quat::Identity();  ///< q_AB, unit
  Vec3 p = Vec3::Zero();      ///< origin of B in A [m]

  Vec3 operator*(const Vec3& p_BQ) const { return q * p_BQ + p; }
  Pose operator*(const Pose& X_BC) const { return {q * X_BC.q, q * X_BC.p + p}; }
  Pose inverse() const {
    const Quat q_BA = q.conjugate();
    return {q_BA, q_BA * -p};
  }
};

/// Where B stands in A, both known in W: X_WA.inverse() * X_WB with one rotation less.
inline Pose relative(const Pose& X_WA, const Pose& X_WB) {
  const Quat q_AW = X_WA.q.conjugate();
  return {q_AW * X_WB.q, q_AW * (X_WB.p - X_WA.p)};
}

/// How a frame moves: velocity of its origin [m/s] and angular velocity [rad/s].
struct Twist {
  Vec3 v = Vec3::Zero();
  Vec3 w = Vec3::Zero();
};

template <typename T>
struct Stamped {
  Time time{};
  T value{};
};

inline Mat3 skew(const Vec3& r) {
  Mat3 m;
  m << 0.0, -r.z(), r.y(), r.z(), 0.0, -r.x(), -r.y(), r.x(), 0.0;
  return m;
}

/// Sine and cosine by our own series, so that every machine gets the same bits.
///
/// @param angle  [rad], |angle| <= 1e5; error below 2e-15 there
struct SinCos {
  double sin, cos;
};
SinCos sin_cos(double angle);

/// exp(x), log(x) and base^exponent by our own series, for the same reason.
///
/// Relative error below 1e-15, 1e-15 and 1e-14; `logarithm` takes x > 0, `power` a base >= 0 and
/// gives 0^0 = 1.
double exponential(double x);
double logarithm(double x);
double power(double base, double exponent);

/// Cosine of half an angle, and its sine over the angle, given the square of the angle.
struct HalfAngle {
  double cosine, sine_by_angle;
};
HalfAngle half_of_large_angle(double square);
inline HalfAngle half_angle(double square) {
  if (!(square < 0.01)) return half_of_large_angle(square);
  // The usual turn of one step needs no root and no reduction of the angle.
  const double z = 0.25 * square;
  return {1.0 + z * (-0.5 + z * (1.0 / 24 + z * (-1.0 / 720 + z * (1.0 / 40320)))),
          0.5 + z * (-1.0 / 12 + z * (1.0 / 240 + z * (-1.0 / 10080 + z * (1.0 / 725760))))};
}

/// Rotation by the vector `w_dt` (axis times angle [rad]), as a unit quaternion.
inline Quat rotation(const Vec3& w_dt) {
  const HalfAngle half = half_angle(w_dt.squaredNorm());
  const double s = half.sine_by_angle;
  return {half.cosine, s * w_dt.x(), s * w_dt.y(), s * w_dt.z()};
}

/// The z axis of B in A.
inline Vec3 z_axis(const Quat& q_AB) {
  return {2.0 * (q_AB.x() * q_AB.z() + q_AB.w() * q_AB.y()),
          2.0 * (q_AB.y() * q_AB.z() - q_AB.w() * q_AB.x()),
          1.0 - 2.0 * (q_AB.x() * q_AB.x() + q_AB.y() * q_AB.y())};
}

/// The vector axis times angle [rad] that turns A into B, angle in [0, pi].
///
/// By our own series, like sin_cos.
Vec3 rotation_vector(const Quat& q_AB);

/// Pose a fraction `s` of the way from `a` to `b`: straight line, shorter arc.
///
/// The quaternions are mixed linearly and normalised: exact at both ends and the middle, within
/// 0.1 degree between for turns below 45 degrees, and free of transcendental functions.
Pose interpolate(const Pose& a, const Pose& b, double s);

}  // namespace headpin
