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

#include "scene/record/trial.h"

/// A trial as tables in CSV: one row per observation, one column per quantity.
namespace headpin::scene {

/// One throw of a session, from its events: a ball that the hand released.
struct ThrowRow {
  std::string version;                   ///< red or blue; empty where there are none
  int frame = 0, ball = 0;               ///< from 1; 0 where it was not counted
  std::string body;                      ///< which ball
  Time release{};                        ///< of the tick that let it go
  std::optional<double> trigger_s;       ///< when the trigger was let go, as its device tells it
  std::optional<Vec3> p_WB, v_WB, w_WB;  ///< of the ball then, in the world
  double speed = 0.0;                    ///< [m/s]
  std::string known;                     ///< how the release was known; empty where nothing tells
  std::optional<double> extrapolated_s;  ///< by so long from the nearest sample
  std::optional<int> left_out;           ///< samples that lie off what the others say
  std::optional<Time> entry;             ///< when it met its first skittle
  std::optional<double> entry_speed;     ///< just before [m/s]
  std::optional<double>
      entry_angle_deg;  ///< of its level velocity then, to the right of straight on
  std::optional<int> felled_by_ball, felled_by_hand;  ///< until the next ball
  std::optional<int> counted;  ///< in the sheet; other than felled by the ball after a foul
  std::optional<bool> foul;    ///< let go beyond the foul line
};

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

/// A value of a row: a number, a whole number, a hash, yes or no, a time, or a text. Nothing: it is
/// not known.
using TableValue =
    std::variant<std::monostate, double, std::int64_t, std::uint64_t, bool, Time, std::string>;

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

/// Describes every column, as CSV: table, column, kind, unit, meaning.
void write_dictionary(std::ostream& out);

}  // namespace headpin::scene
