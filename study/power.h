#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "study/design.h"
#include "study/questionnaire.h"

/// The statistical power of a study under the published model.
namespace headpin::study {

struct TermPower {
  std::string term;
  double found = 0.0;          ///< share of studies in which dropping it is significant at 5 %
  double found_without = 0.0;  ///< the same share if the term has no effect: false positives
};

struct Power {
  int people = 0, studies = 0;
  double separated = 0.0;  ///< share of studies with an estimate that goes to infinity
  std::vector<TermPower> terms;
};

/// Simulates studies: people are allotted as by `plan`, their answers are drawn from the published
/// model, and the model is fitted with all terms and without each one. A term is found if the
/// deviance grows by more than the 95 % quantile of chi-squared with one degree of freedom. This is
/// valid with separation too, where an estimate and its error are useless.
///
/// @param each  called before each study; may throw
/// @throws std::invalid_argument  where a term has no published estimate
Power power_of(const Design& design, const Questionnaire& questions, int people, int studies,
               std::uint64_t seed, const std::function<void()>& each);

}  // namespace headpin::study
