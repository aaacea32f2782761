#include "engine/friction_table.h"

#include <algorithm>

namespace headpin::engine {

std::optional<std::size_t> row_at(const FrictionTable& table, double y) {
  const auto after = std::upper_bound(table.edges.begin(), table.edges.end(), y);
  if (after == table.edges.begin() || after == table.edges.end()) return std::nullopt;
  return static_cast<std::size_t>(after - table.edges.begin()) - 1;
}

std::optional<std::size_t> column_at(const FrictionTable& table, double x) {
  const double columns = (x - table.low_x) / table.width;
  if (!(columns >= 0.0 && columns < static_cast<double>(table.columns))) return std::nullopt;
  return static_cast<std::size_t>(columns);
}

std::optional<double> friction_at(const FrictionTable& table, const Vec2& p) {
  const std::optional<std::size_t> row = row_at(table, p.y()), column = column_at(table, p.x());
  if (!row || !column) return std::nullopt;
  return table.friction[*row * table.columns + *column];
}

}  // namespace headpin::engine
