// Who virtual participants are, and how a figure of theirs moves and swings.

#include "scene/people/person.h"

#include <cmath>
#include <functional>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "scene/people/figure.h"
#include "scene/people/swing.h"

namespace headpin::scene {
namespace {

TEST(PersonTest, IsDrawnFromItsSeedAndIsSomebody) {
  int left = 0;
  double height = 0.0;
  std::set<double> speeds;
  constexpr int kPeople = 2000;
  for (std::uint64_t seed = 1; seed <= kPeople; ++seed) {
    const Person person = draw_person(seed), again = draw_person(seed);
    EXPECT_EQ(person.height, again.height);
    EXPECT_EQ(person.speed, again.speed);
    EXPECT_EQ(person.tremor, again.tremor);
    EXPECT_TRUE(person.height >= 1.45 && person.height <= 2.0) << seed;
    EXPECT_TRUE(person.speed >= 4.0 && person.speed <= 9.0) << seed;
    EXPECT_TRUE(person.reaction_s > 0.1 && person.pace > 0.5 && person.skill < 1.0) << seed;
    left += person.left_handed;
    height += person.height / kPeople;
    speeds.insert(person.speed);
  }
  // Four deviations of a mean of so many.
  EXPECT_NEAR(left, 0.1 * kPeople, 4.0 * std::sqrt(0.09 * kPeople));
  EXPECT_NEAR(height, 1.70, 4.0 * 0.09 / std::sqrt(kPeople));
  EXPECT_GT(speeds.size(), 0.9 * kPeople);
}

/// Pearson's, of two traits of many people.
double correlation(const std::vector<Person>& people, const std::function<double(const Person&)>& a,
                   const std::function<double(const Person&)>& b) {
  const auto n = static_cast<double>(people.size());
  double a_sum = 0.0, b_sum = 0.0, aa = 0.0, bb = 0.0, ab = 0.0;
  for (const Person& person : people) {
    const double x = a(person), y = b(person);
    a_sum += x;
    b_sum += y;
    aa += x * x;
    bb += y * y;
    ab += x * y;
  }
  return (ab - a_sum * b_sum / n) / std::sqrt((aa - a_sum * a_sum / n) * (bb - b_sum * b_sum / n));
}

// An analysis can tell them apart: 0.3 of any two, 0.55 = sqrt(0.3) with skill. Four deviations of a
// correlation of so many are 0.08 at most.
TEST(PersonTest, SpreadsOfSpeedAimAndTimingAreTraitsOfTheirOwn) {
  std::vector<Person> people;
  for (std::uint64_t seed = 1; seed <= 2000; ++seed) people.push_back(draw_person(seed));
  const auto speed = [](const Person& p) { return p.speed_spread; };
  const auto aim = [](const Person& p) { return p.aim_spread; };
  const auto timing = [](const Person& p) { return p.timing_spread; };
  const auto skill = [](const Person& p) { return p.skill; };
  EXPECT_NEAR(correlation(people, speed, aim), 0.3, 0.08);
  EXPECT_NEAR(correlation(people, speed, timing), 0.3, 0.08);
  EXPECT_NEAR(correlation(people, aim, timing), 0.3, 0.08);
  EXPECT_NEAR(correlation(people, speed, skill), -std::sqrt(0.3), 0.08);
  EXPECT_NEAR(correlation(people, aim, skill), -std::sqrt(0.3), 0.08);
  EXPECT_NEAR(correlation(people, timing, skill), -std::sqrt(0.3), 0.08);
  for (const Person& person : people) {
    EXPECT_GE(person.speed_spread, 0.01);
    EXPECT_GE(person.aim_spread, 0.005);
    EXPECT_GE(person.timing_spread, 0.003);
  }
}

TEST(FigureTest, DirectionsAreThoseOfTheLibrary) {
  for (int i = -20; i <= 20; ++i) {
    const double angle = 0.15 * i;
    const double along = 2.0 * std::cos(angle), across = 2.0 * std::sin(angle);
    EXPECT_NEAR(direction(along, across), std::atan2(across, along), 1e-14) << angle;
  }
  EXPECT_EQ(direction(0.0, 0.0), 0.0);
  EXPECT_NEAR(direction(-1.0, 0.0), std::atan2(0.0, -1.0), 1e-14);
}

// Whatever it does: place, speed and acceleration go on, and it comes to rest.
TEST(FigureTest, AGlideThatIsSentElsewhereGoesOnWithoutAJolt) {
  Glide glide(0.2);
  glide.to(1.0, 1.0, 0.8);
  const Glide before = glide;
  const double turned = 1.3, h = 1e-4;
  glide.to(-0.4, turned, 0.5);
  const auto speed = [&](const Glide& g, double t) {
    return (g.at(t + h) - g.at(t - h)) / (2 * h);
  };
  const auto gain = [&](const Glide& g, double t) {
    return (g.at(t + h) - 2.0 * g.at(t) + g.at(t - h)) / (h * h);
  };
  EXPECT_DOUBLE_EQ(glide.at(turned), before.at(turned));
  EXPECT_NEAR(speed(glide, turned + h), speed(before, turned), 1e-2);
  EXPECT_GT(std::abs(speed(before, turned)), 0.5);
  EXPECT_NEAR(gain(glide, turned + h), gain(before, turned), 0.1);
  EXPECT_NEAR(glide.at(turned + 0.5), -0.4, 1e-12);
  EXPECT_NEAR(glide.goal(), -0.4, 1e-12);
  EXPECT_NEAR(speed(glide, turned + 0.5 - h), 0.0, 1e-3);
  EXPECT_EQ(glide.at(9.0), glide.at(turned + 0.5));
}

TEST(FigureTest, ALeftHanderIsTheMirrorImage) {
  Posture posture;
  posture.raise = 0.8;
  posture.aside = 0.4;
  posture.lean = 0.3;
  const Pose right = palm({1.8, false}, posture), left = palm({1.8, true}, posture);
  EXPECT_LT((left.p - Vec3(-right.p.x(), right.p.y(), right.p.z())).norm(), 1e-12);
  const Vec3 fingers = right.q * -Vec3::UnitZ(), mirrored = left.q * -Vec3::UnitZ();
  EXPECT_LT((mirrored - Vec3(-fingers.x(), fingers.y(), fingers.z())).norm(), 1e-12);
  EXPECT_GT(right.p.x(), 0.0);
}

TEST(FigureTest, AnArmPointsAtWhatItReachesFor) {
  const Vec3 target(0.2, 0.5, 0.9);
  for (const bool left_handed : {false, true}) {
    const Build build{1.75, left_handed};
    Posture posture;
    posture.lean = 0.3;
    point_at(build, posture, target, 0.1);
    const Pose X_PH = palm(build, posture);
    EXPECT_LT((X_PH * Vec3(0.0, 0.0, -0.1) - target).norm(), 1e-9);
  }
}

// What the plan promises, measured on the way of the hand itself.
TEST(SwingTest, TheBallLeavesAsFastAsLowAndWhereItIsMeantTo) {
  const Hand hand;
  const Vec3 target(0.1, 6.0, 0.15);
  for (const bool left_handed : {false, true}) {
    for (const double speed : {4.5, 6.5, 8.5}) {
      const Build build{1.75, left_handed};
      Posture stands;
      stands.y = -0.5;
      const double height = 0.3;
      const Swing swing = plan_swing(build, hand, stands, target, speed, height, 0.8);
      Figure figure(swing.back);
      figure.to(&Posture::raise, swing.through, 0.0, swing.forward_s);
      const auto ball = [&](double t) { return Vec3(palm(build, figure.at(t)) * hand.grip); };
      const double h = 1e-4, t = swing.release_s;
      const Vec3 v = (ball(t + h) - ball(t - h)) / (2.0 * h);
      EXPECT_NEAR(v.norm(), speed, 1e-4 * speed);
      EXPECT_NEAR(ball(t).z(), height, 1e-9);
      EXPECT_NEAR(std::atan2(v.z(), v.head<2>().norm()), 0.02, 1e-4);  // nearly level
      const Vec3 way = target - ball(t);
      EXPECT_NEAR(std::atan2(v.x(), v.y()), std::atan2(way.x(), way.y()), 1e-6);
      EXPECT_GT(v.norm(), 0.9 * (ball(t + 0.03) - ball(t + 0.01)).norm() / 0.02);
    }
  }
}

}  // namespace
}  // namespace headpin::scene
