#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sweep/rows.h"

namespace headpin::sweep {

/// The result at one point of the grid: sums over its trials and draws.
struct Point {
  std::vector<double> sums;         ///< of result columns, NaN-free
  std::vector<std::int64_t> count;  ///< rows that have that number
  std::int64_t rows = 0, failed = 0;
  std::int64_t unsolved = 0;  ///< rows with islands or impacts that were not solved
  std::int64_t first = -1;    ///< number of one of its rows; -1 without any
};

/// The rows that failed for one reason.
struct Failure {
  std::string reason;
  std::int64_t rows = 0;
  std::int64_t first = -1;  ///< number of the first of them
};

/// For each axis of a grid which of its values is looked at; none: all of them. Empty: all of all.
using Chosen = std::vector<std::optional<std::size_t>>;

/// A grid with only the chosen values, and how many points it has.
std::vector<Axis> with_chosen(std::vector<Axis> grid, const Chosen& chosen);
std::int64_t point_count(const std::vector<Axis>& grid);

/// The results of a sweep, by point of the grid.
class Averages {
 public:
  /// @param chosen  rows with other values are left out
  explicit Averages(const Rows& rows, const Chosen& chosen = {});

  /// Adds a row of results.
  /// @param cells  of its line
  /// @throws std::runtime_error  when they are more or fewer than a table of results has
  void add(std::int64_t number, const std::vector<std::string>& cells);

  /// How many rows the points are over, and how many of them were added.
  std::int64_t planned() const;
  std::int64_t done() const;
  /// "friction = 0, shape = true"; empty when no value was chosen.
  std::string chosen_in_words() const;

  /// That of the design, with only the chosen values.
  const std::vector<Axis>& grid() const { return grid_; }
  /// @param place  which value of each axis of grid()
  const Point& at(const std::vector<std::size_t>& place) const;
  const std::vector<Point>& points() const { return points_; }

  /// Why rows failed: the most frequent reason first, of equally frequent ones the one whose first row is earlier.
  /// Beyond 1000 reasons, further ones are counted together as the last one.
  std::vector<Failure> failures() const;

 private:
  void count_failure(std::int64_t number, const std::string& reason);
  /// Which point a row is of; nothing for one that is left out.
  std::optional<std::size_t> point_of(std::int64_t number) const;

  const Rows& rows_;
  Chosen chosen_;
  std::vector<Axis> grid_;
  std::vector<Point> points_;
  std::map<std::string, Failure> failures_;  // by reason
  Failure others_{"other reasons"};
};

/// Mean of a result column; NaN where no row has it.
double mean(const Point& point, std::size_t column);

}  // namespace headpin::sweep
