#include "sweep/averages.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "sweep/result.h"

namespace headpin::sweep {

namespace {

std::size_t column_named(std::string_view name) {
  const auto& columns = result_columns();
  const auto found = std::ranges::find(columns, name, [](const ResultColumn& c) { return c.name; });
  return static_cast<std::size_t>(found - columns.begin());
}

}  // namespace

Averages::Averages(const Rows& rows) : rows_(rows) {
  std::size_t points = 1;
  for (const Axis& axis : rows.design().grid) points *= axis.values.size();
  points_.resize(points);
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
  const Design& design = rows_.design();
  const std::int64_t each = std::ssize(design.trials) * design.draws;
  Point& point = points_[static_cast<std::size_t>(number / each)];
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

const Point& Averages::at(const std::vector<std::size_t>& place) const {
  std::size_t number = 0;
  const std::vector<Axis>& grid = rows_.design().grid;
  for (std::size_t i = 0; i < grid.size(); ++i) number = number * grid[i].values.size() + place[i];
  return points_[number];
}

double mean(const Point& point, std::size_t column) {
  if (point.count[column] == 0) return std::numeric_limits<double>::quiet_NaN();
  return point.sums[column] / static_cast<double>(point.count[column]);
}

}  // namespace headpin::sweep
