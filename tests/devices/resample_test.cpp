#include "devices/base/resample.h"

#include <tuple>

#include <gtest/gtest.h>

namespace headpin::devices {
namespace {

Pose at_x(double x) {
  return {Quat::Identity(), Vec3(x, 0.0, 0.0)};
}

TEST(PoseTrackTest, MixesBetweenSamplesAndHoldsOutside) {
  PoseTrack track;
  EXPECT_FALSE(track.at(Time{5}).has_value());
  track.push(Time{1000}, at_x(1.0));
  track.push(Time{2000}, at_x(3.0));
  EXPECT_DOUBLE_EQ(track.at(Time{0})->p.x(), 1.0);
  EXPECT_DOUBLE_EQ(track.at(Time{1250})->p.x(), 1.5);
  EXPECT_DOUBLE_EQ(track.at(Time{9000})->p.x(), 3.0);
}

TEST(PoseTrackTest, SaysHowAPoseIsKnown) {
  PoseTrack track;
  EXPECT_FALSE(track.read(Time{5}).has_value());
  track.push(Time{1000}, at_x(1.0));
  track.push(Time{2000}, at_x(3.0));
  const auto known = [&](std::int64_t us) {
    const KnownPose pose = *track.read(Time{us});
    return std::tuple(pose.how, pose.last.count(), pose.pose.p.x());
  };
  EXPECT_EQ(known(0), std::tuple(PoseKnown::held, 1000, 1.0));
  EXPECT_EQ(known(1000), std::tuple(PoseKnown::sampled, 1000, 1.0));
  EXPECT_EQ(known(1250), std::tuple(PoseKnown::interpolated, 1000, 1.5));
  EXPECT_EQ(known(2000), std::tuple(PoseKnown::sampled, 2000, 3.0));
  EXPECT_EQ(known(9000), std::tuple(PoseKnown::held, 2000, 3.0));
}

TEST(PoseTrackTest, DropsASampleThatRunsBack) {
  PoseTrack track;
  EXPECT_TRUE(track.push(Time{1000}, at_x(1.0)));
  EXPECT_FALSE(track.push(Time{1000}, at_x(2.0)));
  EXPECT_FALSE(track.push(Time{999}, at_x(2.0)));
  EXPECT_EQ(track.samples().size(), 1u);
}

TEST(PoseTrackTest, ForgettingKeepsWhatIsNeededAtThatTime) {
  PoseTrack track;
  for (int i = 0; i < 10; ++i) track.push(Time{1000 * i}, at_x(i));
  const double before = track.at(Time{5500})->p.x();
  track.forget_before(Time{5500});
  EXPECT_EQ(track.samples().front().time, Time{5000});
  EXPECT_DOUBLE_EQ(track.at(Time{5500})->p.x(), before);
}

}  // namespace
}  // namespace headpin::devices
