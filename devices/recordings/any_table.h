#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Text tables of any make: the separator, the decimal sign and the header are found in the text.
namespace headpin::devices {

/// One column's header.
struct FoundColumn {
  std::string name;     ///< the cells above it, joined by spaces; "#3" without a header
  std::string last;     ///< the lowest of these cells
  std::string written;  ///< that cell as it is in the file, with its unit
  /// In small letters, from brackets in the header or a row of units; else empty.
  std::string unit;
};

/// The cells of a table. Cells point into the text, which must outlive this.
struct AnyTable {
  struct Row {
    std::size_t line;  ///< in the file, from 1
    std::vector<std::string_view>
        cells;  ///< without quotes and blanks around them; as many as columns
  };
  std::vector<FoundColumn> columns;
  std::vector<Row> rows;
  char separator = ',';  ///< ' ' for any number of blanks
  bool decimal_comma = false;
  std::string kind;  ///< the program whose header this is, such as "Motive"; else empty
  /// Facts from the lines above the header, in small letters: "length units", "rotation type", "rate".
  std::vector<std::pair<std::string, std::string>> facts;
  std::vector<std::string> notes;  ///< what was left out
  /// Each row is a sample of one of several streams: its cells in the columns of the others are empty.
  bool of_streams = false;

  /// A cell as a number; none for blanks and words.
  std::optional<double> number(std::string_view cell) const;
  /// The fact of this name; empty if there is none.
  std::string fact(std::string_view name) const;
};

/// How many columns it has, and their names, for messages: at most 120 characters of them.
std::string names_in(const AnyTable& table);

/// Refuses a text that has column names and nothing else.
/// @throws std::invalid_argument  naming `where`
void require_rows(std::string_view text, std::string_view where);

/// Reads a table with a header of any number of lines, or none.
///
/// Comment lines (#, %, //) are skipped, except one with names just above the numbers. Quotes around
/// cells, a byte order mark, and any line ends are understood. Rows with another number of cells are
/// left out, with a note; so is a last line without an end where it has too few cells.
///
/// @param where  name of the file, for messages
/// @throws std::invalid_argument  when there are no lines with at least four cells, most of them numbers
AnyTable read_any_table(std::string_view text, std::string_view where);

/// The cells of one line, between semicolons, tabs, commas or blanks: the first of these that it has. A comma in a
/// number before a blank is a decimal comma: "1,2 grab".
std::vector<std::string_view> split_cells(std::string_view line);

/// Text in small letters.
std::string small_letters(std::string_view text);

}  // namespace headpin::devices
