#include "base/math.h"

#include <numbers>

#include <gtest/gtest.h>

namespace headpin {
namespace {

TEST(SinCosTest, AgreesWithTheLibraryToRounding) {
  for (double x = -1000.0; x < 1000.0; x += 0.0137) {
    const SinCos mine = sin_cos(x);
    EXPECT_NEAR(mine.sin, std::sin(x), 2e-15) << x;
    EXPECT_NEAR(mine.cos, std::cos(x), 2e-15) << x;
  }
}

TEST(ExponentialAndLogarithm, AgreeWithTheLibraryToRounding) {
  for (double x = -20.0; x < 20.0; x += 0.0137) {
    EXPECT_NEAR(exponential(x), std::exp(x), 1e-15 * std::exp(x)) << x;
    const double y = std::exp(x);
    EXPECT_NEAR(logarithm(y), std::log(y), 1e-15 * std::max(1.0, std::abs(std::log(y)))) << y;
  }
  EXPECT_EQ(exponential(-1000.0), 0.0);
  EXPECT_EQ(exponential(0.0), 1.0);
  EXPECT_EQ(logarithm(1.0), 0.0);
}

TEST(Power, AgreesWithTheLibraryAndKnowsItsEnds) {
  for (double base = 0.01; base < 1.0; base += 0.013) {
    for (double exponent = 0.001; exponent < 5.0; exponent += 0.0917) {
      const double expected = std::pow(base, exponent);
      EXPECT_NEAR(power(base, exponent), expected, 1e-14 * expected);
    }
  }
  EXPECT_EQ(power(0.0, 0.25), 0.0);
  EXPECT_EQ(power(1.0, 0.25), 1.0);
  EXPECT_EQ(power(0.0, 0.0), 1.0);
}

TEST(Rotation, IsOnePieceWhereItsTwoFormulasMeet) {
  for (double angle = 0.0999; angle < 0.1001; angle += 1e-6) {
    const Quat q = rotation(Vec3(0.0, angle, 0.0));
    EXPECT_NEAR(q.w(), std::cos(angle / 2), 2e-16);
    EXPECT_NEAR(q.y(), std::sin(angle / 2), 2e-17);
  }
}

TEST(Rotation, TurnsByTheAngleAboutTheAxis) {
  const double angle = 0.7;
  const Vec3 turned = rotation(Vec3(0.0, 0.0, angle)) * Vec3::UnitX();
  EXPECT_NEAR((turned - Vec3(std::cos(angle), std::sin(angle), 0.0)).norm(), 0.0, 1e-15);
}

TEST(Rotation, IsUndoneByRotationVector) {
  for (const Vec3& w : {Vec3(0.1, -0.2, 0.3), Vec3(0.0, 3.1, 0.0), Vec3(1e-14, 0.0, 0.0)}) {
    EXPECT_NEAR((rotation_vector(rotation(w)) - w).norm(), 0.0, 1e-14);
  }
}

TEST(PoseTest, TimesItsInverseIsTheIdentity) {
  const Pose X{rotation(Vec3(0.3, 0.2, -1.0)), Vec3(1.0, 2.0, 3.0)};
  const Pose I = X * X.inverse();
  EXPECT_NEAR(I.p.norm(), 0.0, 1e-15);
  EXPECT_NEAR(rotation_vector(I.q).norm(), 0.0, 1e-15);
}

TEST(RelativePose, IsTheInverseOfTheOneTimesTheOther) {
  const Pose X_WA{rotation(Vec3(0.3, 0.2, -1.0)), Vec3(1.0, 2.0, 3.0)};
  const Pose X_WB{rotation(Vec3(-0.5, 0.7, 0.1)), Vec3(-2.0, 0.5, 0.0)};
  const Pose expected = X_WA.inverse() * X_WB, X_AB = relative(X_WA, X_WB);
  EXPECT_LT((X_AB.p - expected.p).norm(), 1e-15);
  EXPECT_LT((X_AB.q.coeffs() - expected.q.coeffs()).norm(), 1e-15);
}

TEST(Interpolate, MeetsItsEndsAndTakesTheShorterArc) {
  const Pose a{rotation(Vec3(0.0, 0.0, 0.1)), Vec3(1.0, 0.0, 0.0)};
  Pose b{rotation(Vec3(0.0, 0.0, 0.5)), Vec3(3.0, 0.0, 0.0)};
  b.q.coeffs() *= -1.0;  // the same turn, written the other way
  EXPECT_NEAR(rotation_vector(a.q.conjugate() * interpolate(a, b, 0.0).q).norm(), 0.0, 1e-15);
  EXPECT_NEAR(rotation_vector(b.q.conjugate() * interpolate(a, b, 1.0).q).norm(), 0.0, 1e-15);
  EXPECT_NEAR(rotation_vector(interpolate(a, b, 0.5).q).z(), 0.3, 1e-15);
  EXPECT_NEAR(interpolate(a, b, 0.25).p.x(), 1.5, 1e-15);
}

TEST(TickTime, KeepsWholeRatiosWhole) {
  for (std::int64_t n = 0; n < 100'000; n += 7) {
    EXPECT_EQ(tick_time(2 * n, 240), tick_time(n, 120));
    EXPECT_EQ(tick_time(4 * n, 240), tick_time(n, 60));
  }
  EXPECT_EQ(tick_time(240'000'000'000, 240), Time{1'000'000'000'000'000});
}

}  // namespace
}  // namespace headpin
