#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "devices/recordings/table_columns.h"

/// The objects of a table: columns whose names begin in the same way. For table_columns.cpp.
namespace headpin::devices {

/// Four columns that are called a rotation in the same way: w, x, y, z.
struct RotationSet {
  std::string name;
  std::array<std::optional<std::size_t>, 4> columns = {};
};

/// The columns of one object of the table.
struct Object {
  PartColumns columns;
  std::vector<RotationSet> rotations;           ///< "rot_x" and "qx" are of two sets
  std::map<std::size_t, std::size_t> elements;  ///< of a matrix
};

using Objects = std::vector<std::pair<std::string, Object>>;

template <std::size_t N>
bool whole(const std::array<std::optional<std::size_t>, N>& columns) {
  return std::ranges::all_of(columns, [](const auto& c) { return c.has_value(); });
}

/// Puts a column into its place of an object, if that has none yet.
/// @param name  of the column; of told components it is empty
void put(Object& object, const Component& component, std::size_t column, const std::string& name);

/// Decides how the rotation of an object is written, when all its columns are known.
void finish(Object& object);

/// The kinds of rotation of which an object has columns: quaternion, angle, matrix.
/// @param told  not finished
std::vector<Quantity> rotations_of(const Object& told);

/// Puts what was told of an object over what was found of it, component by component.
/// @param told  not finished
/// @return      false if what was told of the rotation makes none, beside another one that was found
bool put_over(const Object& told, Object& found);

/// What the * of a pattern stands for in a name; none if the name is not of the pattern.
std::optional<std::string> starred(std::string_view name, std::string_view pattern);

/// The objects of a table by name, also those without a position.
Objects objects_of(const AnyTable& table, std::string_view pattern = "*");

}  // namespace headpin::devices
