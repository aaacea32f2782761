#include "engine/friction_table.h"

#include <gtest/gtest.h>

namespace headpin::engine {
namespace {

/// x from -0.5 to 0.5 in two columns, y from 2 to 5 in two rows.
FrictionTable two_by_two() {
  return {-0.5, 0.5, 2, {2.0, 3.0, 5.0}, {0.01, 0.02, 0.03, 0.04}};
}

TEST(FrictionTableCells, HaveTheirLowEdgesAndNotTheirHighOnes) {
  const FrictionTable table = two_by_two();
  const struct {
    double x;
    std::optional<std::size_t> column;
  } columns[] = {{-0.75, {}}, {-0.500001, {}}, {-0.5, 0}, {-0.000001, 0},
                 {0.0, 1},    {0.499999, 1},   {0.5, {}}, {0.75, {}}};
  for (const auto& [x, column] : columns) EXPECT_EQ(column_at(table, x), column) << x;
  const struct {
    double y;
    std::optional<std::size_t> row;
  } rows[] = {{1.999999, {}}, {2.0, 0}, {2.999999, 0}, {3.0, 1}, {4.999999, 1}, {5.0, {}}};
  for (const auto& [y, row] : rows) EXPECT_EQ(row_at(table, y), row) << y;
}

TEST(FrictionTableCells, AreTakenRowByRowAndThereAreNoneOutside) {
  const FrictionTable table = two_by_two();
  EXPECT_EQ(friction_at(table, Vec2(-0.5, 2.0)), 0.01);
  EXPECT_EQ(friction_at(table, Vec2(0.0, 2.0)), 0.02);
  EXPECT_EQ(friction_at(table, Vec2(-0.5, 3.0)), 0.03);
  EXPECT_EQ(friction_at(table, Vec2(0.25, 4.0)), 0.04);
  EXPECT_EQ(friction_at(table, Vec2(0.5, 4.0)), std::nullopt);
  EXPECT_EQ(friction_at(table, Vec2(0.25, 5.0)), std::nullopt);
}

}  // namespace
}  // namespace headpin::engine
