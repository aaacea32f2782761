#pragma once

#include <iosfwd>
#include <string>
#include <string_view>
#include <vector>

#include "devices/trial.h"

/// A trial as tidy tables: one observation a row, one quantity a column, for people who would
/// rather read CSV than LCM.
namespace headpin::devices {

/// What stands in one column of one table.
struct TableColumn {
  std::string table;    ///< "trackers", "buttons", "events", "states" or "frames"
  std::string name;     ///< with the unit last
  std::string kind;     ///< "number", "whole", "text", "yes/no" (1 or 0) or "hash" (16 hex digits)
  std::string unit;     ///< empty where there is none
  std::string meaning;  ///< a sentence's worth
};

/// Every column of every table, in their order.
std::vector<TableColumn> table_columns();

/// Names of the tables, in their order.
std::vector<std::string> table_names();

/// Writes one table of a trial as CSV (RFC 4180, lines end with LF): names, then rows.
///
/// Numbers are the shortest that read back to the same bits; times are exact, in decimal seconds.
///
/// @return  how many rows
/// @throws std::invalid_argument  for a table that is not there
std::int64_t write_table(std::ostream& out, std::string_view table, const Trial& trial);

/// What every column is, as CSV: table, column, kind, unit, meaning.
void write_dictionary(std::ostream& out);

}  // namespace headpin::devices
