#include "study/plan.h"

#include <algorithm>
#include <cctype>
#include <optional>
#include <set>
#include <stdexcept>

#include <fmt/format.h>

namespace headpin::study {

namespace {

constexpr const char* kBase = "base";
constexpr const char* kChanged = "changed";

/// A name in small letters. On disks that ignore case, such names are equal.
std::string folded(const std::string& id) {
  std::string text = id;
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

/// The names that a new participant does not get, in small letters.
std::set<std::string> names_not_free(const Plan& plan, const std::set<std::string>& taken) {
  std::set<std::string> names;
  for (const std::string& name : taken) names.insert(folded(name));
  for (const PlannedParticipant& one : plan) names.insert(folded(one.id));
  return names;
}

/// The first free name from this number on.
std::string free_name(const std::set<std::string>& not_free, std::size_t number) {
  for (;; ++number) {
    const std::string name = fmt::format("p{:03}", number);
    if (!not_free.contains(name)) return name;
  }
}

/// One row of the table, read.
struct PlanRow {
  const CsvRow* at;
  int game;
  bool changed, red;
  PlannedParticipant participant;
};

std::string one_of_rows(const Design& design) {
  std::set<std::string> cells;
  for (const DesignRow& row : design.rows) cells.insert(row.cell);
  std::string all;
  for (const std::string& cell : cells) all += (all.empty() ? "" : ", ") + cell;
  return all;
}

std::size_t read_design_row(const CsvTable& table, const CsvRow& at, const Design& design) {
  std::string cell = table.cell(at, "cell");
  // A spreadsheet treats 010 as a number and writes 10.
  if (const auto number = whole_in(cell); number && cell.size() < design.factors.size()) {
    cell = fmt::format("{:0{}}", *number, design.factors.size());
  }
  const std::string& changed = table.cell(at, "changed");
  bool is_cell = false;
  for (std::size_t i = 0; i < design.rows.size(); ++i) {
    if (design.rows[i].cell != cell) continue;
    is_cell = true;
    if (design.factors[design.rows[i].changed].key == changed) return i;
  }
  if (!is_cell)
    refuse_cell(table, at, "cell", "a cell of the design (" + one_of_rows(design) + ")");
  refuse_cell(table, at, "changed", fmt::format("a parameter that changes in cell {}", cell));
}

bool read_choice(const CsvTable& table, const CsvRow& at, const char* column, const char* yes,
                 const char* no) {
  const std::string& cell = table.cell(at, column);
  if (cell != yes && cell != no) refuse_cell(table, at, column, fmt::format("{} or {}", yes, no));
  return cell == yes;
}

std::string read_name(const CsvTable& table, const CsvRow& at, const char* column) {
  const std::string& name = table.cell(at, column);
  if (const std::string wrong = wrong_with_name(name); !wrong.empty()) {
    refuse_cell(table, at, column, fmt::format("the name of a participant ({})", wrong));
  }
  return name;
}

/// Compares the values in a row with those that follow from its cell and its changed parameter.
void check_values(const CsvTable& table, const PlanRow& row, const Design& design) {
  const std::string cell = design.rows[row.participant.allotted.row].cell;
  const auto games = games_of(design, row.participant.allotted);
  const PlannedGame& game = games[0].changed == row.changed ? games[0] : games[1];
  for (std::size_t i = 0; i < design.factors.size(); ++i) {
    const std::string& found = table.cell(*row.at, design.factors[i].key);
    const auto a = number_in(table, found), b = number_in(table, game.values[i]);
    if (found == game.values[i] || (a && b && *a == *b)) continue;
    const bool truth = game.values[i] == "true" || game.values[i] == "false";
    if (truth && folded(found) == game.values[i]) continue;  // a spreadsheet writes TRUE
    refuse_cell(table, *row.at, design.factors[i].key,
                fmt::format("{} in the {} version of cell {}", game.values[i],
                            row.changed ? kChanged : kBase, cell));
  }
}

PlanRow read_plan_row(const CsvTable& table, const CsvRow& at, const Design& design) {
  PlanRow row{&at, 0, false, false, {}};
  row.participant.id = read_name(table, at, "participant");
  const auto place = whole_in(table.cell(at, "place"));
  if (!place || *place < 1) refuse_cell(table, at, "place", "a whole number from 1 on");
  row.participant.place = *place - 1;
  row.participant.allotted.row = read_design_row(table, at, design);
  row.game = read_choice(table, at, "game", "1", "2") ? 1 : 2;
  row.changed = read_choice(table, at, "version", kChanged, kBase);
  row.red = read_choice(table, at, "colour", "red", "blue");
  row.participant.allotted.changed_first = row.changed == (row.game == 1);
  row.participant.allotted.base_is_red = row.red != row.changed;
  if (!table.cell(at, "replaces").empty()) {
    row.participant.replaces = read_name(table, at, "replaces");
  }
  check_values(table, row, design);
  return row;
}

/// Compares a row with the other game of its participant: they differ in version and colour alone.
void require_pair(const CsvTable& table, const PlanRow& row, const PlanRow& other,
                  const Design& design) {
  const auto require_same = [&](const char* column, bool same) {
    if (same) return;
    const std::string& expected = table.cell(*other.at, column);
    refuse_cell(table, *row.at, column,
                fmt::format("{} as in line {} (the other game of {})",
                            expected.empty() ? "nothing" : shown(expected), other.at->line,
                            other.participant.id),
                shown(table.cell(*row.at, column)));
  };
  const auto require_another = [&](const char* column, bool same) {
    if (!same) return;
    refuse_cell(table, *row.at, column,
                fmt::format("another one than in line {} (the other game of {})", other.at->line,
                            other.participant.id));
  };
  const PlannedParticipant &one = row.participant, &two = other.participant;
  require_same("place", one.place == two.place);
  require_same("cell", cell_of(design, one) == cell_of(design, two));
  require_same("changed", one.allotted.row == two.allotted.row);
  require_another("version", row.changed == other.changed);
  require_another("colour", row.red == other.red);
  require_same("replaces", one.replaces == two.replaces);
}

void take(const CsvTable& table, const PlanRow& row, const Design& design, Plan& plan,
          std::map<std::string, std::vector<PlanRow>>& rows) {
  std::vector<PlanRow>& others = rows[folded(row.participant.id)];
  for (const PlanRow& other : others) {
    if (other.participant.id != row.participant.id) {
      refuse_cell(table, *row.at, "participant",
                  fmt::format("a name that differs from that of line {} in more than capitals",
                              other.at->line));
    }
    if (other.game == row.game) {
      refuse_cell(table, *row.at, "game",
                  fmt::format("the other game of {}: this one is in line {}", row.participant.id,
                              other.at->line));
    }
    require_pair(table, row, other, design);
  }
  if (others.empty()) plan.push_back(row.participant);
  others.push_back(row);
}

}  // namespace

std::array<PlannedGame, 2> games_of(const Design& design, const Allotted& allotted) {
  const DesignRow& row = design.rows[allotted.row];
  const auto game = [&](bool changed) {
    const std::string cell = changed ? design.other_cell(row) : row.cell;
    PlannedGame made{changed, changed != allotted.base_is_red, {}};
    for (std::size_t i = 0; i < cell.size(); ++i) {
      made.values.push_back(design.factors[i].levels[cell[i] == '1' ? 1 : 0]);
    }
    return made;
  };
  return {game(allotted.changed_first), game(!allotted.changed_first)};
}

const std::string& cell_of(const Design& design, const PlannedParticipant& participant) {
  return design.rows[participant.allotted.row].cell;
}

const std::string& changed_key_of(const Design& design, const PlannedParticipant& participant) {
  return design.factors[design.rows[participant.allotted.row].changed].key;
}

std::string wrong_with_name(std::string_view name) {
  const auto plain = [](unsigned char c) { return c < 0x80 && std::isalnum(c); };
  if (!name.empty() && name.size() <= 32 && std::ranges::all_of(name, plain)) return {};
  return "1 to 32 letters from a to z and digits, as file names and BIDS take them";
}

void extend(Plan& plan, const Design& design, std::uint64_t seed, int people,
            const std::set<std::string>& taken_names) {
  const auto there = static_cast<int>(plan.size() - replaced(plan).size());
  if (people < there) {
    throw std::invalid_argument(
        fmt::format("the plan has {} participants, and none can be removed; expected that many or "
                    "more, found {}",
                    there, people));
  }
  std::set<std::int64_t> taken;
  for (const PlannedParticipant& one : plan) taken.insert(one.place);
  std::set<std::string> not_free = names_not_free(plan, taken_names);
  std::int64_t place = 0;
  for (int i = there; i < people; ++i) {
    while (taken.contains(place)) ++place;
    taken.insert(place);
    plan.push_back({free_name(not_free, plan.size() + 1), place, allot(design, seed, place)});
    not_free.insert(plan.back().id);
  }
}

void replace(Plan& plan, const std::string& dropped_out, const std::set<std::string>& taken_names) {
  const auto found = std::ranges::find(plan, dropped_out, &PlannedParticipant::id);
  if (found == plan.end()) {
    throw std::invalid_argument(fmt::format("no participant '{}' in the plan", shown(dropped_out)));
  }
  if (const auto by = replaced(plan); by.contains(dropped_out)) {
    throw std::invalid_argument(
        fmt::format("{} was already replaced by {}", dropped_out, by.at(dropped_out)));
  }
  PlannedParticipant other = *found;
  other.id = free_name(names_not_free(plan, taken_names), plan.size() + 1);
  other.replaces = dropped_out;
  plan.push_back(other);
}

std::map<std::string, std::string> replaced(const Plan& plan) {
  std::map<std::string, std::string> all;
  for (const PlannedParticipant& one : plan) {
    if (!one.replaces.empty()) all[one.replaces] = one.id;
  }
  return all;
}

std::string to_csv(const Plan& plan, const Design& design) {
  std::vector<std::string> names = {"participant", "place",   "cell",  "changed",
                                    "game",        "version", "colour"};
  for (const Factor& factor : design.factors) names.push_back(factor.key);
  names.emplace_back("replaces");
  std::string text = csv_line(names);
  for (const PlannedParticipant& one : plan) {
    const auto games = games_of(design, one.allotted);
    for (std::size_t i = 0; i < games.size(); ++i) {
      std::vector<std::string> cells = {one.id,
                                        fmt::format("{}", one.place + 1),
                                        cell_of(design, one),
                                        changed_key_of(design, one),
                                        fmt::format("{}", i + 1),
                                        games[i].changed ? kChanged : kBase,
                                        games[i].red ? "red" : "blue"};
      cells.insert(cells.end(), games[i].values.begin(), games[i].values.end());
      cells.push_back(one.replaces);
      text += csv_line(cells);
    }
  }
  return text;
}

std::string to_csv(const Plan& plan, const Design& design, const CsvTable& before) {
  const CsvTable now = parse_csv(to_csv(plan, design), before.where);
  std::vector<std::size_t> kept;
  std::vector<std::string> names = now.columns;
  for (std::size_t i = 0; i < before.columns.size(); ++i) {
    if (now.find(before.columns[i])) continue;
    kept.push_back(i);
    names.push_back(before.columns[i]);
  }
  const auto key = [](const CsvTable& table, const CsvRow& row) {
    return std::pair(table.cell(row, "participant"), table.cell(row, "game"));
  };
  std::map<std::pair<std::string, std::string>, const CsvRow*> rows;
  for (const CsvRow& row : before.rows) rows[key(before, row)] = &row;
  std::string text = csv_line(names);
  for (const CsvRow& row : now.rows) {
    std::vector<std::string> cells = row.cells;
    const auto old = rows.find(key(now, row));
    for (const std::size_t i : kept) {
      cells.push_back(old == rows.end() ? "" : old->second->cells[i]);
    }
    text += csv_line(cells);
  }
  return text;
}

namespace {

/// Whether those whom a participant replaces, one after the other, come back to that participant.
bool begins_nowhere(const Plan& plan, const PlannedParticipant& last) {
  std::string whom = last.replaces;
  for (std::size_t steps = 0; steps < plan.size() && !whom.empty(); ++steps) {
    if (whom == last.id) return true;
    const auto next = std::ranges::find(plan, whom, &PlannedParticipant::id);
    whom = next == plan.end() ? "" : next->replaces;
  }
  return false;
}

}  // namespace

Plan parse_plan(std::string_view text, const std::string& where, const Design& design) {
  const CsvTable table = parse_csv(text, where);
  Plan plan;
  std::map<std::string, std::vector<PlanRow>> rows;
  for (const CsvRow& row : table.rows) {
    take(table, read_plan_row(table, row, design), design, plan, rows);
  }
  for (const auto& [name, both] : rows) {
    if (both.size() == 2) continue;
    refuse_cell(table, *both[0].at, "game",
                fmt::format("two rows of {}, game 1 and game 2", both[0].participant.id),
                fmt::format("game {} alone", both[0].game));
  }
  std::set<std::string> gone;
  for (const PlannedParticipant& one : plan) {
    if (one.replaces.empty()) continue;
    const CsvRow& at = *rows.at(folded(one.id))[0].at;
    const auto whom = std::ranges::find(plan, one.replaces, &PlannedParticipant::id);
    if (whom == plan.end() || one.replaces == one.id) {
      refuse_cell(table, at, "replaces", "another participant of the plan");
    }
    if (whom->allotted != one.allotted) {
      refuse_cell(table, at, "replaces", "a participant with the conditions of " + one.id);
    }
    if (!gone.insert(one.replaces).second) {
      refuse_cell(table, at, "replaces", "a participant whom nobody else replaces");
    }
    if (begins_nowhere(plan, one)) {
      refuse_cell(table, at, "replaces", "a participant who was there before " + one.id);
    }
  }
  return plan;
}

}  // namespace headpin::study
