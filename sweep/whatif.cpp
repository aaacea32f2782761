#include "sweep/whatif.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "scene/play/score.h"

namespace headpin::sweep {

namespace {

constexpr int kSizes = 20;  ///< steps by which a set shrinks to its mean

Execution mean_of(std::span<const Execution> throws) {
  Execution mean;
  for (const Execution& one : throws) {
    mean.speed += one.speed;
    mean.direction_deg += one.direction_deg;
  }
  mean.speed /= static_cast<double>(throws.size());
  mean.direction_deg /= static_cast<double>(throws.size());
  return mean;
}

/// Sets with the same number of throws, simulated together.
class Sets {
 public:
  explicit Sets(const Execution& recorded) : recorded_(recorded) {}

  void add(const Execution& one) { releases_.push_back(release_of(one, recorded_)); }

  /// The means of consecutive sets.
  std::vector<double> means(const std::vector<Outcome>& outcomes, std::size_t first,
                            std::size_t sets, std::size_t each) const {
    std::vector<double> means(sets, 0.0);
    for (std::size_t i = 0; i < sets * each; ++i) {
      means[i / each] += static_cast<double>(outcomes[first + i].down);
    }
    for (double& mean : means) mean /= static_cast<double>(each);
    return means;
  }

  const std::vector<Release>& releases() const { return releases_; }

 private:
  Execution recorded_;
  std::vector<Release> releases_;
};

}  // namespace

std::vector<double> evenly(double from, double to, int steps) {
  if (steps == 1) return {from};
  std::vector<double> values;
  const double last = steps - 1, near = 1e-12 * std::abs(to - from);
  for (int i = 0; i < steps; ++i) {
    double value = (from * (last - i) + to * i) / last;
    // What changes nothing is exact: it has the bits of the recorded throw.
    for (const double exact : {0.0, 1.0}) {
      if (std::abs(value - exact) <= near) value = exact;
    }
    values.push_back(value);
  }
  return values;
}

std::size_t ReleaseGrid::size() const {
  std::size_t all = 1;
  for (const auto* axis : axes()) all *= axis->size();
  return all;
}

std::size_t ReleaseGrid::number(const std::array<std::size_t, 7>& places) const {
  std::size_t number = 0;
  for (std::size_t i = places.size(); i-- > 0;) number = number * axes()[i]->size() + places[i];
  return number;
}

std::array<std::size_t, 7> ReleaseGrid::unchanged() const {
  std::array<std::size_t, 7> places{};
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto nearest = std::ranges::min_element(
        *axes()[i], {}, [&](double value) { return std::abs(value - kUnchanged[i]); });
    places[i] = static_cast<std::size_t>(nearest - axes()[i]->begin());
  }
  return places;
}

std::vector<Release> releases_of(const ReleaseGrid& grid) {
  std::vector<Release> releases;
  releases.reserve(grid.size());
  for (std::size_t i = 0; i < grid.size(); ++i) {
    std::size_t rest = i;
    std::array<double, 7> of{};
    for (std::size_t k = 0; k < of.size(); ++k) {
      const std::vector<double>& axis = *grid.axes()[k];
      of[k] = axis[rest % axis.size()];
      rest /= axis.size();
    }
    releases.push_back({.change = {.speed = of[ReleaseGrid::kSpeedAxis],
                                   .direction_deg = of[ReleaseGrid::kDirectionAxis],
                                   .height = of[ReleaseGrid::kHeightAxis],
                                   .boards = of[ReleaseGrid::kBoardsAxis],
                                   .revs = of[ReleaseGrid::kRevsAxis],
                                   .rotation_deg = of[ReleaseGrid::kRotationAxis],
                                   .spin = of[ReleaseGrid::kSpinAxis]}});
  }
  return releases;
}

std::vector<Release> moments(Time reach, Time step) {
  const std::int64_t each_way = reach / step;
  std::vector<Release> releases;
  for (std::int64_t i = -each_way; i <= each_way; ++i) releases.push_back({.shift = i * step});
  return releases;
}

std::optional<Window> window_of_success(std::span<const Release> moments,
                                        std::span<const Outcome> outcomes, std::int64_t success) {
  const auto real =
      std::ranges::find(moments, Time{}, [](const Release& release) { return release.shift; });
  const auto succeeds = [&](std::size_t i) {
    return outcomes[i].released && outcomes[i].down >= success;
  };
  if (real == moments.end()) return std::nullopt;
  const auto middle = static_cast<std::size_t>(real - moments.begin());
  if (!succeeds(middle)) return std::nullopt;
  std::size_t first = middle, last = middle;
  while (first > 0 && succeeds(first - 1)) --first;
  while (last + 1 < moments.size() && succeeds(last + 1)) ++last;
  return Window{moments[first].shift, moments[last].shift,
                first == 0 || last + 1 == moments.size()};
}

namespace {

/// The runs of neighbouring boards that succeed in one direction, all else unchanged.
///
/// @param places  of the direction
std::vector<MissRoom> runs_of(const ReleaseGrid& grid, std::span<const Outcome> outcomes,
                              std::int64_t success, std::array<std::size_t, 7> places) {
  std::vector<MissRoom> runs;
  bool in_run = false;
  for (std::size_t b = 0; b < grid.boards.size(); ++b) {
    places[ReleaseGrid::kBoardsAxis] = b;
    const Outcome& outcome = outcomes[grid.number(places)];
    const bool succeeds = outcome.released && outcome.down >= success;
    if (succeeds && !in_run) {
      runs.push_back({.direction_deg = grid.direction_deg[places[ReleaseGrid::kDirectionAxis]],
                      .from = grid.boards[b],
                      .to = 0.0,
                      .cut = b == 0});
    }
    if (succeeds) {
      runs.back().to = grid.boards[b];
      if (b + 1 == grid.boards.size()) runs.back().cut = true;
    }
    in_run = succeeds;
  }
  return runs;
}

}  // namespace

MissRooms miss_rooms(const ReleaseGrid& grid, std::span<const Outcome> outcomes,
                     std::int64_t success) {
  MissRooms rooms;
  const auto has_zero = [](const std::vector<double>& axis) {
    return std::ranges::find(axis, 0.0) != axis.end();
  };
  rooms.in_grid = has_zero(grid.direction_deg) && has_zero(grid.boards);
  std::array<std::size_t, 7> places = grid.unchanged();
  for (std::size_t d = 0; d < grid.direction_deg.size(); ++d) {
    places[ReleaseGrid::kDirectionAxis] = d;
    for (const MissRoom& run : runs_of(grid, outcomes, success, places)) {
      const bool holds_own = run.direction_deg == 0.0 && run.from <= 0.0 && run.to >= 0.0;
      if (holds_own) rooms.own = run;
      const auto& best = rooms.widest;
      const bool nearer = best && std::abs(run.direction_deg) < std::abs(best->direction_deg);
      if (!best || run.boards() > best->boards() || (run.boards() == best->boards() && nearer)) {
        rooms.widest = run;
      }
    }
  }
  return rooms;
}

std::optional<Execution> execution_of(const scene::ThrowRow& thrown) {
  if (!thrown.v_WB) return std::nullopt;
  return Execution{thrown.v_WB->norm(), scene::degrees_from_y(*thrown.v_WB)};
}

Release release_of(const Execution& execution, const Execution& recorded) {
  Release release;
  release.change.speed = std::max(0.0, execution.speed / recorded.speed);
  release.change.direction_deg = execution.direction_deg - recorded.direction_deg;
  return release;
}

Costs costs_of(std::span<const Execution> throws, const Execution& recorded,
               const ReleaseGrid& grid, const Simulate& simulate) {
  if (throws.size() < 2) {
    throw std::invalid_argument("costs of tolerance, noise and covariation need two throws");
  }
  const std::size_t n = throws.size();
  const Execution mean = mean_of(throws);
  Sets sets(recorded);
  std::vector<Execution> shifts;
  for (const double direction : grid.direction_deg) {
    for (const double speed : grid.speed) {
      shifts.push_back({recorded.speed * speed - mean.speed,
                        recorded.direction_deg + direction - mean.direction_deg});
    }
  }
  for (const Execution& shift : shifts) {
    for (const Execution& one : throws) {
      sets.add({one.speed + shift.speed, one.direction_deg + shift.direction_deg});
    }
  }
  const auto size = [](int k) { return static_cast<double>(k) / kSizes; };
  for (int k = 0; k < kSizes; ++k) {
    for (const Execution& one : throws) {
      sets.add({mean.speed + size(k) * (one.speed - mean.speed),
                mean.direction_deg + size(k) * (one.direction_deg - mean.direction_deg)});
    }
  }
  for (const Execution& speed : throws) {
    for (const Execution& direction : throws) sets.add({speed.speed, direction.direction_deg});
  }
  const std::vector<Outcome> outcomes = simulate(sets.releases());

  Costs costs;
  const std::size_t shrunk = shifts.size() * n, paired = shrunk + kSizes * n;
  std::vector<std::vector<double>> gain(n, std::vector<double>(n));
  double sum = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      gain[i][j] = static_cast<double>(outcomes[paired + i * n + j].down);
    }
    costs.down.push_back(outcomes[paired + i * n + i].down);
    sum += gain[i][i];
  }
  costs.mean = sum / static_cast<double>(n);
  const std::vector<double> placed = sets.means(outcomes, 0, shifts.size(), n);
  for (std::size_t i = 0; i < placed.size(); ++i) {
    if (placed[i] - costs.mean <= costs.tolerance) continue;
    costs.tolerance = placed[i] - costs.mean;
    costs.best_shift = shifts[i];
  }
  const std::vector<double> sized = sets.means(outcomes, shrunk, kSizes, n);
  for (int k = kSizes - 1; k >= 0; --k) {
    const double gained = sized[static_cast<std::size_t>(k)] - costs.mean;
    if (gained <= costs.noise) continue;
    costs.noise = gained;
    costs.best_size = size(k);
  }
  const std::vector<std::size_t> pairing = best_assignment(gain);
  double best = 0.0;
  for (std::size_t i = 0; i < n; ++i) best += gain[i][pairing[i]];
  costs.covariation = best / static_cast<double>(n) - costs.mean;
  return costs;
}

// The Hungarian method with potentials, a row at a time (Kuhn 1955; Munkres 1957), on costs -gain.
std::vector<std::size_t> best_assignment(const std::vector<std::vector<double>>& gain) {
  const std::size_t n = gain.size();
  constexpr double kFar = std::numeric_limits<double>::infinity();
  std::vector<double> of_row(n + 1, 0.0), of_column(n + 1, 0.0);
  std::vector<std::size_t> row_of(n + 1, 0), way(n + 1, 0);  // from 1; 0: none
  for (std::size_t row = 1; row <= n; ++row) {
    row_of[0] = row;
    std::size_t at = 0;
    std::vector<double> least(n + 1, kFar);
    std::vector<bool> used(n + 1, false);
    while (row_of[at] != 0) {
      used[at] = true;
      const std::size_t i = row_of[at];
      double step = kFar;
      std::size_t next = 0;
      for (std::size_t j = 1; j <= n; ++j) {
        if (used[j]) continue;
        const double reduced = -gain[i - 1][j - 1] - of_row[i] - of_column[j];
        if (reduced < least[j]) {
          least[j] = reduced;
          way[j] = at;
        }
        if (least[j] < step) {
          step = least[j];
          next = j;
        }
      }
      for (std::size_t j = 0; j <= n; ++j) {
        if (used[j]) {
          of_row[row_of[j]] += step;
          of_column[j] -= step;
        } else {
          least[j] -= step;
        }
      }
      at = next;
    }
    for (; at != 0; at = way[at]) row_of[at] = row_of[way[at]];
  }
  std::vector<std::size_t> column_of(n);
  for (std::size_t j = 1; j <= n; ++j) column_of[row_of[j] - 1] = j - 1;
  return column_of;
}

}  // namespace headpin::sweep
