// Which samples decide how the ball leaves the hand, and how far back they are looked for.

#include <cmath>
#include <functional>
#include <set>

#include <gtest/gtest.h>

#include "base/random.h"
#include "scene/play/release.h"

namespace headpin::scene {
namespace {

using HandTrack = std::vector<Stamped<Pose>>;

/// A hand that is at p(t) [m, s], sampled evenly.
HandTrack sampled_evenly(Time step, Time end, const std::function<Vec3(double)>& p) {
  HandTrack track;
  for (Time t{}; t <= end; t += step) track.push_back({t, {Quat::Identity(), p(seconds(t))}});
  return track;
}

/// A hand that goes straight ahead.
HandTrack straight_ahead(double speed, Time step, Time end) {
  return sampled_evenly(step, end, [&](double t) { return Vec3(0.0, speed * t, 1.0); });
}

Motion motion_of_hand(std::span<const Stamped<Pose>> track, Time at,
                      const ReleaseWindow& window = release_window(Hand{})) {
  return motion_at(track, at, Vec3::Zero(), window);
}

/// A window that does not grow.
ReleaseWindow fixed_window(Time length) {
  return {.least = length, .most = length};
}

// docs/release.md: samples that a hand would have to reach faster than 20 m/s are left out.
TEST(SamplesOfAHand, AreAllUsedUpToTwentyMetresPerSecondAtAnyRate) {
  for (const double speed : {1.0, 9.5, 12.5, 18.0, 19.5}) {
    for (const int step_us : {2'000, 4'000, 10'000, 16'667}) {
      const Motion found =
          motion_of_hand(straight_ahead(speed, Time{step_us}, Time{400'000}), Time{380'000});
      EXPECT_EQ(found.known, Known::tracked);
      EXPECT_EQ(found.left_out, 0) << speed << " " << step_us;
      EXPECT_NEAR(found.V_WB.v.y(), speed, 1e-6);
    }
  }
}

// Five samples in the window are too few for the fit to judge one of them: what is left out is what no hand does.
TEST(SamplesOfAHand, ThereAndBackAtNearlyTheSpeedLimitIsLessLikelyThanOneBadSample) {
  const Time step{30'000};
  for (const double speed : {12.0, 19.95}) {
    HandTrack track = straight_ahead(0.0, step, 8 * step);
    track[6].value.p.x() += 0.05 + speed * seconds(step);  // 0.05 m: the noise between two samples
    const Motion found = motion_of_hand(track, 8 * step, fixed_window(Time{120'000}));
    EXPECT_EQ(found.left_out, speed > 19.0 ? 1 : 0);
  }
}

// One of them is wrong: the seventh shows a hand at 19.95 m/s, from where the eighth cannot be reached.
TEST(SamplesOfAHand, OfTwoThatExcludeEachOtherTheSlowerIsLikelier) {
  const Time step{10'000};
  HandTrack track = straight_ahead(0.0, step, 20 * step);
  track[14].value.p.x() += 0.05 + 19.95 * seconds(step);
  track[15].value.p.x() -= 0.006;  // within the noise of the others
  EXPECT_EQ(motion_of_hand(track, 18 * step, fixed_window(Time{120'000})).left_out, 1);
}

TEST(SamplesOfAHand, AreTheLaterOnesWhereAsManyShowItElsewhere) {
  const Time step{10'000};
  HandTrack track = straight_ahead(0.0, step, 9 * step);
  for (std::size_t i = 5; i < 10; ++i) track[i].value.p.x() += 3.0;
  const Motion found = motion_of_hand(track, 9 * step);
  EXPECT_EQ(found.left_out, 5);
  ASSERT_TRUE(found.X_PH);
  EXPECT_EQ(found.X_PH->p, track.back().value.p);
}

// A cubic has four coefficients; with three more samples one can be judged by the others.
TEST(SamplesOfAHand, AreSevenBeforeTheFitJudgesOne) {
  const Time step{20'000}, at = 10 * step;
  for (const Time last : {at, at + step}) {
    HandTrack track = straight_ahead(2.0, step, last);
    track[7].value.p.x() += 0.1;
    const Motion found = motion_of_hand(track, at, fixed_window(Time{120'000}));
    EXPECT_EQ(found.left_out, last > at ? 1 : 0);
    if (last > at) {
      EXPECT_LT((found.V_WB.v - Vec3(0.0, 2.0, 0.0)).norm(), 1e-9);
    }
  }
}

// Three of 25 Hz have a weight; those before them, where the hand is at rest, only where the window grows.
TEST(SamplesOfAHand, OfASlowTrackerMakeALine) {
  const Time last{400'000};
  const HandTrack track = sampled_evenly(
      Time{40'000}, last, [&](double t) { return Vec3(0.0, 5.0 * std::max(t, 0.32), 1.0); });
  const Motion found = motion_of_hand(track, last);
  EXPECT_EQ(found.known, Known::tracked);
  EXPECT_LT((found.V_WB.v - Vec3(0.0, 5.0, 0.0)).norm(), 1e-9);
}

// Where the shortest window has fewer than three, all of the longest are judged and counted.
TEST(SamplesOfAHand, ThatAreOlderThanTheShortestWindowCountWhereItHasFewerThanThree) {
  for (const int in_window : {2, 3}) {
    HandTrack track;
    for (const int age_ms : {225, 200, 175, 150, 130}) {
      track.push_back({Time{1000 * (500 - age_ms)}, {}});
    }
    track[2].value.p.x() += 3.0;
    for (int i = in_window; i-- > 0;) track.push_back({Time{1000 * (500 - 30 * i)}, {}});
    const Motion found = motion_of_hand(track, Time{500'000});
    EXPECT_EQ(found.left_out, in_window == 2 ? 1 : 0);
    EXPECT_EQ(found.V_WB.v, Vec3(Vec3::Zero()));
  }
}

TEST(SamplesOfAHand, ThatAreAllLaterThanTheWindowTellNothing) {
  const HandTrack track = straight_ahead(5.0, Time{10'000}, Time{600'000});
  const auto later = std::span(track).subspan(40);
  const Motion found = motion_of_hand(later, later.front().time - Time{100'000});
  EXPECT_EQ(found.known, Known::impossible);
  EXPECT_FALSE(found.X_PH);
  EXPECT_EQ(motion_of_hand(later, later.front().time - Time{10'000}).known, Known::extrapolated);
}

// 15 m/s of the hand and 10 m/s of its turn: no hand is so fast, but it is where its samples are.
TEST(SamplesOfAHand, SayWhereItIsAlsoWhereItsMotionIsImpossible) {
  HandTrack track = straight_ahead(15.0, Time{10'000}, Time{200'000});
  for (auto& sample : track) {
    sample.value.q = rotation(Vec3(0.0, 0.0, 20.0 * (seconds(sample.time) - 0.145)));
  }
  const Motion found = motion_at(track, Time{145'000}, Vec3(0.5, 0.0, 0.0), release_window(Hand{}));
  EXPECT_EQ(found.known, Known::impossible);
  ASSERT_TRUE(found.X_PH);
  EXPECT_LT((found.X_PH->p - Vec3(0.0, 15.0 * 0.145, 1.0)).norm(), 1e-9);
}

// A hand at rest is known exactly: the window does not grow to where it moved, even if nothing worse is taken.
TEST(ReleaseWindowTest, GrowsOnlyWhileTheErrorIsAboveTheOneThatIsTaken) {
  const HandTrack track = sampled_evenly(Time{10'000}, Time{400'000}, [](double t) {
    return Vec3(0.0, 2.0 * std::min(0.0, t - 0.245), 1.0);
  });
  const ReleaseWindow exact{.least = Time{120'000}, .most = Time{240'000}, .accuracy = 0.0};
  EXPECT_EQ(motion_of_hand(track, Time{400'000}, exact).V_WB.v, Vec3(Vec3::Zero()));
  EXPECT_EQ(release_velocity(track, Vec3::Zero(), exact).v, Vec3(Vec3::Zero()));
}

HandTrack noisy_hand(std::uint64_t seed, Time step, double sigma) {
  Random random(seed);
  HandTrack track = straight_ahead(3.0, step, Time{400'000});
  for (auto& sample : track) sample.value.p += sigma * random.normal3();
  return track;
}

TEST(ReleaseWindowTest, GrowsNoFurtherThanItNeeds) {
  const HandTrack track = noisy_hand(3, Time{5'000}, 0.004);
  std::set<double> found;
  for (double accuracy = 1.0; accuracy > 0.01; accuracy *= 0.99) {
    const ReleaseWindow window{.least = Time{120'000}, .most = Time{240'000}, .accuracy = accuracy};
    found.insert(motion_of_hand(track, Time{400'000}, window).V_WB.v.y());
  }
  EXPECT_GE(found.size(), 4u);
}

TEST(ReleaseWindowTest, GrowsToTheLongestBeforeTheLastSampleWhereTheMotionIsExtrapolated) {
  const Time last{400'000};
  const ReleaseWindow never{.least = Time{120'000}, .most = Time{240'000}, .accuracy = 0.0};
  const auto speed = [&](Time moved) {
    HandTrack track = noisy_hand(1, Time{5'000}, 0.0005);
    for (auto& sample : track) {
      if (sample.time == moved) sample.value.p.y() += 1e-4;
    }
    return motion_of_hand(track, last + Time{25'000}, never).V_WB.v.y();
  };
  const double quiet = speed(Time{-1});
  EXPECT_GT(std::abs(speed(last - never.most + Time{15'000}) - quiet), 1e-9);
  EXPECT_EQ(speed(last - never.most), quiet);
}

using VelocityOf = std::function<Vec3(const HandTrack&, const ReleaseWindow&)>;

/// The root mean squares, along an axis, of the error of the shortest window, and of what the window takes it for.
struct WindowErrors {
  double error = 0.0, estimate = 0.0;
};

WindowErrors window_errors(Time step, double sigma, const VelocityOf& velocity) {
  constexpr int kThrows = 200;
  WindowErrors squares;
  for (std::uint64_t seed = 1; seed <= kThrows; ++seed) {
    const HandTrack track = noisy_hand(seed, step, sigma);
    const Vec3 own = velocity(track, fixed_window(Time{120'000}));
    squares.error += (own - Vec3(0.0, 3.0, 0.0)).squaredNorm() / 3.0;
    // The least error that it takes without a look further back.
    double low = 0.0, high = 10.0;
    for (int i = 0; i < 14; ++i) {
      const double middle = 0.5 * (low + high);
      const ReleaseWindow window{.least = Time{120'000}, .most = Time{240'000}, .accuracy = middle};
      (velocity(track, window) == own ? high : low) = middle;
    }
    squares.estimate += high * high;
  }
  return {std::sqrt(squares.error / kThrows), std::sqrt(squares.estimate / kThrows)};
}

// 600 errors tell their deviation to 3 %, and 200 estimates theirs to less. The weights of the cubic make its estimate
// a rough one.
TEST(ReleaseWindowTest, KnowsTheErrorOfItsVelocity) {
  const WindowErrors parabola =
      window_errors(Time{16'667}, 0.005, [](const HandTrack& track, const ReleaseWindow& window) {
        return release_velocity(track, Vec3::Zero(), window).v;
      });
  EXPECT_NEAR(parabola.estimate, parabola.error, 0.1 * parabola.error);
  const WindowErrors cubic =
      window_errors(Time{16'667}, 0.002, [](const HandTrack& track, const ReleaseWindow& window) {
        return motion_of_hand(track, Time{380'000}, window).V_WB.v;
      });
  EXPECT_NEAR(cubic.estimate, cubic.error, 0.25 * cubic.error);
}

}  // namespace
}  // namespace headpin::scene
