#include "apps/python/table.h"

#include <bit>
#include <cstring>
#include <limits>

#include "apps/python/values.h"

namespace headpin::python {

namespace py = pybind11;

namespace {

/// A cell's first byte, whatever the byte order.
std::uint64_t cell_of(std::int8_t value) {
  std::uint64_t cell = 0;
  std::memcpy(&cell, &value, 1);
  return cell;
}

/// numpy's name of a column's type.
const char* type_of(const scene::TableColumn& column) {
  if (column.kind == "number") return "f8";
  if (column.kind == "whole") return "i8";
  if (column.kind == "hash") return "u8";
  if (column.kind == "text") return "O";
  return column.name == "foul" ? "i1" : "?";  // old trials do not say whether there was a foul
}

std::uint64_t unknown(const scene::TableColumn& column) {
  if (column.kind == "number") {
    return std::bit_cast<std::uint64_t>(std::numeric_limits<double>::quiet_NaN());
  }
  if (column.kind == "whole") return std::bit_cast<std::uint64_t>(std::int64_t{-1});
  return cell_of(-1);
}

}  // namespace

Table::Table(std::string_view name) {
  for (scene::TableColumn& column : scene::table_columns()) {
    if (column.table == name) columns_.push_back(std::move(column));
  }
}

void Table::reserve(std::int64_t rows) {
  cells_.reserve(static_cast<std::size_t>(rows) * columns_.size());
}

void Table::add(std::span<const scene::TableValue> row) {
  for (std::size_t i = 0; i < row.size(); ++i) {
    if (!std::holds_alternative<std::monostate>(row[i])) {
      cells_.push_back(cell(row[i]));
    } else {
      cells_.push_back(columns_[i].kind == "text" ? cell(std::string()) : unknown(columns_[i]));
    }
  }
}

std::uint64_t Table::cell(const scene::TableValue& value) {
  if (const auto* number = std::get_if<double>(&value)) {
    return std::bit_cast<std::uint64_t>(*number);
  }
  if (const auto* time = std::get_if<Time>(&value)) {
    return std::bit_cast<std::uint64_t>(nearest_seconds(*time));
  }
  if (const auto* whole = std::get_if<std::int64_t>(&value)) {
    return std::bit_cast<std::uint64_t>(*whole);
  }
  if (const auto* hash = std::get_if<std::uint64_t>(&value)) return *hash;
  if (const auto* yes = std::get_if<bool>(&value)) return cell_of(*yes ? 1 : 0);
  return texts_.try_emplace(std::get<std::string>(value), texts_.size()).first->second;
}

py::dtype Table::type() const {
  py::list names, formats, offsets;
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    names.append(columns_[i].name);
    formats.append(type_of(columns_[i]));
    offsets.append(i * sizeof(std::uint64_t));
  }
  return {names, formats, offsets,
          static_cast<py::ssize_t>(columns_.size() * sizeof(std::uint64_t))};
}

/// Puts Python's texts in place of their numbers.
void Table::make_texts() {
  strings_.resize(texts_.size());
  for (const auto& [text, number] : texts_) strings_[number] = to_text(text);
  texts_.clear();
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    if (columns_[i].kind != "text") continue;
    for (std::size_t at = i; at < cells_.size(); at += columns_.size()) {
      cells_[at] = std::bit_cast<std::uintptr_t>(strings_[cells_[at]].ptr());
    }
  }
}

py::array Table::view(std::unique_ptr<Table> table) {
  table->make_texts();
  const py::dtype type = table->type();
  const auto rows = static_cast<py::ssize_t>(table->cells_.size() / table->columns_.size());
  const void* cells = table->cells_.data();
  const py::capsule owner(table.release(), [](void* kept) { delete static_cast<Table*>(kept); });
  py::array view(type, {rows}, {type.itemsize()}, cells, owner);
  view.attr("flags").attr("writeable") = false;
  return view;
}

}  // namespace headpin::python
