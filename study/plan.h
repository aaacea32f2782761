#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "study/allotment.h"
#include "study/csv.h"

/// The plan of a study: one row a participant and version, every value spelled out.
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
  std::string replaces = {};  ///< who dropped out and whose conditions these are; empty for nobody

  bool operator==(const PlannedParticipant&) const = default;
};

using Plan = std::vector<PlannedParticipant>;

/// Both versions, in the order in which they are played.
std::array<PlannedGame, 2> games_of(const Design& design, const Allotted& allotted);
/// "010"
const std::string& cell_of(const Design& design, const PlannedParticipant& participant);
/// "elasticity"
const std::string& changed_key_of(const Design& design, const PlannedParticipant& participant);

/// What is wrong with the name of a participant; empty where nothing is. It becomes the name of
/// files, and of a subject in BIDS, so it is 1 to 32 letters and digits.
std::string wrong_with_name(std::string_view name);

/// Adds participants until there are so many besides those who are replaced. They get the places
/// that are free, the lowest first, and names that nobody has: p001, p002. (A spreadsheet would make 1 of
/// 001.)
///
/// @throws std::invalid_argument  where there are more already
void extend(Plan& plan, const Design& design, std::uint64_t seed, int people);

/// Adds one who gets the conditions of somebody who dropped out.
/// @throws std::invalid_argument  for a name that is not in the plan or is replaced already
void replace(Plan& plan, const std::string& dropped_out);

/// Who is replaced, and by whom.
std::map<std::string, std::string> replaced(const Plan& plan);

/// As CSV: a line of names, two rows a participant.
std::string to_csv(const Plan& plan, const Design& design);

/// Reads it back, in whatever order its rows are.
///
/// @throws std::invalid_argument  naming file and line, what was expected and what was found: a cell
///         that is none of the design's, values that are not the cell's, a row twice, one missing,
///         a name that is none
Plan parse_plan(std::string_view text, const std::string& where, const Design& design);

}  // namespace headpin::study
