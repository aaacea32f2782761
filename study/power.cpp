#include "study/power.h"

#include <cmath>
#include <string>

#include "base/random.h"
#include "study/fit.h"
#include "study/model.h"

namespace headpin::study {

namespace {

constexpr double kChiSquared95 = 3.841458820694124;  // of one degree of freedom
constexpr std::uint64_t kStudies = 104, kAnswers = 105;

/// The values of the terms for the people of a simulated study.
Eigen::MatrixXd people_of(const Design& design, const Questionnaire& questions, int people,
                          std::uint64_t seed) {
  Eigen::MatrixXd x(people, std::ssize(design.terms));
  for (int i = 0; i < people; ++i) {
    const PlannedParticipant one{std::to_string(i), i, allot(design, seed, i)};
    const Answers answers = draw_answers(design, questions, seed, one);
    const std::vector<double> values = values_of(design, one.allotted, answers).value();
    for (Eigen::Index j = 0; j < x.cols(); ++j) x(i, j) = values[static_cast<std::size_t>(j)];
  }
  return x;
}

/// Draws the number of high answers of every person.
Eigen::VectorXd scores_of(const Eigen::MatrixXd& x, const Eigen::VectorXd& estimates, int n,
                          Random& random) {
  Eigen::VectorXd y = Eigen::VectorXd::Zero(x.rows());
  const Eigen::VectorXd eta = x * estimates;
  for (Eigen::Index i = 0; i < y.size(); ++i) {
    const double p = 1.0 / (1.0 + std::exp(-eta[i]));
    for (int item = 0; item < n; ++item) y[i] += random.uniform() < p;
  }
  return y;
}

Eigen::MatrixXd without(const Eigen::MatrixXd& x, Eigen::Index column) {
  Eigen::MatrixXd rest(x.rows(), x.cols() - 1);
  rest << x.leftCols(column), x.rightCols(x.cols() - column - 1);
  return rest;
}

bool is_found(const Eigen::MatrixXd& x, const Eigen::VectorXd& y, int n, Eigen::Index column,
              double deviance) {
  return fit_binomial(without(x, column), y, n).deviance - deviance > kChiSquared95;
}

}  // namespace

Power power_of(const Design& design, const Questionnaire& questions, int people, int studies,
               std::uint64_t seed, const std::function<void()>& each) {
  const auto terms = std::ssize(design.terms);
  const int n = questions.scored();
  Eigen::VectorXd published(terms);
  for (Eigen::Index j = 0; j < terms; ++j) {
    published[j] = published_estimate(design, static_cast<std::size_t>(j));
  }
  Power power{people, studies, 0.0, {}};
  for (const Term& term : design.terms) power.terms.push_back({term.name});
  for (int study = 0; study < studies; ++study) {
    each();
    const auto number =
        static_cast<std::uint64_t>(study) * 100'000u + static_cast<std::uint64_t>(people);
    const std::uint64_t its_seed = Random(seed, kStudies, number).next();
    Random random(its_seed, kAnswers, 0);
    const Eigen::MatrixXd x = people_of(design, questions, people, its_seed);
    const Eigen::VectorXd y = scores_of(x, published, n, random);
    const Fit full = fit_binomial(x, y, n);
    power.separated += full.converged ? 0.0 : 1.0;
    for (Eigen::Index j = 0; j < terms; ++j) {
      TermPower& term = power.terms[static_cast<std::size_t>(j)];
      if (is_found(x, y, n, j, full.deviance)) term.found += 1.0;
      Eigen::VectorXd nothing = published;
      nothing[j] = 0.0;
      const Eigen::VectorXd other = scores_of(x, nothing, n, random);
      if (is_found(x, other, n, j, fit_binomial(x, other, n).deviance)) term.found_without += 1.0;
    }
  }
  power.separated /= studies;  // until here they are counts
  for (TermPower& term : power.terms) {
    term.found /= studies;
    term.found_without /= studies;
  }
  return power;
}

}  // namespace headpin::study
