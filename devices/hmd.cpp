#include "devices/hmd.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace headpin::devices {
namespace {

// Data, not code: who has another display adds a line.
constexpr std::array<HmdProfile, 4> kProfiles = {{
    {"flight-helmet", "Uno & Slater 1997, section 3: Virtual Research Flight Helmet", 360, 240,
     75.0, 40.0, 0.064},
    {"flight-helmet-square", "as flight-helmet, with square elements at the same width", 360, 240,
     75.0, 54.18, 0.064},
    {"flight-helmet-leep",
     "Watson, Walker, Hodges, VRST 1997, after Robinett and Rolland 1992: 208 x 139 triads", 208,
     139, 75.3, 58.4, 0.064},
    {"flight-helmet-elements",
     "the same optics, its single-colour elements as brochures count them", 360, 240, 75.3, 58.4,
     0.064},
}};

constexpr double kRadian = std::numbers::pi / 180.0;

double tangent(double degrees) {
  const SinCos a = sin_cos(degrees * kRadian);
  return a.sin / a.cos;
}

}  // namespace

double HmdProfile::pixel_aspect() const {
  return tangent(0.5 * horizontal_fov_deg) / width / (tangent(0.5 * vertical_fov_deg) / height);
}

double HmdProfile::overlap() const {
  return std::max(0.0, 1.0 - 2.0 * std::abs(outward_deg) / horizontal_fov_deg);
}

std::span<const HmdProfile> hmd_profiles() {
  return kProfiles;
}

std::string hmd_profile_names() {
  std::string names;
  for (const HmdProfile& profile : kProfiles) {
    names.append(names.empty() ? "" : ", ").append(profile.name);
  }
  return names;
}

const HmdProfile& hmd_profile(std::string_view name) {
  const auto found = std::ranges::find(kProfiles, name, &HmdProfile::name);
  if (found != kProfiles.end()) return *found;
  throw std::invalid_argument(std::string("display '").append(name).append("': expected one of ") +
                              hmd_profile_names());
}

Hmd::Hmd(const HmdProfile& p) : profile(p), eye_distance(p.eye_distance) {
  Mat3 R_SD;         // columns: D's x, y, z in the receiver's forward, right, down
  R_SD << 0, 0, -1,  //
      1, 0, 0,       //
      0, -1, 0;
  X_SD = {Quat(R_SD), Vec3(0.10, 0.0, 0.12)};
}

std::array<Pose, 2> eyes_in_head(const Hmd& hmd) {
  const double outward = hmd.profile.outward_deg * kRadian;
  const Vec3 right(0.5 * hmd.eye_distance, 0.0, 0.0);
  return {Pose{rotation(outward * Vec3::UnitY()), -right},
          Pose{rotation(-outward * Vec3::UnitY()), right}};
}

Pose calibrate_receiver(std::span<const Pose> X_TS, std::span<const Pose> X_TD) {
  if (X_TS.empty() || X_TS.size() != X_TD.size()) {
    throw std::invalid_argument(
        "calibration: expected as many known poses as measured ones, found " +
        std::to_string(X_TD.size()) + " and " + std::to_string(X_TS.size()));
  }
  // The mean rotation maximises the sum of (q . q_i)^2: the first eigenvector of their outer
  // products (Markley and others 2007).
  Eigen::Matrix4d outer = Eigen::Matrix4d::Zero();
  Vec3 p_SD = Vec3::Zero();
  for (std::size_t i = 0; i < X_TS.size(); ++i) {
    const Pose X_SD = X_TS[i].inverse() * X_TD[i];
    outer += X_SD.q.coeffs() * X_SD.q.coeffs().transpose();
    p_SD += X_SD.p / static_cast<double>(X_TS.size());
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(outer);
  Quat q_SD;
  q_SD.coeffs() = solver.eigenvectors().col(3);
  if (q_SD.w() < 0.0) q_SD.coeffs() = -q_SD.coeffs();
  return {q_SD.normalized(), p_SD};
}

CalibrationError calibration_error(std::span<const Pose> X_TS, std::span<const Pose> X_TD,
                                   const Pose& X_SD) {
  CalibrationError error;
  for (std::size_t i = 0; i < X_TS.size() && i < X_TD.size(); ++i) {
    const Pose off = (X_TS[i] * X_SD).inverse() * X_TD[i];
    error.position += off.p.squaredNorm();
    error.rotation += rotation_vector(off.q).squaredNorm();
  }
  const auto n = static_cast<double>(std::max<std::size_t>(1, X_TS.size()));
  return {std::sqrt(error.position / n), std::sqrt(error.rotation / n)};
}

}  // namespace headpin::devices
