#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "base/math.h"
#include "devices/recordings/any_table.h"
#include "devices/recordings/table_columns.h"

namespace headpin::devices {

/// The rotation of one part, row by row.
class RotationReader {
 public:
  /// @param table    outlives this, as `part` does
  /// @param degrees  whether angles are in degrees, else radians
  /// @param order    of angles: capitals about axes that turn with the body, small letters about fixed ones
  RotationReader(const AnyTable& table, const PartColumns& part, bool degrees,
                 const std::string& order)
      : table_(table), part_(part), order_(order), degrees_(degrees) {}

  /// @param quaternion  the order of the four columns as they stand in the file
  /// @return  none for cells that are no numbers, or that are no rotation
  std::optional<Quat> operator()(const AnyTable::Row& row, std::string_view quaternion) const;

 private:
  template <std::size_t N>
  std::optional<std::array<double, N>> numbers(
      const AnyTable::Row& row, const std::array<std::optional<std::size_t>, N>& columns) const;
  std::optional<Quat> of_quaternion(const AnyTable::Row& row, std::string_view letters) const;
  std::optional<Quat> of_matrix(const AnyTable::Row& row) const;

  const AnyTable& table_;
  const PartColumns& part_;
  std::string order_;
  bool degrees_;
};

/// The letters of a quaternion's columns in the order in which they stand in the file.
std::string order_of(const PartColumns& part);

}  // namespace headpin::devices
