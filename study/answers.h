#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "study/questionnaire.h"

/// The answers of participants.
namespace headpin::study {

// Sources of an answer.
inline constexpr const char* kAsked = "asked";  ///< typed by the participant
inline constexpr const char* kForm = "form";    ///< typed in from paper
inline constexpr const char* kDrawn = "drawn";  ///< drawn from a model

struct Answer {
  std::string item, answer, source;

  bool operator==(const Answer&) const = default;
};

using Answers = std::vector<Answer>;

/// Null if the item has not been answered.
const Answer* find(const Answers& answers, std::string_view item);

/// The header line of a participant's answers, and one answer as a line.
std::string answers_heading();
std::string answer_line(const std::string& participant, const Answer& answer);

/// Reads a participant's answers, one per row.
///
/// @throws std::invalid_argument  naming file and line, what was expected and what was found: other
///         columns than those of answers_heading(), another participant, an item that is not asked, an answer out of range, two for one item
Answers parse_answers(std::string_view text, const std::string& where,
                      const Questionnaire& questions, const std::string& participant);

/// Reads typed forms: one row per participant with one column per item, or one answer per row
/// (`participant`, `item`, `answer`).
///
/// @param names  of the participants in the plan
/// @throws std::invalid_argument  as parse_answers(), also for a participant who is not in the plan
///         or there twice
std::map<std::string, Answers> parse_forms(std::string_view text, const std::string& where,
                                           const Questionnaire& questions,
                                           const std::set<std::string>& names);

/// Items without an answer, in order.
std::vector<const Item*> missing(const Questionnaire& questions, const Answers& answers);

/// The number of high answers among the scored items; nothing if one of them has no number.
std::optional<int> score_of(const Questionnaire& questions, const Answers& answers);

}  // namespace headpin::study
