#include "study/fit.h"

#include <cmath>
#include <vector>

#include <Eigen/QR>

namespace headpin::study {

namespace {

/// The contribution of a count to the deviance, given its mean.
double deviance_of(double y, double mean, double n) {
  const auto part = [](double count, double expected) {
    return count > 0.0 ? count * std::log(count / expected) : 0.0;
  };
  return 2.0 * (part(y, mean) + part(n - y, n - mean));
}

/// The columns that are no sum of multiples of earlier ones, with the tolerance of R's glm: what is left
/// of a column beside the earlier ones is at least 1e-11 of its length.
std::vector<Eigen::Index> independent_columns(const Eigen::MatrixXd& x) {
  constexpr double kTolerance = 1e-11;
  std::vector<Eigen::Index> kept;
  Eigen::MatrixXd directions(x.rows(), 0);  // of the kept columns: orthogonal, each of length 1
  for (Eigen::Index j = 0; j < x.cols(); ++j) {
    Eigen::VectorXd rest = x.col(j);
    for (int pass = 0; pass < 2; ++pass) rest -= directions * (directions.transpose() * rest);
    if (rest.norm() <= kTolerance * x.col(j).norm()) continue;
    kept.push_back(j);
    directions.conservativeResize(Eigen::NoChange, directions.cols() + 1);
    directions.rightCols(1) = rest.normalized();
  }
  return kept;
}

/// The probabilities of the rows, and the deviance.
struct At {
  Eigen::ArrayXd p;
  double deviance = 0.0;
};

At at_estimates(const Eigen::MatrixXd& x, const Eigen::VectorXd& y, double n,
                const Eigen::VectorXd& estimates) {
  constexpr double kBound = 30.0;  // exp(30): not distinguishable from probability 1
  const Eigen::VectorXd eta = (x * estimates).cwiseMax(-kBound).cwiseMin(kBound);
  At at{1.0 / (1.0 + (-eta.array()).exp())};
  for (Eigen::Index i = 0; i < y.size(); ++i) at.deviance += deviance_of(y[i], n * at.p[i], n);
  return at;
}

/// One step of Newton's method, by least squares of the weighted rows.
Eigen::VectorXd newton_step(const Eigen::MatrixXd& x, const Eigen::VectorXd& y, double n,
                            const Eigen::ArrayXd& p) {
  const Eigen::ArrayXd roots = (n * p * (1.0 - p)).sqrt();
  const Eigen::MatrixXd weighted = roots.matrix().asDiagonal() * x;
  return weighted.colPivHouseholderQr().solve(((y.array() - n * p) / roots).matrix());
}

/// The fit of independent columns.
Fit fit_independent(const Eigen::MatrixXd& x, const Eigen::VectorXd& y, double n) {
  constexpr int kMost = 30, kHalvings = 30;
  constexpr double kSame = 1e-10, kEndless = 15.0;
  Fit fit;
  fit.estimates = Eigen::VectorXd::Zero(x.cols());
  At here = at_estimates(x, y, n, fit.estimates);
  for (int step = 0; step < kMost; ++step) {
    Eigen::VectorXd change = newton_step(x, y, n, here.p);
    if (!change.allFinite()) break;
    const double same = kSame * (here.deviance + 0.1);
    At next = at_estimates(x, y, n, fit.estimates + change);
    for (int half = 0; half < kHalvings && next.deviance > here.deviance + same; ++half) {
      change *= 0.5;
      next = at_estimates(x, y, n, fit.estimates + change);
    }
    if (next.deviance > here.deviance + same) break;
    fit.estimates += change;
    const bool ends = std::abs(next.deviance - here.deviance) < same;
    here = next;
    if (!ends) continue;
    fit.converged = fit.estimates.cwiseAbs().maxCoeff() < kEndless;
    break;
  }
  fit.deviance = here.deviance;
  return fit;
}

}  // namespace

Fit fit_binomial(const Eigen::MatrixXd& x, const Eigen::VectorXd& y, double n) {
  const std::vector<Eigen::Index> kept = independent_columns(x);
  if (kept.empty()) {
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(x.cols());
    return {none, at_estimates(x, y, n, none).deviance, true};
  }
  Eigen::MatrixXd independent(x.rows(), std::ssize(kept));
  for (Eigen::Index j = 0; j < independent.cols(); ++j) {
    independent.col(j) = x.col(kept[static_cast<std::size_t>(j)]);
  }
  Fit fit = fit_independent(independent, y, n);
  Eigen::VectorXd estimates = Eigen::VectorXd::Zero(x.cols());
  for (Eigen::Index j = 0; j < independent.cols(); ++j) {
    estimates[kept[static_cast<std::size_t>(j)]] = fit.estimates[j];
  }
  fit.estimates = estimates;
  return fit;
}

}  // namespace headpin::study
