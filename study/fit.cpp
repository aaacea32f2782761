#include "study/fit.h"

#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

namespace headpin::study {

namespace {

/// The contribution of a count to the deviance, given its mean.
double deviance_of(double y, double mean, double n) {
  const auto part = [](double count, double expected) {
    return count > 0.0 ? count * std::log(count / expected) : 0.0;
  };
  return 2.0 * (part(y, mean) + part(n - y, n - mean));
}

}  // namespace

Fit fit_binomial(const Eigen::MatrixXd& x, const Eigen::VectorXd& y, double n) {
  constexpr int kMost = 30;
  constexpr double kSame = 1e-10, kBound = 30.0;  // exp(30): not distinguishable from probability 1
  Fit fit;
  fit.estimates = Eigen::VectorXd::Zero(x.cols());
  if (x.cols() == 0) {
    for (Eigen::Index i = 0; i < y.size(); ++i) fit.deviance += deviance_of(y[i], 0.5 * n, n);
    fit.converged = true;
    return fit;
  }
  double before = std::numeric_limits<double>::infinity();
  for (int step = 0; step < kMost; ++step) {
    const Eigen::VectorXd eta = (x * fit.estimates).cwiseMax(-kBound).cwiseMin(kBound);
    const Eigen::ArrayXd p = 1.0 / (1.0 + (-eta.array()).exp());
    fit.deviance = 0.0;
    for (Eigen::Index i = 0; i < y.size(); ++i) fit.deviance += deviance_of(y[i], n * p[i], n);
    if (std::abs(fit.deviance - before) < kSame * (fit.deviance + 0.1)) {
      fit.converged = fit.estimates.cwiseAbs().maxCoeff() < 0.5 * kBound;
      return fit;
    }
    before = fit.deviance;
    const Eigen::VectorXd weights = (n * p * (1.0 - p)).matrix();
    const Eigen::MatrixXd information = x.transpose() * weights.asDiagonal() * x;
    const Eigen::VectorXd score = x.transpose() * (y.array() - n * p).matrix();
    const Eigen::LDLT<Eigen::MatrixXd> solver(information);
    const Eigen::VectorXd change = solver.solve(score);
    if (solver.info() != Eigen::Success || !change.allFinite()) return fit;
    fit.estimates += change;
  }
  return fit;
}

}  // namespace headpin::study
