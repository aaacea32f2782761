#include "sweep/averages.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sweep/result.h"

namespace headpin::sweep {

namespace {

std::size_t column_named(std::string_view name) {
  const auto& columns = result_columns();
  const auto found = std::ranges::find(columns, name, [](const ResultColumn& c) { return c.name; });
  return static_cast<std::size_t>(found - columns.begin());
}

}  // namespace

std::vector<Axis> with_chosen(std::vector<Axis> grid, const Chosen& chosen) {
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    if (chosen[i]) grid[i].values = {grid[i].values[*chosen[i]]};
  }
  return grid;
}

std::int64_t point_count(const std::vector<Axis>& grid) {
  std::int64_t points = 1;
  for (const Axis& axis : grid) points *= std::ssize(axis.values);
  return points;
}

Averages::Averages(const Rows& rows, const Chosen& chosen)
    : rows_(rows), chosen_(chosen), grid_(with_chosen(rows.design().grid, chosen)) {
  chosen_.resize(grid_.size());
  points_.resize(static_cast<std::size_t>(point_count(grid_)));
  for (Point& point : points_) {
    point.sums.resize(result_columns().size());
    point.count.resize(result_columns().size());
  }
}

void Averages::add(std::int64_t number, const std::vector<std::string>& cells) {
  static const std::size_t islands = column_named("unsolved_islands"),
                           impacts = column_named("unfinished_impacts");
  const std::size_t own = 2 + rows_.keys().size();
  if (cells.size() != own + result_columns().size()) {
    throw std::runtime_error(fmt::format("row {}: expected {} cells, found {}", number + 1,
                                         own + result_columns().size(), cells.size()));
  }
  const std::optional<std::size_t> place = point_of(number);
  if (!place) return;
  Point& point = points_[*place];
  if (point.first < 0) point.first = number;
  ++point.rows;
  if (!cells.back().empty()) {
    ++point.failed;
    count_failure(number, cells.back());
  }
  bool unsolved = false;
  for (std::size_t i = 0; i + 1 < result_columns().size(); ++i) {
    const std::string& cell = cells[own + i];
    double value = 0.0;
    const auto read = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (cell.empty() || read.ec != std::errc{} || read.ptr != cell.data() + cell.size()) continue;
    point.sums[i] += value;
    ++point.count[i];
    unsolved |= (i == islands || i == impacts) && value > 0.0;
  }
  point.unsolved += unsolved ? 1 : 0;
}

std::int64_t Averages::planned() const {
  return point_count(grid_) * std::ssize(rows_.design().trials) * rows_.design().draws;
}

std::int64_t Averages::done() const {
  std::int64_t done = 0;
  for (const Point& point : points_) done += point.rows;
  return done;
}

std::string Averages::chosen_in_words() const {
  std::vector<std::string> words;
  for (std::size_t i = 0; i < grid_.size(); ++i) {
    if (!chosen_[i]) continue;
    words.push_back(fmt::format("{} = {}", grid_[i].key, grid_[i].values.front()));
  }
  return fmt::format("{}", fmt::join(words, ", "));
}

void Averages::count_failure(std::int64_t number, const std::string& reason) {
  constexpr std::size_t kMostReasons = 1000;
  const bool has_place = failures_.contains(reason) || failures_.size() < kMostReasons;
  Failure& failure = has_place ? failures_[reason] : others_;
  if (has_place) failure.reason = reason;
  ++failure.rows;
  if (failure.first < 0 || number < failure.first) failure.first = number;
}

std::vector<Failure> Averages::failures() const {
  std::vector<Failure> all;
  for (const auto& [reason, failure] : failures_) all.push_back(failure);
  std::ranges::sort(all, [](const Failure& a, const Failure& b) {
    return a.rows != b.rows ? a.rows > b.rows : a.first < b.first;
  });
  if (others_.rows > 0) all.push_back(others_);
  return all;
}

std::optional<std::size_t> Averages::point_of(std::int64_t number) const {
  const Design& design = rows_.design();
  const std::int64_t each = std::ssize(design.trials) * design.draws;
  auto left = static_cast<std::size_t>(number / each);
  std::size_t point = 0, stride = 1;
  for (std::size_t i = grid_.size(); i-- > 0;) {  // the last axis changes fastest
    const std::size_t count = design.grid[i].values.size(), value = left % count;
    left /= count;
    if (chosen_[i] && *chosen_[i] != value) return std::nullopt;
    if (!chosen_[i]) point += stride * value;
    stride *= grid_[i].values.size();
  }
  return point;
}

const Point& Averages::at(const std::vector<std::size_t>& place) const {
  std::size_t number = 0;
  for (std::size_t i = 0; i < grid_.size(); ++i)
    number = number * grid_[i].values.size() + place[i];
  return points_[number];
}

double mean(const Point& point, std::size_t column) {
  if (point.count[column] == 0) return std::numeric_limits<double>::quiet_NaN();
  return point.sums[column] / static_cast<double>(point.count[column]);
}

}  // namespace headpin::sweep
