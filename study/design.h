#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// The design of an experiment as data: parameters, allotment, questions, model.
///
/// As in Uno & Slater 1997, every participant plays two versions of a game. One has the values of a
/// cell; in the other one, one parameter is different.
namespace headpin::study {

/// A parameter that varies, with two levels (the paper's Table 1).
struct Factor {
  std::string letter;                 ///< in the name of a cell: E of EFS
  std::string key;                    ///< of a version of the scenario: elasticity
  std::array<std::string, 2> levels;  ///< its value at 0 and at 1, as the plan writes it
  int levels_line = 0;                ///< of the design's file, as are the other lines
};

/// "version.red.shape='true'": how a level is put into a scenario.
std::string assignment(const Factor& factor, const std::string& colour, const std::string& level);

/// The number of people for one cell and one changed parameter (a row of the paper's Table 2).
struct DesignRow {
  std::string cell;         ///< a digit a factor, 0 or 1: "010"
  std::size_t changed = 0;  ///< factor whose value is the other one in one of the two versions
  int people = 1;           ///< of a block
};

/// One term of the linear predictor: a value, times 1 or 0 by the conditions.
struct Term {
  std::string name;  ///< as it is published
  std::string of;    ///< a factor's letter, an item of the questionnaire; empty: 1
  std::string
      is;  ///< of an item: 1 where that is the answer, else 0; of a factor: its level, 0 or 1
  std::optional<std::size_t> changed;  ///< 0 where another factor changes
  std::optional<std::size_t> unless;   ///< 0 where this factor changes
  std::optional<double> estimate, se;  ///< as published
  int of_line = 0, is_line = 0;
};

/// How often an answer was given, as published.
struct PublishedAnswers {
  std::string item;
  std::optional<std::size_t> changed;  ///< among those for whom this factor changed
  std::vector<std::pair<std::string, int>> counts;
  int item_line = 0, counts_line = 0;
};

/// A note for readers of a table.
struct Note {
  std::string table, text;
};

struct Design {
  std::string name, title;
  std::string scenario, questionnaire;  ///< names of those that come along, or files
  int scenario_line = 0, questionnaire_line = 0;
  int throws = 10;                    ///< of each version, of a virtual participant
  std::optional<std::uint64_t> seed;  ///< of the allotment; a study has one
  std::vector<Factor> factors;
  std::vector<DesignRow> rows;
  std::vector<Term> terms;         ///< terms of the model; without terms nothing is fitted
  std::optional<double> deviance;  ///< of the published fit
  std::vector<Note> notes;
  std::vector<PublishedAnswers> published;  ///< virtual participants draw from these

  int block() const;  ///< people of all rows
  std::optional<std::size_t> factor_of(std::string_view key) const;
  /// "000" and the second factor give "010".
  std::string other_cell(const DesignRow& row) const;
  /// "EFS"
  std::string letters() const;
};

/// Reads a design.
/// @param where  name of the file, for messages
/// @throws std::invalid_argument  naming file, line, key, what was found and what is allowed
Design parse_design(std::string_view toml, const std::string& where);

}  // namespace headpin::study
