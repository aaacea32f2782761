#pragma once

#include <cstdint>
#include <map>
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

/// The results of a sweep, by point of the grid.
class Averages {
 public:
  explicit Averages(const Rows& rows);

  /// Adds a row of results.
  /// @param cells  of its line
  /// @throws std::runtime_error  when they are more or fewer than a table of results has
  void add(std::int64_t number, const std::vector<std::string>& cells);

  /// @param place  which value of each axis of the grid
  const Point& at(const std::vector<std::size_t>& place) const;
  const std::vector<Point>& points() const { return points_; }

  /// Why rows failed: the most frequent reason first, of equally frequent ones the one whose first row is earlier.
  /// Beyond 1000 reasons, further ones are counted together as the last one.
  std::vector<Failure> failures() const;

 private:
  void count_failure(std::int64_t number, const std::string& reason);

  const Rows& rows_;
  std::vector<Point> points_;
  std::map<std::string, Failure> failures_;  // by reason
  Failure others_{"other reasons"};
};

/// Mean of a result column; NaN where no row has it.
double mean(const Point& point, std::size_t column);

}  // namespace headpin::sweep
