#pragma once

#include <functional>
#include <iosfwd>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "scene/record/throw_fields.h"
#include "scene/record/trial.h"

/// A trial as tables in CSV: one row per observation, one column per quantity.
namespace headpin::scene {

/// One column of one table.
struct TableColumn {
  std::string table;    ///< "trackers", "buttons", "events", "throws", "states" or "frames"
  std::string name;     ///< with the unit last
  std::string kind;     ///< "number", "whole", "text", "yes/no" (1 or 0) or "hash" (16 hex digits)
  std::string unit;     ///< empty where there is none
  std::string meaning;  ///< a sentence's worth
};

/// Every column of every table, in their order.
std::vector<TableColumn> table_columns();

/// Names of the tables, in their order.
std::vector<std::string> table_names();

/// Makes the rows of one table of a trial.
class TableRows {
 public:
  using Take = std::function<void(std::span<const TableValue> row)>;
  using Walk = std::function<std::optional<Vec3>(Time taken_in)>;

  /// @param header  of the trial
  /// @param take    called with each row: one value per column
  /// @param walk    p_WP of the tracked space when a sample was used; none if unknown
  /// @throws std::invalid_argument  for an unknown table
  TableRows(std::string_view table, const TrialHeader& header, Take take, Walk walk = {});
  ~TableRows();
  TableRows(TableRows&&) noexcept;

  /// Messages that do not belong to this table are skipped.
  void add(const devices::Sample& sample);
  void add(const Event& event);
  void add(const ThrowRow& row);
  void add(const TickState& state);
  void add(const FrameRecord& frame);

 private:
  struct Table;
  std::unique_ptr<Table> table_;
};

/// Writes one table of a trial as CSV (RFC 4180, lines end with LF): names, then rows.
///
/// Numbers are the shortest that read back to the same bits; times are exact, in decimal seconds.
class TableWriter {
 public:
  /// @param out  must outlive this; the others as for TableRows
  /// @throws std::invalid_argument  for an unknown table
  TableWriter(std::ostream& out, std::string_view table, const TrialHeader& header,
              TableRows::Walk walk = {});

  template <typename Message>
  void add(const Message& message) {
    table_.add(message);
  }

  std::int64_t rows() const { return *rows_; }

 private:
  std::unique_ptr<std::int64_t> rows_;
  TableRows table_;
};

/// The names in a cell of the column bodies.
std::vector<std::string> bodies_in(std::string_view cell);

/// Describes every column, as CSV: table, column, kind, unit, meaning.
void write_dictionary(std::ostream& out);

}  // namespace headpin::scene
