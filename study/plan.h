#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "study/allotment.h"
#include "study/csv.h"

/// The plan of a study: one row per participant and version, with all values.
namespace headpin::study {

/// One of the two versions of a participant.
struct PlannedGame {
  bool changed = false;             ///< it has the changed value
  bool red = false;                 ///< it is behind the red button
  std::vector<std::string> values;  ///< by factor
};

struct PlannedParticipant {
  std::string id;
  std::int64_t place = 0;  ///< of the allotment
  Allotted allotted;
  /// Name of the participant whose conditions these are, who dropped out.
  std::string replaces = {};

  bool operator==(const PlannedParticipant&) const = default;
};

using Plan = std::vector<PlannedParticipant>;

/// Both versions, in the order in which they are played.
std::array<PlannedGame, 2> games_of(const Design& design, const Allotted& allotted);
/// "010"
const std::string& cell_of(const Design& design, const PlannedParticipant& participant);
/// "elasticity"
const std::string& changed_key_of(const Design& design, const PlannedParticipant& participant);

/// The error in the name of a participant; empty for a valid name. Files and BIDS subjects have
/// this name, so it must be 1 to 32 letters and digits.
std::string wrong_with_name(std::string_view name);

/// Adds participants up to this number, without those who were replaced. They get the lowest free
/// places, and new names: p001, p002 (a spreadsheet would change 001 to 1).
///
/// @param taken_names  further names that nobody new gets: those with sessions or answers
/// @throws std::invalid_argument  if there are more already
void extend(Plan& plan, const Design& design, std::uint64_t seed, int people,
            const std::set<std::string>& taken_names = {});

/// Adds a participant who gets the conditions of one who dropped out.
/// @param taken_names  as for extend()
/// @throws std::invalid_argument  for a name that is not in the plan or is replaced already
void replace(Plan& plan, const std::string& dropped_out,
             const std::set<std::string>& taken_names = {});

/// The replaced participants, with their replacements.
std::map<std::string, std::string> replaced(const Plan& plan);

/// As CSV: a line of names, two rows a participant.
std::string to_csv(const Plan& plan, const Design& design);

/// As CSV, with the columns of an earlier table that are none of the plan's. They are behind the
/// plan's, with their cells by participant and game. Cells of new participants are empty.
///
/// @param before  a table that parse_plan() takes
std::string to_csv(const Plan& plan, const Design& design, const CsvTable& before);

/// Reads the plan; the order of rows does not matter. Other columns are allowed.
///
/// @throws std::invalid_argument  naming file, line and column, what was expected and what was found: a
///         cell that is none of the design's, values that are not the cell's, a row twice, one
///         missing, a name that is none, someone who replaces himself
Plan parse_plan(std::string_view text, const std::string& where, const Design& design);

}  // namespace headpin::study
