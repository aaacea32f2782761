#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Reads CSV tables that people or spreadsheets wrote. It stays our own code: it accepts what
/// spreadsheets write, and names file and line of an error.
namespace headpin::study {

struct CsvRow {
  int line = 0;  ///< of the file, where the row begins; from 1
  std::vector<std::string> cells;
};

struct CsvTable {
  std::string where;  ///< name of the file, for messages
  char separator = ',';
  std::vector<std::string> columns;
  std::vector<CsvRow> rows;

  /// The index of a column; nothing for an unknown name.
  std::optional<std::size_t> find(std::string_view column) const;
  /// @throws std::invalid_argument  naming file, column and the columns that are there
  std::size_t require(std::string_view column) const;
  const std::string& cell(const CsvRow& row, std::string_view column) const {
    return row.cells[require(column)];
  }
};

/// Reads a table with a line of names (RFC 4180).
///
/// It accepts a byte order mark, CR LF or CR at the end of a line, `;` or tabs between cells, spaces around cells, and empty
/// rows, as spreadsheets write them.
///
/// @param where  name of the file, for messages
/// @throws std::invalid_argument  naming file and line: no text in UTF-8, no names, one name twice,
///                                too few or too many cells, a quote that is not closed
CsvTable parse_csv(std::string_view text, const std::string& where);

/// A number as the table writes it: with a decimal point, or with a comma where cells are separated
/// by `;` or tabs.
std::optional<double> number_in(const CsvTable& table, const std::string& cell);

/// Parses a whole text as an integer.
std::optional<int> whole_in(std::string_view text);

/// A text without blanks at its ends.
std::string trimmed(const std::string& text);

/// One line as in RFC 4180, with its line end.
std::string csv_line(const std::vector<std::string>& cells);

/// A cell of a foreign file for a message: short, on one line.
std::string shown(std::string_view cell);

/// "FILE:LINE: expected WHAT, found 'FOUND'", as an exception.
[[noreturn]] void refuse(const CsvTable& table, const CsvRow& row, const std::string& expected,
                         const std::string& found);

/// "FILE:LINE: column COLUMN: expected WHAT, found FOUND", as an exception.
/// @param found  in words; without it the cell, in quotes
[[noreturn]] void refuse_cell(const CsvTable& table, const CsvRow& row, std::string_view column,
                              const std::string& expected, const std::string& found = {});

}  // namespace headpin::study
