#pragma once

#include <optional>
#include <string>
#include <vector>

#include "study/answers.h"
#include "study/plan.h"

/// The linear predictor of a design: which number each term has for whom.
namespace headpin::study {

/// The number of a term for one participant; nothing where an answer that it is of is missing.
std::optional<double> value_of(const Term& term, const Design& design, const Allotted& allotted,
                               const Answers& answers);

/// The numbers of all terms, in their order; nothing where one of them is.
std::optional<std::vector<double>> values_of(const Design& design, const Allotted& allotted,
                                             const Answers& answers);

/// The same term as R computes it from the columns of participants.csv.
std::string in_r(const Term& term, const Design& design);

/// @throws std::invalid_argument  where the term has no published estimate
double published_estimate(const Design& design, std::size_t term);

/// The probability that the published model has for a high answer.
/// @throws std::invalid_argument  where a term has no published estimate
double published_probability(const Design& design, const std::vector<double>& values);

/// All answers of a virtual participant, which are drawn.
///
/// Those that were counted when the model was published are dealt, like cards, from what was given
/// then: as many participants as were counted have the same margins. Items of the score are high with
/// the probability of the published model, each for itself, and 6 or 7 (or what else is high) is
/// equally probable then, as is any lower answer else. Other items get any of their answers.
///
/// @throws std::invalid_argument  where a term has no published estimate
Answers draw_answers(const Design& design, const Questionnaire& questions, std::uint64_t seed,
                     const PlannedParticipant& participant);

}  // namespace headpin::study
