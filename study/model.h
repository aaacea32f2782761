#pragma once

#include <optional>
#include <string>
#include <vector>

#include "study/answers.h"
#include "study/plan.h"

/// The linear predictor of a design: the values of its terms for a participant.
namespace headpin::study {

/// The value of a term for one participant; nothing if its answer is missing.
std::optional<double> value_of(const Term& term, const Design& design, const Allotted& allotted,
                               const Answers& answers);

/// The values of all terms, in order; nothing if one is missing.
std::optional<std::vector<double>> values_of(const Design& design, const Allotted& allotted,
                                             const Answers& answers);

/// The term as an R expression of the columns of participants.csv.
std::string in_r(const Term& term, const Design& design);

/// @throws std::invalid_argument  where the term has no published estimate
double published_estimate(const Design& design, std::size_t term);

/// The probability of a high answer by the published model.
/// @throws std::invalid_argument  where a term has no published estimate
double published_probability(const Design& design, const std::vector<double>& values);

/// Whether answers can be drawn: the design has terms, each with a published estimate.
bool has_published_model(const Design& design);

/// Draws all answers of a virtual participant.
///
/// Answers with published counts are drawn without replacement from those counts, so the same
/// number of participants has the same margins. Each item of the score is high with the probability
/// of the published model; the high answers (such as 6 and 7) are equally probable, and so are the
/// lower ones. Other items get any of their answers with equal probability.
///
/// @throws std::invalid_argument  where a term has no published estimate
Answers draw_answers(const Design& design, const Questionnaire& questions, std::uint64_t seed,
                     const PlannedParticipant& participant);

}  // namespace headpin::study
