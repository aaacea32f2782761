#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// A questionnaire as data: texts in any language, scales and their ends, and which answers count
/// as high.
namespace headpin::study {

using Texts = std::map<std::string, std::string>;  ///< by language

/// One of the answers of an item with a choice.
struct Choice {
  std::string id;  ///< as it is kept
  Texts text;      ///< as it is read
};

struct Item {
  std::string id;
  Texts text;
  int low = 0, high = 0;           ///< of a scale; both 0 for a choice
  Texts low_end, high_end;         ///< what the ends of the scale mean
  std::optional<int> counts_from;  ///< an answer so high, or higher, is one of the score's
  std::vector<Choice> choices;

  bool is_scale() const { return choices.empty(); }
};

struct Questionnaire {
  std::string name;
  std::vector<std::string> languages;  ///< every text is in each; the first is the usual one
  std::vector<Item> items;

  const Item* find(std::string_view id) const;
  /// Items whose high answers are counted.
  int scored() const;
};

/// The text for a question without an answer.
inline constexpr const char* kNoAnswer = "n/a";

/// Reads a questionnaire.
/// @throws std::invalid_argument  naming file, line, key, what was found and what is allowed
Questionnaire parse_questionnaire(std::string_view toml, const std::string& where);

/// "a whole number from 1 to 7, or n/a"
std::string allowed(const Item& item);

/// The answer as it is kept: of a choice its id, whatever of id and texts was given, in capitals or
/// not. Nothing for what is no answer to the item.
std::optional<std::string> answer_of(const Item& item, std::string_view given);

}  // namespace headpin::study
