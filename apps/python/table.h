#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include <pybind11/numpy.h>

#include "scene/record/tables.h"

namespace headpin::python {

/// One table of a trial as a structured array of numpy, with the columns of docs/tables.md.
///
/// Every field has eight bytes: numbers and times [s] are float64, whole numbers int64, hashes uint64,
/// `yes/no` bool, texts are str. What is not known is NaN or -1; a yes/no that may be unknown
/// is int8.
class Table {
 public:
  /// @param name  as in scene::table_names()
  explicit Table(std::string_view name);

  void reserve(std::int64_t rows);
  void add(std::span<const scene::TableValue> row);

  /// A read-only view of the rows; they live as long as it, and what is cut from it.
  static pybind11::array view(std::unique_ptr<Table> table);

 private:
  std::uint64_t cell(const scene::TableValue& value);
  pybind11::dtype type() const;
  void make_texts();

  std::vector<scene::TableColumn> columns_;
  std::vector<std::uint64_t> cells_;                      // row by row
  std::unordered_map<std::string, std::uint64_t> texts_;  // each text once, and its number
  std::vector<pybind11::str> strings_;                    // by their numbers; cells point to them
};

}  // namespace headpin::python
