#pragma once

#include <string>
#include <string_view>
#include <vector>

/// Text tables whose columns are known: one row per line, cells between separators. It stays our own
/// code: no dependency reads CSV, and messages need file and line. Tables of any make: any_table.h.
namespace headpin::devices {

/// Removes the part before `separator` from the front of `text` and returns it.
std::string_view take_front(std::string_view& text, char separator);

std::string_view trimmed(std::string_view text);

/// The rows of a table, one at a time; empty lines are left out.
class TextTable {
 public:
  /// @param text       without a byte order mark, or with one
  /// @param where      name of the file, for messages; both must outlive this
  TextTable(std::string_view text, std::string_view where, char separator);

  /// Takes the next row as the names of the columns.
  void read_names();
  void set_names(std::vector<std::string> names) { names_ = std::move(names); }

  /// Moves to the next row; false at the end.
  /// @throws std::invalid_argument  when it has another number of cells than there are names; an
  ///                                empty one more, as some programs end their lines, is no cell
  bool next();

  const std::vector<std::string>& names() const { return names_; }
  /// The line of the row, from 1.
  std::size_t line() const { return line_; }
  /// The index of the first column of this name; the number of columns if there is none.
  std::size_t column(std::string_view name) const;
  std::string_view text(std::size_t column) const { return cells_[column]; }
  /// @throws std::invalid_argument  when it is no finite number
  double number(std::size_t column) const;

  /// Refuses a time that is more than 1e10 s from 0: Unix times are taken, in seconds.
  /// @param column  its name
  /// @param time    [s]
  /// @throws std::invalid_argument
  void require_time(std::string_view column, double time) const;

  /// @throws std::invalid_argument  naming file and line
  [[noreturn]] void fail(const std::string& what) const;

 private:
  bool next_cells();

  std::string_view rest_, where_;
  char separator_;
  std::vector<std::string> names_;
  std::vector<std::string_view> cells_;
  std::size_t line_ = 0;
};

}  // namespace headpin::devices
