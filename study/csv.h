#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Tables as laboratories type and edit them: CSV by hand, by a spreadsheet, by us.
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

  /// Where a column stands; nothing where there is none of that name.
  std::optional<std::size_t> find(std::string_view column) const;
  /// @throws std::invalid_argument  naming file, column and the columns that are there
  std::size_t require(std::string_view column) const;
  const std::string& cell(const CsvRow& row, std::string_view column) const {
    return row.cells[require(column)];
  }
};

/// Reads a table with a line of names (RFC 4180).
///
/// Spreadsheets are met half-way: a byte order mark, lines that end with CR LF, `;` or tabs between
/// cells, spaces around them and empty rows are all right.
///
/// @param where  name of the file, for messages
/// @throws std::invalid_argument  naming file and line: no text in UTF-8, no names, one name twice,
///                                too few or too many cells, a quote that is not closed
CsvTable parse_csv(std::string_view text, const std::string& where);

/// A number as the table writes it: with a decimal point, or with a comma where cells are separated
/// by `;` or tabs.
std::optional<double> number_in(const CsvTable& table, const std::string& cell);

/// All of a text as a whole number.
std::optional<int> whole_in(std::string_view text);

/// One line as RFC 4180 has it, its end included.
std::string csv_line(const std::vector<std::string>& cells);

/// A cell of somebody else's file, fit for a message: brief, on one line.
std::string shown(std::string_view cell);

/// "FILE:LINE: expected WHAT, found 'FOUND'", as an exception.
[[noreturn]] void refuse(const CsvTable& table, const CsvRow& row, const std::string& expected,
                         const std::string& found);

}  // namespace headpin::study
