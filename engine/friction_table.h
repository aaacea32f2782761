#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "base/math.h"

namespace headpin::engine {

/// The friction of a rectangle of a fixed body, cell by cell: columns of one width along the body's
/// x, rows of any length along its y. Of a place in it the table counts, not the areas of the body.
struct FrictionTable {
  double low_x = 0.0;            ///< where the first column begins [m]
  double width = 1.0;            ///< of a column [m]
  std::size_t columns = 1;       ///< how many
  std::vector<double> edges;     ///< where each row begins, ascending, and where the last ends [m]
  std::vector<double> friction;  ///< of each cell, row by row; as Material::friction

  bool operator==(const FrictionTable&) const = default;
};

/// The row that has y; nothing outside of the table.
std::optional<std::size_t> row_at(const FrictionTable& table, double y);

/// The column that has x; nothing outside of the table.
std::optional<std::size_t> column_at(const FrictionTable& table, double x);

/// The friction at a place; nothing outside of the table.
std::optional<double> friction_at(const FrictionTable& table, const Vec2& p);

}  // namespace headpin::engine
