#include "devices/hmd.h"

#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

namespace headpin::devices {
namespace {

TEST(HmdTest, TheDefaultIsThePapers) {
  const HmdProfile& hmd = hmd_profiles().front();
  EXPECT_EQ(hmd.width, 360);
  EXPECT_EQ(hmd.height, 240);
  EXPECT_EQ(hmd.horizontal_fov_deg, 75.0);
  EXPECT_EQ(hmd.vertical_fov_deg, 40.0);
  // tan(37.5) / 360 over tan(20) / 240: its picture elements are wide.
  EXPECT_NEAR(hmd.pixel_aspect(), 1.405, 0.001);
  EXPECT_EQ(hmd.overlap(), 1.0);
}

TEST(HmdTest, ProfilesAreFoundByNameAndOthersRefused) {
  for (const HmdProfile& profile : hmd_profiles()) {
    EXPECT_EQ(hmd_profile(profile.name).name, profile.name);
  }
  EXPECT_NEAR(hmd_profile("flight-helmet-square").pixel_aspect(), 1.0, 0.001);
  EXPECT_EQ(hmd_profile("flight-helmet-leep").vertical_fov_deg, 58.4);
  EXPECT_THROW(hmd_profile("dvisor"), std::invalid_argument);
}

// A receiver's x points forward, y right, z down; a display looks along -z with y up.
TEST(HmdTest, AReceiverAtRestOnTheHelmetLooksForward) {
  const Hmd hmd(hmd_profiles().front());
  const Pose X_TD = head_pose(hmd, Pose{});
  EXPECT_TRUE((X_TD.q * -Vec3::UnitZ()).isApprox(Vec3::UnitX()));  // looks along T's forward
  EXPECT_TRUE((X_TD.q * Vec3::UnitX()).isApprox(Vec3::UnitY()));
  EXPECT_TRUE((X_TD.q * Vec3::UnitY()).isApprox(-Vec3::UnitZ()));
  EXPECT_GT(X_TD.p.z(), 0.0);  // the eyes are below the receiver
}

TEST(HmdTest, EyesAreTheirDistanceApartAndMirrored) {
  HmdProfile profile = hmd_profiles().front();
  profile.outward_deg = 10.0;
  Hmd hmd(profile);
  hmd.eye_distance = 0.070;
  const auto [left, right] = eyes_in_head(hmd);
  EXPECT_DOUBLE_EQ((right.p - left.p).x(), 0.070);
  EXPECT_LT((left.q * -Vec3::UnitZ()).x(), 0.0);  // the left eye's axis turns to the left
  EXPECT_NEAR(left.q.angularDistance(right.q), 20.0 * 3.14159265 / 180.0, 1e-6);
  EXPECT_NEAR(profile.overlap(), 1.0 - 20.0 / 75.0, 1e-12);
}

TEST(HmdTest, CalibrationFindsTheReceiverThroughNoise) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  const auto vector = [&] {
    const double x = normal(random), y = normal(random), z = normal(random);
    return Vec3(x, y, z);
  };
  const Pose X_SD{rotation(Vec3(0.4, -1.2, 2.0)), Vec3(0.1, 0.02, 0.12)};
  std::vector<Pose> measured, known;
  for (int i = 0; i < 400; ++i) {
    const Pose X_TS{rotation(vector()), vector()};
    known.push_back(X_TS * X_SD);
    measured.push_back({rotation(0.01 * vector()) * X_TS.q, X_TS.p + 0.002 * vector()});
  }
  const Pose found = calibrate_receiver(measured, known);
  // The mean of 400 is 20 times better than one; four deviations.
  EXPECT_LT((found.p - X_SD.p).norm(), 4 * 0.004 / 20);
  EXPECT_LT(found.q.angularDistance(X_SD.q), 4 * 0.0175 / 20);
  const CalibrationError error = calibration_error(measured, known, found);
  EXPECT_NEAR(error.rotation, 0.01 * std::sqrt(3.0), 0.002);
}

TEST(HmdTest, CalibrationWithoutMomentsIsRefused) {
  const std::vector<Pose> one(1), none;
  EXPECT_THROW(calibrate_receiver(none, none), std::invalid_argument);
  EXPECT_THROW(calibrate_receiver(one, none), std::invalid_argument);
}

}  // namespace
}  // namespace headpin::devices
