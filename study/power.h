#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "study/design.h"
#include "study/questionnaire.h"

/// How often a study would find what the published model says.
namespace headpin::study {

struct TermPower {
  std::string term;
  double found = 0.0;          ///< share of studies in which dropping it is significant at 5 %
  double found_without = 0.0;  ///< likewise where it has no effect: false alarms
};

struct Power {
  int people = 0, studies = 0;
  double separated = 0.0;  ///< share of studies with an estimate that goes to infinity
  std::vector<TermPower> terms;
};

/// Plays so many studies of so many people: allotted as by `plan`, answers drawn from the published
/// model, the model fitted with all terms and with all but one. A term is found where the deviance
/// grows by more than chi-squared's 95 % point with one degree of freedom; that holds with separation
/// too, where an estimate and its error say nothing.
///
/// @param each  called before each study; may throw
/// @throws std::invalid_argument  where a term has no published estimate
Power power_of(const Design& design, const Questionnaire& questions, int people, int studies,
               std::uint64_t seed, const std::function<void()>& each);

/// The shares over the number of people, as an SVG document.
/// @param all  of the same design, the fewest people first
std::string power_svg(const std::vector<Power>& all);

}  // namespace headpin::study
