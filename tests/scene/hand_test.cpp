#include "scene/hand.h"

#include <gtest/gtest.h>

namespace headpin::scene {
namespace {

constexpr Time kWindow{60'000};

/// A hand that moves and turns steadily, sampled every `step`.
std::vector<Stamped<Pose>> steady(const Vec3& v, const Vec3& w, Time step, int count) {
  std::vector<Stamped<Pose>> track;
  for (int i = 0; i < count; ++i) {
    const double t = seconds(i * step);
    track.push_back({i * step, {rotation(w * t), v * t}});
  }
  return track;
}

TEST(ReleaseVelocity, OfASteadyHandIsItsVelocity) {
  const Vec3 v(0.3, 6.5, -0.4);
  const Twist ball =
      release_velocity(steady(v, Vec3::Zero(), Time{14'000}, 9), Vec3::Zero(), kWindow);
  EXPECT_NEAR((ball.v - v).norm(), 0.0, 1e-12);
  EXPECT_NEAR(ball.w.norm(), 0.0, 1e-12);
}

TEST(ReleaseVelocity, OfATurningHandIsThatOfTheBallsCentre) {
  const Vec3 w(4.0, 0.0, 1.0), p_HB(0.0, -0.1, -0.2);
  const auto track = steady(Vec3::Zero(), w, Time{8'000}, 9);
  const Twist ball = release_velocity(track, p_HB, kWindow);
  const Vec3 p_WB = track.back().value.q * p_HB;
  EXPECT_NEAR((ball.v - w.cross(p_WB)).norm(), 0.0, 1e-10);
  EXPECT_NEAR((ball.w - w).norm(), 0.0, 1e-10);
}

TEST(ReleaseVelocity, OfASpeedingHandIsThatAtTheRelease) {
  const Vec3 a(1.0, 40.0, -3.0);
  std::vector<Stamped<Pose>> track;
  for (int i = 0; i < 6; ++i) {
    const double t = seconds(Time{14'000 * i});
    track.push_back({Time{14'000 * i}, {Quat::Identity(), 0.5 * a * t * t}});
  }
  const Twist ball = release_velocity(track, Vec3::Zero(), kWindow);
  EXPECT_NEAR((ball.v - a * seconds(track.back().time)).norm(), 0.0, 1e-9);
}

TEST(ReleaseVelocity, OfAHandOnASlowTrackerIsThatOfALine) {
  const auto sparse = steady(Vec3(0.0, 5.0, 1.0), Vec3::Zero(), Time{30'000}, 6);  // three in 60 ms
  EXPECT_NEAR((release_velocity(sparse, Vec3::Zero(), kWindow).v - Vec3(0.0, 5.0, 1.0)).norm(), 0.0,
              1e-9);
}

TEST(ReleaseVelocity, LooksBackOnlyOverTheWindow) {
  auto track = steady(Vec3(0.0, 5.0, 0.0), Vec3::Zero(), Time{10'000}, 12);
  track.front().value.p.x() = 100.0;  // long before the release
  EXPECT_NEAR(release_velocity(track, Vec3::Zero(), kWindow).v.x(), 0.0, 1e-12);
}

TEST(ReleaseVelocity, NeedsTwoSamples) {
  EXPECT_THROW(release_velocity({}, Vec3::Zero(), kWindow), std::invalid_argument);
  const auto sparse = steady(Vec3(0.0, 5.0, 0.0), Vec3::Zero(), Time{70'000}, 3);
  EXPECT_THROW(release_velocity(sparse, Vec3::Zero(), kWindow), std::invalid_argument);
}

}  // namespace
}  // namespace headpin::scene
