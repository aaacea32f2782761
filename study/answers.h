#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "study/questionnaire.h"

/// What participants answered.
namespace headpin::study {

// Where an answer is from.
inline constexpr const char* kAsked = "asked";  ///< typed by the participant
inline constexpr const char* kForm = "form";    ///< typed in from paper
inline constexpr const char* kDrawn = "drawn";  ///< from a model: nobody gave it

struct Answer {
  std::string item, answer, source;

  bool operator==(const Answer&) const = default;
};

using Answers = std::vector<Answer>;

/// Null where the item has not been answered.
const Answer* find(const Answers& answers, std::string_view item);

/// The line of names of a participant's answers, and one answer as a line.
std::string answers_heading();
std::string answer_line(const std::string& participant, const Answer& answer);

/// Reads a participant's answers, an answer a row.
///
/// @throws std::invalid_argument  naming file and line, what was expected and what was found: another
///         participant, an item that is not asked, an answer out of range, two for one item
Answers parse_answers(std::string_view text, const std::string& where,
                      const Questionnaire& questions, const std::string& participant);

/// Reads forms that were typed in: a row a participant with a column an item, or an answer a row
/// (`participant`, `item`, `answer`).
///
/// @param names  of the participants in the plan
/// @throws std::invalid_argument  as parse_answers(), also for a participant who is not in the plan
///         or there twice
std::map<std::string, Answers> parse_forms(std::string_view text, const std::string& where,
                                           const Questionnaire& questions,
                                           const std::set<std::string>& names);

/// Items that have no answer yet, in their order.
std::vector<const Item*> missing(const Questionnaire& questions, const Answers& answers);

/// High answers among the items that are scored; nothing while one of them has no number.
std::optional<int> score_of(const Questionnaire& questions, const Answers& answers);

}  // namespace headpin::study
