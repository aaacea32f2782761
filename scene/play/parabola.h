#pragma once

#include <span>

#include "base/math.h"

namespace headpin::scene {

/// c0 + c1 x + c2 x^2, fitted to points.
struct Parabola {
  Mat3 coefficients;  ///< rows: c0, c1, c2
  Mat3 inverse;       ///< of the normal matrix: times the variance of y, the covariance of the rows
};

/// Fits a parabola by least squares.
///
/// @param x      without unit, best between -1 and 1
/// @param y      one point per x; there are at least `terms` different x
/// @param terms  3; or 2 for a line, whose c2 is 0
Parabola fit_parabola(std::span<const double> x, std::span<const Vec3> y, int terms = 3);

}  // namespace headpin::scene
