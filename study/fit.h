#pragma once

#include <vector>

#include "base/math.h"

/// Logistic regression of counts out of n by Newton's method, for simulations. It stays our own
/// code: it is called thousands of times, and the analysis of a study uses R's glm.
namespace headpin::study {

struct Fit {
  Eigen::VectorXd estimates;
  double deviance = 0.0;
  bool converged = false;  ///< else an estimate goes to infinity: separation
};

/// Columns that are a sum of multiples of earlier ones are left out, as R's glm does: their estimate is 0.
///
/// @param x  one row per observation, one column per term
/// @param y  successes of `n`
Fit fit_binomial(const Eigen::MatrixXd& x, const Eigen::VectorXd& y, double n);

}  // namespace headpin::study
