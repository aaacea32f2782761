// Frames through points, the weight of a filter, the noise and the numbers that a driver receives.

#include <numbers>
#include <random>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/fastrak/geometry.h"
#include "devices/fastrak/setup.h"

namespace headpin::devices {
namespace {

TEST(FastrakGeometryTest, PointsWithinAMicrometreOfALineAreNoFrame) {
  const Vec3 p_TO = Vec3::Zero(), p_TY(5.0, 1.0, 0.0);
  EXPECT_FALSE(frame_through(p_TO, Vec3(1e-6, 0.0, 0.0), p_TY));
  EXPECT_TRUE(frame_through(p_TO, Vec3(1.1e-6, 0.0, 0.0), p_TY));
  EXPECT_FALSE(frame_through(p_TO, Vec3(2.0, 0.0, 0.0), Vec3(5.0, 1e-6, 0.0)));
  EXPECT_TRUE(frame_through(p_TO, Vec3(2.0, 0.0, 0.0), Vec3(5.0, 1.1e-6, 0.0)));
}

// Between FLOW and FHIGH: up at once to F times the distance, down by FACTOR a step.
TEST(FastrakGeometryTest, TheWeightOfAFilterRisesAtOnceAndSinksByItsFactor) {
  const FastrakFilter filter{.sensitivity = 0.25, .low = 0.1, .high = 0.8, .factor = 0.5};
  AdaptiveWeight weight;
  EXPECT_EQ(weight.next(filter, 0.0), 0.5);  // half of the fresh one's 1
  EXPECT_EQ(weight.next(filter, 0.0), 0.25);
  EXPECT_EQ(weight.next(filter, 0.0), 0.125);
  EXPECT_EQ(weight.next(filter, 0.0), 0.1);
  EXPECT_EQ(weight.next(filter, 3.0), 0.75);
  EXPECT_EQ(weight.next(filter, 1.0), 0.375);
  EXPECT_EQ(weight.next(filter, 100.0), 0.8);
}

TEST(FastrakGeometryTest, TheNoiseIsTheDataSheetsWithin30InchesAndGrowsWithTheCubeBeyond) {
  constexpr double kRadians = std::numbers::pi / 180.0, kInch = 0.0254;
  for (const double range : {10 * kInch, 30 * kInch}) {
    EXPECT_DOUBLE_EQ(noise_at(range).position, 0.0002 * range);
    EXPECT_DOUBLE_EQ(noise_at(range).rotation, 0.025 * kRadians);
  }
  EXPECT_DOUBLE_EQ(noise_at(60 * kInch).position, 8 * 0.0002 * 60 * kInch);
  EXPECT_DOUBLE_EQ(noise_at(60 * kInch).rotation, 8 * 0.025 * kRadians);
}

/// The pose that a driver reads from the binary record of one.
Pose through_a_record(const Pose& X_TS) {
  const FastrakFormat format{.items = {2, 11, 0}, .binary = true, .centimetres = true};
  FastrakRecord record;
  record.position = X_TS.p / kMetrePerCentimetre;
  record.quaternion = {X_TS.q.w(), X_TS.q.x(), X_TS.q.y(), X_TS.q.z()};
  std::vector<std::uint8_t> bytes;
  encode_record(record, format, bytes);
  return pose_of(decode_record(bytes, format).value(), format);
}

TEST(FastrakGeometryTest, APoseAsReceivedPassesTheLineAgainToTheLastBit) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(-3.0, 3.0), unit(-1.0, 1.0);
  for (int i = 0; i < 2000; ++i) {
    Pose X_TS;
    X_TS.p = Vec3(place(random), place(random), place(random));
    X_TS.q = Quat(unit(random), unit(random), unit(random), unit(random)).normalized();
    const Pose X = as_received(X_TS);
    EXPECT_LE((X.p - X_TS.p).cwiseAbs().maxCoeff(), 3.0 * 0x1p-24);
    EXPECT_LE(X.q.angularDistance(X_TS.q), 1e-5);
    EXPECT_GE(X.q.w(), 0.0);
    const Pose again = through_a_record(X);
    ASSERT_EQ(again.p, X.p);
    ASSERT_EQ(again.q.coeffs(), X.q.coeffs());
  }
}

// Only a negative scalar part changes the sign of the four.
TEST(FastrakGeometryTest, AHalfTurnKeepsItsAxisWhenReceived) {
  const Pose X_TS{Quat(0.0, 0.0, 1.0, 0.0), Vec3::Zero()};
  EXPECT_EQ(as_received(X_TS).q.coeffs(), X_TS.q.coeffs());
}

}  // namespace
}  // namespace headpin::devices
