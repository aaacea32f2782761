#include "devices/fastrak/geometry.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "devices/fastrak/codec.h"

namespace headpin::devices {
namespace {

constexpr double kRadian = std::numbers::pi / 180.0;

}  // namespace

Vec3 angles_deg(const Quat& q) {
  const Mat3 R = q.normalized().toRotationMatrix();
  const double sine = std::clamp(-R(2, 0), -1.0, 1.0);
  const double cosine = std::hypot(R(0, 0), R(1, 0));
  const double elevation = std::atan2(sine, cosine);
  if (cosine < 1e-9) return Vec3(std::atan2(-R(0, 1), R(1, 1)), elevation, 0.0) / kRadian;
  return Vec3(std::atan2(R(1, 0), R(0, 0)), elevation, std::atan2(R(2, 1), R(2, 2))) / kRadian;
}

Quat from_angles_deg(const Vec3& angles_deg) {
  const Vec3 angles = angles_deg * kRadian;
  return rotation(angles.x() * Vec3::UnitZ()) * rotation(angles.y() * Vec3::UnitY()) *
         rotation(angles.z() * Vec3::UnitX());
}

std::optional<Pose> frame_through(const Vec3& p_TO, const Vec3& p_TX, const Vec3& p_TY) {
  constexpr double kLeast = 1e-6;  // m
  const Vec3 along = p_TX - p_TO;
  if (!(along.norm() > kLeast)) return std::nullopt;
  const Vec3 x = along.normalized();
  const Vec3 across = x.cross(p_TY - p_TO);
  if (!(across.norm() > kLeast)) return std::nullopt;
  Mat3 R;
  R.col(0) = x;
  R.col(2) = across.normalized();
  R.col(1) = R.col(2).cross(x);
  return Pose{Quat(R).normalized(), p_TO};
}

double AdaptiveWeight::next(const FastrakFilter& filter, double distance) {
  const double wanted = std::clamp(filter.sensitivity * distance, filter.low, filter.high);
  weight_ = std::clamp(std::max(wanted, filter.factor * weight_), filter.low, filter.high);
  return weight_;
}

FastrakNoise noise_at(double range) {
  constexpr double kNear = 0.762;  // m, 30 inches
  const double weaker = std::max(1.0, range / kNear);
  const double growth = weaker * weaker * weaker;
  return {0.0002 * range * growth, 0.025 * kRadian * growth};
}

Pose as_received(const Pose& X_TS) {
  const auto sent = [](double value) { return static_cast<double>(static_cast<float>(value)); };
  Pose X = X_TS;
  X.p = (X.p / kMetrePerCentimetre).unaryExpr(sent) * kMetrePerCentimetre;
  if (X.q.w() < 0.0) X.q.coeffs() = -X.q.coeffs();  // as the unit sends it
  // The float32 numbers of a unit quaternion are not exactly unit. A driver normalises them, and
  // its float32 numbers may then differ. A quaternion nearby is found for which they do not differ.
  constexpr double kLastPlace = 6e-8;
  for (int nudge = 0; nudge < 64; ++nudge) {
    Quat near = X.q;
    near.coeffs()[nudge % 4] += nudge * kLastPlace;
    const Eigen::Vector4d line = near.normalized().coeffs().unaryExpr(sent);
    const Quat received = Quat(line).normalized();
    if (received.coeffs().unaryExpr(sent) == line) {
      X.q = received;
      break;
    }
  }
  return X;
}

}  // namespace headpin::devices
