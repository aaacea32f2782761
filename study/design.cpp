#include "study/design.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "study/csv.h"
#include "study/toml_fields.h"

namespace headpin::study {

namespace {

constexpr int kMostPeople = 100'000;

const std::vector<std::string>& keys_of_designs() {
  static const std::vector<std::string> kKeys = {
      "seed",       "name",         "title",          "scenario",          "questionnaire",
      "throws",     "deviance",     "factor.letter",  "factor.key",        "factor.levels",
      "row.cell",   "row.changed",  "row.people",     "term.name",         "term.of",
      "term.is",    "term.changed", "term.unless",    "term.estimate",     "term.se",
      "note.table", "note.text",    "published.item", "published.changed", "published.counts"};
  return kKeys;
}

std::string keys_of(const Design& design) {
  std::vector<std::string> keys;
  for (const Factor& factor : design.factors) keys.push_back(factor.key);
  return fmt::format("{}", fmt::join(keys, ", "));
}

Factor read_factor(TomlFields fields) {
  static const std::set<std::string> kKeys = {"elasticity", "friction", "shape", "detection",
                                              "iterations"};
  Factor factor;
  factor.letter = fields.text("letter");
  if (factor.letter.size() != 1 || factor.letter[0] < 'A' || factor.letter[0] > 'Z') {
    fields.refuse("letter", "one letter from A to Z");
  }
  factor.key = fields.text("key");
  if (!kKeys.contains(factor.key)) {
    fields.refuse("key",
                  fmt::format("what a version of a scenario has: {}", fmt::join(kKeys, ", ")));
  }
  const std::vector<std::string> levels = fields.texts("levels");
  if (levels.size() != 2 || levels[0] == levels[1]) fields.refuse("levels", "two different values");
  factor.levels = {levels[0], levels[1]};
  factor.levels_line = fields.line("levels");
  fields.finish();
  return factor;
}

std::optional<std::size_t> read_factor_key(TomlFields& fields, const std::string& key,
                                           const Design& design) {
  const std::string name = fields.text(key, "");
  if (name.empty()) return std::nullopt;
  const auto found = design.factor_of(name);
  if (!found) fields.refuse(key, "the key of a factor: " + keys_of(design));
  return found;
}

DesignRow read_row(TomlFields fields, const Design& design) {
  DesignRow row;
  row.cell = fields.text("cell");
  const bool digits = row.cell.find_first_not_of("01") == std::string::npos;
  if (!digits || row.cell.size() != design.factors.size()) {
    fields.refuse("cell", fmt::format("{} digits, each 0 or 1", design.factors.size()));
  }
  const auto changed = read_factor_key(fields, "changed", design);
  if (!changed) fields.refuse("changed", "the key of a factor: " + keys_of(design));
  row.changed = *changed;
  row.people = fields.whole("people", 1, 1000);
  fields.finish();
  for (const DesignRow& other : design.rows) {
    if (other.cell != row.cell || other.changed != row.changed) continue;
    fields.refuse("cell", "another one: this cell with this change exists already");
  }
  return row;
}

Term read_term(TomlFields fields, const Design& design) {
  Term term;
  term.name = fields.text("name");
  term.of = fields.text("of", "");
  term.of_line = fields.line("of");
  term.is = fields.text("is", "");
  term.is_line = fields.line("is");
  if (!term.is.empty() && term.of.empty()) fields.refuse("of", "an item where `is` is given");
  term.changed = read_factor_key(fields, "changed", design);
  term.unless = read_factor_key(fields, "unless", design);
  if (fields.has("estimate")) term.estimate = fields.number("estimate");
  if (fields.has("se")) term.se = fields.number("se");
  fields.finish();
  for (const Term& other : design.terms) {
    if (other.name == term.name) fields.refuse("name", "another name: this one exists already");
  }
  return term;
}

PublishedAnswers read_published(TomlFields fields, const Design& design) {
  PublishedAnswers answers;
  answers.item = fields.text("item");
  answers.item_line = fields.line("item");
  answers.changed = read_factor_key(fields, "changed", design);
  answers.counts = fields.counts("counts", kMostPeople);
  answers.counts_line = fields.line("counts");
  int sum = 0;
  for (const auto& [answer, count] : answers.counts) sum += count;
  if (sum == 0) fields.refuse("counts", "those of one person or more");
  for (const PublishedAnswers& other : design.published) {
    const bool same = other.item == answers.item && other.changed == answers.changed;
    if (same) fields.refuse("item", "another one than before, or with another `changed`");
  }
  fields.finish();
  return answers;
}

}  // namespace

std::string assignment(const Factor& factor, const std::string& colour, const std::string& level) {
  const bool word = factor.key == "shape" || factor.key == "detection";
  const char* quote = word ? "'" : "";
  return fmt::format("version.{}.{}={}{}{}", colour, factor.key, quote, level, quote);
}

int Design::block() const {
  int people = 0;
  for (const DesignRow& row : rows) people += row.people;
  return people;
}

std::optional<std::size_t> Design::factor_of(std::string_view key) const {
  const auto found = std::ranges::find(factors, key, &Factor::key);
  if (found == factors.end()) return std::nullopt;
  return static_cast<std::size_t>(found - factors.begin());
}

std::string Design::other_cell(const DesignRow& row) const {
  std::string cell = row.cell;
  cell[row.changed] = cell[row.changed] == '0' ? '1' : '0';
  return cell;
}

std::string Design::letters() const {
  std::string all;
  for (const Factor& factor : factors) all += factor.letter;
  return all;
}

Design parse_design(std::string_view toml, const std::string& where) {
  const toml::table table = parse_toml(toml, where, keys_of_designs());
  TomlFields fields(table, where, "");
  Design design;
  if (fields.has("seed")) design.seed = fields.seed("seed");
  design.name = fields.text("name");
  design.title = fields.text("title", "");
  design.scenario = fields.text("scenario");
  design.scenario_line = fields.line("scenario");
  design.questionnaire = fields.text("questionnaire");
  design.questionnaire_line = fields.line("questionnaire");
  design.throws = fields.whole("throws", 1, 1000, 10);
  if (fields.has("deviance")) design.deviance = fields.number("deviance");
  for (TomlFields& one : fields.tables("factor")) {
    const Factor factor = read_factor(one);
    for (const Factor& other : design.factors) {
      if (other.letter == factor.letter) one.refuse("letter", "another one than before");
      if (other.key == factor.key) one.refuse("key", "another one than before");
    }
    design.factors.push_back(factor);
  }
  if (design.factors.empty() || design.factors.size() > 5) fields.refuse("factor", "1 to 5 tables");
  for (const TomlFields& one : fields.tables("row")) design.rows.push_back(read_row(one, design));
  if (design.rows.empty()) fields.refuse("row", "given, at least once");
  for (const TomlFields& one : fields.tables("term")) {
    design.terms.push_back(read_term(one, design));
  }
  for (const TomlFields& one : fields.tables("published")) {
    design.published.push_back(read_published(one, design));
  }
  for (TomlFields& one : fields.tables("note")) {
    design.notes.push_back({one.text("table"), one.text("text")});
    one.finish();
  }
  fields.finish();
  return design;
}

}  // namespace headpin::study
