#include "sweep/whatif_tables.h"

#include <fmt/format.h>

#include "scene/play/score.h"
#include "study/csv.h"

namespace headpin::sweep {

namespace {

using Cells = std::vector<std::string>;

std::string number(double value) {
  return fmt::format("{}", value);
}

std::string number(const std::optional<double>& value) {
  return value ? number(*value) : "";
}

/// Speed, direction, height and spin of a release.
void add_release(const scene::ThrowRow& thrown, Cells& cells) {
  cells.push_back(number(thrown.speed));
  if (!thrown.p_WB || !thrown.v_WB || !thrown.w_WB) return cells.resize(cells.size() + 3);
  cells.push_back(number(scene::degrees_from_y(*thrown.v_WB)));
  cells.push_back(number(thrown.p_WB->z()));
  const Vec3 level(thrown.v_WB->x(), thrown.v_WB->y(), 0.0);
  cells.push_back(level.norm() > 0.0 ? number(thrown.w_WB->dot(level) / level.norm()) : "");
}

/// In the order of release_columns().
void add_outcome(const Outcome& outcome, Cells& cells) {
  if (!outcome.released) {
    cells.resize(cells.size() + release_columns().size());
    return;
  }
  add_release(outcome.thrown, cells);
  cells.push_back(outcome.thrown.known);
  cells.push_back(number(outcome.thrown.entry_speed));
  cells.push_back(number(outcome.thrown.entry_angle_deg));
  cells.push_back(fmt::format("{}", outcome.down));
}

std::string first_line(Cells names) {
  for (const WhatIfColumn& column : release_columns()) names.push_back(column.name);
  return study::csv_line(names);
}

}  // namespace

const std::vector<WhatIfColumn>& release_columns() {
  static const std::vector<WhatIfColumn> columns = {
      {"speed_mps", "m/s", "of the ball at its release"},
      {"direction_deg", "degrees", "of the level velocity, to the right of straight on"},
      {"height_m", "m", "of the ball's centre over the lane"},
      {"spin_radps", "rad/s",
       "about the level direction of the throw; positive curves to the right"},
      {"known", "", "how the velocity of the hand was known: tracked, extrapolated or impossible"},
      {"entry_speed_mps", "m/s", "of the ball just before its first skittle"},
      {"entry_angle_deg", "degrees", "of its level velocity then, to the right of straight on"},
      {"skittles_down", "", "as the rules count; without rules, all that the ball felled"}};
  return columns;
}

std::string moments_csv(const WhatIf& whatif) {
  std::string text = first_line({"later_ms"});
  for (std::size_t i = 0; i < whatif.moments.size(); ++i) {
    Cells cells = {number(static_cast<double>(whatif.moments[i].shift.count()) / 1e3)};
    add_outcome(whatif.of_moments[i], cells);
    text += study::csv_line(cells);
  }
  return text;
}

std::string releases_csv(const WhatIf& whatif) {
  std::string text = first_line({"speed_factor", "turn_deg", "raised_m", "added_spin_radps",
                                 "moved_boards", "revs_factor", "added_rotation_deg"});
  const ReleaseGrid& grid = whatif.grid;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    std::size_t rest = i;
    Cells cells;
    for (const auto* axis : grid.axes()) {
      cells.push_back(number((*axis)[rest % axis->size()]));
      rest /= axis->size();
    }
    add_outcome(whatif.of_grid[i], cells);
    text += study::csv_line(cells);
  }
  return text;
}

std::string throws_csv(const WhatIf& whatif) {
  std::string text =
      study::csv_line({"trial", "throw", "version", "speed_mps", "direction_deg", "height_m",
                       "spin_radps", "skittles_down", "skittles_down_here"});
  for (std::size_t i = 0; i < whatif.own.size(); ++i) {
    const OwnThrow& own = whatif.own[i];
    Cells cells = {own.trial, fmt::format("{}", own.number), own.thrown.version};
    add_release(own.thrown, cells);
    const std::optional<int> down =
        own.thrown.counted ? own.thrown.counted : own.thrown.felled_by_ball;
    cells.push_back(down ? fmt::format("{}", *down) : "");
    std::string here;
    for (std::size_t k = 0; k < whatif.in_costs.size(); ++k) {
      if (whatif.in_costs[k] == i) here = fmt::format("{}", whatif.costs->down[k]);
    }
    cells.push_back(here);
    text += study::csv_line(cells);
  }
  return text;
}

}  // namespace headpin::sweep
