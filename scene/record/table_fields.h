#pragma once

#include <optional>
#include <vector>

#include "scene/record/tables.h"

/// The columns of a table, each with its value in a row. For the sources of tables.h.
namespace headpin::scene {

/// A column of a table whose rows are Row, and its value in a row.
template <typename Row>
struct TableField {
  const char *name, *kind, *unit, *meaning;
  TableValue (*value)(const Row&);
};

template <typename Row>
std::vector<TableField<Row>> operator+(std::vector<TableField<Row>> a,
                                       const std::vector<TableField<Row>>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// The columns of a vector or quaternion that `Of` finds in a row.
template <auto Of, typename Row>
std::vector<TableField<Row>> vector_fields(const char* x, const char* y, const char* z,
                                           const char* unit, const char* meaning) {
  return {{x, "number", unit, meaning, [](const Row& r) -> TableValue { return Of(r).x(); }},
          {y, "number", unit, "", [](const Row& r) -> TableValue { return Of(r).y(); }},
          {z, "number", unit, "", [](const Row& r) -> TableValue { return Of(r).z(); }}};
}

template <auto Of, typename Row>
std::vector<TableField<Row>> pose_fields(const char* position, const char* rotation) {
  constexpr auto kPosition = [](const Row& r) -> const Vec3& { return Of(r).p; };
  return vector_fields<kPosition, Row>("x_m", "y_m", "z_m", "m", position) +
         std::vector<TableField<Row>>{
             {"qw", "number", "", rotation, [](const Row& r) -> TableValue { return Of(r).q.w(); }},
             {"qx", "number", "", "", [](const Row& r) -> TableValue { return Of(r).q.x(); }},
             {"qy", "number", "", "", [](const Row& r) -> TableValue { return Of(r).q.y(); }},
             {"qz", "number", "", "", [](const Row& r) -> TableValue { return Of(r).q.z(); }}};
}

/// A value that may not be known.
template <typename T>
TableValue maybe(const std::optional<T>& value) {
  return value ? TableValue(*value) : TableValue();
}

/// A part of a vector that `Of` may find in a row.
template <auto Of, int I, typename Row>
TableValue part(const Row& row) {
  const std::optional<Vec3> v = Of(row);
  return v ? TableValue((*v)[I]) : TableValue();
}

/// The columns of such a vector.
template <auto Of, typename Row>
std::vector<TableField<Row>> maybe_vector_fields(const char* x, const char* y, const char* z,
                                                 const char* unit, const char* meaning) {
  return {{x, "number", unit, meaning, part<Of, 0, Row>},
          {y, "number", unit, "", part<Of, 1, Row>},
          {z, "number", unit, "", part<Of, 2, Row>}};
}

/// The columns of throws.csv.
std::vector<TableField<ThrowRow>> throw_fields();

}  // namespace headpin::scene
