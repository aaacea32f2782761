#include "study/questionnaire.h"

#include <algorithm>
#include <cctype>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "study/csv.h"
#include "study/toml_fields.h"

namespace headpin::study {

namespace {

std::string lower(std::string_view text) {
  std::string all(text);
  std::ranges::transform(all, all.begin(), [](unsigned char c) { return std::tolower(c); });
  return all;
}

Texts read_texts(TomlFields& fields, const std::string& key, const Questionnaire& questions) {
  Texts texts;
  for (const auto& [language, text] : fields.named_texts(key)) texts[language] = text;
  for (const std::string& language : questions.languages) {
    if (texts.contains(language)) continue;
    fields.fail(key, fmt::format("has no text for the language '{}'", shown(language)));
  }
  return texts;
}

/// Reads an id that is valid as a name of a column and in a formula of R.
std::string read_id(TomlFields& fields, const std::string& key) {
  const std::string id = fields.text(key);
  const auto plain = [](unsigned char c) { return (c >= 'a' && c <= 'z') || std::isdigit(c); };
  if (id.empty() || id.size() > 32 || std::isdigit(static_cast<unsigned char>(id[0])) ||
      !std::ranges::all_of(id, plain)) {
    fields.refuse(key, "1 to 32 small letters and digits, a letter first");
  }
  return id;
}

/// What is taken for this choice when it is typed: its id, or its text in any language.
std::set<std::string> words_of(const Choice& choice) {
  std::set<std::string> words = {lower(choice.id)};
  for (const auto& [language, text] : choice.text) words.insert(lower(text));
  return words;
}

std::vector<Choice> read_choices(TomlFields& fields, const Questionnaire& questions) {
  std::vector<Choice> choices;
  for (TomlFields& one : fields.tables("answer")) {
    const Choice choice{read_id(one, "id"), read_texts(one, "text", questions)};
    one.finish();
    for (const Choice& other : choices) {
      if (other.id == choice.id) one.refuse("id", "another one than before");
      const std::set<std::string> taken = words_of(other);
      for (const std::string& words : words_of(choice)) {
        if (!taken.contains(words)) continue;
        one.fail("text", fmt::format("must differ from id and texts of the answer '{}'; both have "
                                     "'{}', in small or capital letters",
                                     other.id, shown(words)));
      }
    }
    choices.push_back(choice);
  }
  return choices;
}

Item read_item(TomlFields fields, const Questionnaire& questions) {
  static const std::set<std::string> kTaken = {"participant", "item", "answer", "source"};
  static const std::set<std::string> kOfR = {"break", "else", "for",    "function", "if",
                                             "in",    "next", "repeat", "while"};
  Item item;
  item.id = read_id(fields, "id");
  if (questions.find(item.id)) fields.refuse("id", "another one than before");
  if (kTaken.contains(item.id)) fields.refuse("id", "another word: tables have such a column");
  if (kOfR.contains(item.id)) fields.refuse("id", "another word: R has this one for itself");
  item.text = read_texts(fields, "text", questions);
  item.choices = read_choices(fields, questions);
  if (item.is_scale()) {
    item.low = fields.whole("low", -1000, 1000);
    item.high = fields.whole("high", item.low + 1, 1000);
    item.low_end = read_texts(fields, "low_end", questions);
    item.high_end = read_texts(fields, "high_end", questions);
    if (fields.has("counts_from")) {
      item.counts_from = fields.whole("counts_from", item.low + 1, item.high);
    }
  } else if (item.choices.size() < 2) {
    fields.refuse("answer", "two or more tables, or none where the item has a scale");
  }
  fields.finish();
  return item;
}

}  // namespace

const Item* Questionnaire::find(std::string_view id) const {
  const auto found = std::ranges::find(items, id, &Item::id);
  return found == items.end() ? nullptr : &*found;
}

int Questionnaire::scored() const {
  return static_cast<int>(
      std::ranges::count_if(items, [](const Item& item) { return item.counts_from.has_value(); }));
}

Questionnaire parse_questionnaire(std::string_view toml, const std::string& where) {
  static const std::vector<std::string> kKeys = {
      "name",           "languages",       "item.id",
      "item.text",      "item.low",        "item.high",
      "item.low_end",   "item.high_end",   "item.counts_from",
      "item.answer.id", "item.answer.text"};
  const toml::table table = parse_toml(toml, where, kKeys);
  TomlFields fields(table, where, "");
  Questionnaire questions;
  questions.name = fields.text("name");
  questions.languages = fields.texts("languages");
  for (const TomlFields& one : fields.tables("item")) {
    questions.items.push_back(read_item(one, questions));
  }
  if (questions.items.empty()) fields.refuse("item", "given, at least once");
  fields.finish();
  return questions;
}

std::string allowed(const Item& item) {
  if (item.is_scale()) {
    return fmt::format("a whole number from {} to {}, or {}", item.low, item.high, kNoAnswer);
  }
  std::vector<std::string> ids;
  for (const Choice& choice : item.choices) ids.push_back(choice.id);
  return fmt::format("{} or {}", fmt::join(ids, ", "), kNoAnswer);
}

std::optional<std::string> answer_of(const Item& item, std::string_view given) {
  const std::string text = lower(given);
  if (text == kNoAnswer) return text;
  if (item.is_scale()) {
    const auto value = whole_in(text);
    if (!value || *value < item.low || *value > item.high) return std::nullopt;
    return fmt::format("{}", *value);
  }
  for (const Choice& choice : item.choices) {
    if (text == lower(choice.id)) return choice.id;
    for (const auto& [language, words] : choice.text) {
      if (text == lower(words)) return choice.id;
    }
  }
  return std::nullopt;
}

}  // namespace headpin::study
