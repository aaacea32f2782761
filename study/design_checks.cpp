#include "study/design_checks.h"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "study/people.h"
#include "study/toml_fields.h"

namespace headpin::study {

namespace {

/// @throws std::invalid_argument  "FILE:LINE: KEY must be EXPECTED, found 'FOUND'"
[[noreturn]] void refuse_name(const std::string& where, int line, const char* key,
                              const std::string& expected, const std::string& found) {
  throw std::invalid_argument(
      fmt::format("{}:{}: {} must be {}, found '{}'", where, line, key, expected, shown(found)));
}

/// The item of that id.
/// @param others  what may be named in place of an item: "a factor (E, F) or "
const Item& require_item(const Questionnaire& questions, const std::string& id,
                         const std::string& others, const std::string& where, int line,
                         const char* key) {
  if (const Item* item = questions.find(id)) return *item;
  std::vector<std::string> ids;
  for (const Item& item : questions.items) ids.push_back(item.id);
  refuse_name(where, line, key, fmt::format("{}an item ({})", others, fmt::join(ids, ", ")), id);
}

void require_answer(const Item& item, const std::string& answer, const std::string& where, int line,
                    const char* key) {
  if (answer_of(item, answer) == answer) return;
  refuse_name(where, line, key, fmt::format("an answer of item '{}' ({})", item.id, allowed(item)),
              answer);
}

/// Refuses items that are called as a column of participants.csv.
void check_columns(const Design& design, const Questionnaire& questions, const std::string& where) {
  std::set<std::string> names;
  for (const Column& column : people_columns(design, questions)) {
    if (names.insert(column.name).second) continue;
    throw std::invalid_argument(fmt::format(
        "{}: its questionnaire has an item '{}'; expected another id: tables of participants have "
        "such a column",
        where, column.name));
  }
}

/// Refuses published answers without an answer where a term needs one.
void check_published(const Design& design, const PublishedAnswers& one, const Item& item,
                     const std::string& where) {
  const bool is_used = std::ranges::find(design.terms, item.id, &Term::of) != design.terms.end();
  for (const auto& [answer, count] : one.counts) {
    require_answer(item, answer, where, one.counts_line, "a name in published.counts");
    if (!is_used || count == 0 || answer != kNoAnswer) continue;
    refuse_name(where, one.counts_line, "a name in published.counts",
                fmt::format("an answer of item '{}', because a term uses it", item.id), answer);
  }
}

}  // namespace

void check_items(const Design& design, const Questionnaire& questions, const std::string& where) {
  std::vector<std::string> letters;
  for (const Factor& factor : design.factors) letters.push_back(factor.letter);
  const std::string factors = fmt::format("a factor ({}) or ", fmt::join(letters, ", "));
  for (const Term& term : design.terms) {
    if (term.of.empty()) continue;
    if (std::ranges::find(letters, term.of) != letters.end()) {
      if (term.is.empty() || term.is == "0" || term.is == "1") continue;
      refuse_name(where, term.is_line, "term.is", "0 or 1, a level of the factor", term.is);
    }
    const Item& item = require_item(questions, term.of, factors, where, term.of_line, "term.of");
    if (!term.is.empty()) require_answer(item, term.is, where, term.is_line, "term.is");
    if (term.is.empty() && !item.is_scale()) {
      refuse_name(where, term.of_line, "term.of",
                  "with `is`, an answer of it, where the item has answers to choose from", term.of);
    }
    if (!item.counts_from) continue;
    refuse_name(where, term.of_line, "term.of", "an item that is no part of the score", term.of);
  }
  for (const PublishedAnswers& one : design.published) {
    const Item& item =
        require_item(questions, one.item, "", where, one.item_line, "published.item");
    check_published(design, one, item, where);
  }
  if (!design.terms.empty() && questions.scored() == 0) {
    throw std::invalid_argument(
        fmt::format("{}: its questionnaire has no item with `counts_from`; expected one or more: "
                    "they make the score that the terms explain",
                    where));
  }
  check_columns(design, questions, where);
}

}  // namespace headpin::study
