// The parabola through samples.

#include "scene/play/parabola.h"

#include <vector>

#include <gtest/gtest.h>

namespace headpin::scene {
namespace {

const std::vector<double> kX = {-1.0, -0.7, -0.5, -0.2, 0.0};

TEST(ParabolaTest, ReturnsTheParabolaThatThePointsLieOn) {
  const Vec3 c0(1.0, -2.0, 0.5), c1(0.0, 3.0, -1.0), c2(4.0, 0.0, 2.5);
  std::vector<Vec3> y;
  for (const double x : kX) y.emplace_back(c0 + c1 * x + c2 * x * x);
  const Mat3 found = fit_parabola(kX, y).coefficients;
  // Rounding, times the condition of the normal matrix, which is about 300.
  EXPECT_TRUE(found.row(0).isApprox(c0.transpose(), 1e-12));
  EXPECT_TRUE(found.row(1).isApprox(c1.transpose(), 1e-12));
  EXPECT_TRUE(found.row(2).isApprox(c2.transpose(), 1e-12));
}

// Of a line, slope = sum of (x - mean x) y / sum of (x - mean x)^2.
TEST(ParabolaTest, WithTwoTermsIsTheLineOfLeastSquares) {
  std::vector<Vec3> y;
  double mean = 0.0, above = 0.0, below = 0.0;
  for (const double x : kX) {
    y.emplace_back(x * x, 0.0, 1.0);
    mean += x / 5.0;
  }
  for (const double x : kX) {
    above += (x - mean) * x * x;
    below += (x - mean) * (x - mean);
  }
  const Parabola line = fit_parabola(kX, y, 2);
  EXPECT_NEAR(line.coefficients(1, 0), above / below, 1e-12);
  EXPECT_NEAR(line.inverse(1, 1), 1.0 / below, 1e-12);
  EXPECT_TRUE(line.coefficients.row(2).isZero(0.0));
}

}  // namespace
}  // namespace headpin::scene
