#pragma once

#include <iosfwd>
#include <memory>
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
class TableWriter {
 public:
  /// @param header  of the trial
  /// @param out     both must outlive this
  /// @throws std::invalid_argument  for a table that is not there
  TableWriter(std::ostream& out, std::string_view table, const TrialHeader& header);
  ~TableWriter();
  TableWriter(TableWriter&&) noexcept;

  /// What is not of this table is passed over.
  void add(const Sample& sample);
  void add(const Event& event);
  void add(const TickState& state);
  void add(const FrameRecord& frame);

  std::int64_t rows() const;

 private:
  struct Table;
  std::unique_ptr<Table> table_;
};

/// What every column is, as CSV: table, column, kind, unit, meaning.
void write_dictionary(std::ostream& out);

}  // namespace headpin::devices
