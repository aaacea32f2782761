#include "scene/play/hand.h"

#include <cmath>

#include <gtest/gtest.h>

#include "base/random.h"

namespace headpin::scene {
namespace {

const ReleaseWindow kWindow;

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

/// Deviation of the slope at the last of n points `step` apart, each off by `sigma`, of the
/// parabola through them.
double end_slope_deviation(int n, double step, double sigma) {
  const double variance = 12.0 * (2 * n - 1) * (8 * n - 11) / (1.0 * n * (n * n - 1) * (n * n - 4));
  return std::sqrt(variance) * sigma / step;
}

/// Root mean square error, along an axis, of many throws that are parabolas but for the noise.
double release_error(double sigma, Time step, const ReleaseWindow& window) {
  constexpr int kThrows = 400;
  Random random(5);
  const Vec3 a(1.0, 40.0, -3.0);
  double squares = 0.0;
  for (int i = 0; i < kThrows; ++i) {
    std::vector<Stamped<Pose>> track;
    for (int k = 0; k <= 20; ++k) {
      const double t = seconds(k * step);
      const Vec3 off = sigma * random.normal3();
      track.push_back({k * step, {Quat::Identity(), 0.5 * a * t * t + off}});
    }
    const Vec3 v = release_velocity(track, Vec3::Zero(), window).v;
    squares += (v - a * seconds(track.back().time)).squaredNorm();
  }
  return std::sqrt(squares / (3.0 * kThrows));
}

// Two receivers: four samples in 60 ms, eight in 120. The parabola through n of them knows its
// end's slope to the deviation above; within 10 %, as 1200 values tell their deviation to 2 %.
TEST(ReleaseVelocity, OfANoisyHandIsThatOverTheLongestWindow) {
  const Time step{16'667};
  const ReleaseWindow fixed{.least = Time{60'000}, .most = Time{60'000}};
  for (const double sigma : {0.015, 0.018}) {  // a Fastrak some 2.5 m away
    const double four = end_slope_deviation(4, seconds(step), sigma);
    const double eight = end_slope_deviation(8, seconds(step), sigma);
    EXPECT_NEAR(release_error(sigma, step, fixed), four, 0.1 * four);
    EXPECT_NEAR(release_error(sigma, step, kWindow), eight, 0.1 * eight);
  }
}

TEST(ReleaseVelocity, OfAQuietHandIsThatOverTheShortestWindowToTheBit) {
  const Time step{16'667};
  const ReleaseWindow fixed{.least = Time{60'000}, .most = Time{60'000}};
  for (const double sigma : {0.0, 0.0005}) {  // half a millimetre: a Fastrak within a metre
    EXPECT_EQ(release_error(sigma, step, kWindow), release_error(sigma, step, fixed));
  }
}

TEST(ReleaseVelocity, NeedsTwoSamplesOnEitherSideOfAGapAtLeast) {
  const Vec3 v(0.0, 5.0, 0.0);
  const auto gaps = steady(v, Vec3::Zero(), Time{70'000}, 3);
  EXPECT_NEAR((release_velocity(gaps, Vec3::Zero(), kWindow).v - v).norm(), 0.0, 1e-9);
  EXPECT_THROW(release_velocity({}, Vec3::Zero(), kWindow), std::invalid_argument);
  const auto sparse = steady(v, Vec3::Zero(), Time{130'000}, 3);
  EXPECT_THROW(release_velocity(sparse, Vec3::Zero(), kWindow), std::invalid_argument);
}

}  // namespace
}  // namespace headpin::scene
