#include "devices/recordings/table_rotation.h"

#include <cmath>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace headpin::devices {
namespace {

/// The rotation in a row, of columns from the first one on; none if it is none.
std::optional<Quat> rotation_in(const std::string& cells, RotationKind kind, bool degrees = true,
                                const std::string& order = "YXZ") {
  AnyTable table;
  table.rows.push_back({1, split_cells(cells)});
  PartColumns part;
  part.rotation = kind;
  for (std::size_t i = 0; i < 3; ++i) part.angles[i] = i;
  for (std::size_t i = 0; i < 4; ++i) part.quaternion[i] = i;
  for (std::size_t i = 0; i < 9; ++i) part.matrix[i] = i;
  return RotationReader(table, part, degrees, order)(table.rows[0], "wxyz");
}

/// Whether a rotation takes one direction to another.
bool takes_to(const std::optional<Quat>& q, const Vec3& from, const Vec3& to) {
  return q && (*q * from - to).norm() < 1e-9;
}

const Vec3 kX = Vec3::UnitX(), kY = Vec3::UnitY(), kZ = Vec3::UnitZ();

TEST(TableRotation, OfNineNumbersIsAMatrixRowByRow) {
  const auto matrix = [](const std::string& cells) {
    return rotation_in(cells, RotationKind::matrix);
  };
  // A third of a turn about the diagonal: x to y, y to z, z to x.
  const auto third = matrix("0,0,1,1,0,0,0,1,0");
  EXPECT_TRUE(takes_to(third, kX, kY));
  EXPECT_TRUE(takes_to(third, kY, kZ));
  EXPECT_TRUE(takes_to(matrix("1,0,0,0,0,-1,0,1,0"), kY, kZ));
  EXPECT_TRUE(takes_to(matrix("1.001,0,0,0,1,0,0,0,1"), kX, kX));
  for (const char* none :
       {"1,0,0,0,1,0,0,0,-1", "2,0,0,0,2,0,0,0,2", "0,0,0,0,0,0,0,0,0", "1,1,0,0,1,0,0,0,1",
        "1,0,0,0,1,0,0,0,", "a,0,0,0,1,0,0,0,1", "1.01,0,0,0,1,0,0,0,1"}) {
    EXPECT_FALSE(matrix(none)) << none;
  }
}

TEST(TableRotation, OfAnglesIsAboutAxesThatTurnOrStay) {
  const auto angles = [](const std::string& order) {
    return rotation_in("90,90,0", RotationKind::angles, true, order);
  };
  // About axes that turn the last letter counts first, about those that stay the first one.
  EXPECT_TRUE(takes_to(angles("XYZ"), kY, kZ));
  EXPECT_TRUE(takes_to(angles("XYZ"), kX, kY));
  EXPECT_TRUE(takes_to(angles("xyz"), kY, kX));
  EXPECT_TRUE(takes_to(angles("xyz"), kX, -kZ));
  EXPECT_TRUE(takes_to(rotation_in("0,0,1.5707963267948966", RotationKind::angles, false), kX, kY));
  EXPECT_FALSE(rotation_in("90,up,0", RotationKind::angles));
  // No angle is as large as 10000 radians.
  EXPECT_FALSE(rotation_in("6000,8000,0", RotationKind::angles, false));
  EXPECT_TRUE(rotation_in("6000,7999,0", RotationKind::angles, false));
}

TEST(TableRotation, OfAVectorIsAboutItByItsLength) {
  const std::string third = fmt::format("{0},{0},{0}", 120.0 / std::sqrt(3.0));
  EXPECT_TRUE(takes_to(rotation_in(third, RotationKind::vector), kX, kY));
  EXPECT_TRUE(takes_to(rotation_in(third, RotationKind::vector), kY, kZ));
  EXPECT_FALSE(takes_to(rotation_in(third, RotationKind::angles), kX, kY));
}

TEST(TableRotation, OfFourNumbersHasALengthOfOneToAThousandth) {
  EXPECT_TRUE(takes_to(rotation_in("0.5,0.5,0.5,0.5", RotationKind::quaternion), kX, kY));
  EXPECT_TRUE(rotation_in("1.0009,0,0,0", RotationKind::quaternion));
  EXPECT_FALSE(rotation_in("1.0011,0,0,0", RotationKind::quaternion));
  EXPECT_FALSE(rotation_in("0.9989,0,0,0", RotationKind::quaternion));
  EXPECT_TRUE(takes_to(rotation_in("a,b,c", RotationKind::none), kX, kX));
}

}  // namespace
}  // namespace headpin::devices
