#pragma once

#include <optional>
#include <span>

#include "base/math.h"
#include "devices/base/clocks.h"

namespace headpin::devices {

/// Estimates the time of measurement of each record of a Fastrak from its time of arrival.
///
/// The unit measures every 1/120 s, its stations in turn. Its cycles are a clock of the
/// session's Clocks.
///
/// If a record is late by a turn or more, either records before it were lost, or it was delayed
/// together with the records that arrive with it. The next record shows which; until then this
/// record waits.
class FastrakClock {
 public:
  /// @param active_stations  1 to 4: they take turns, a cycle each
  /// @param byte_time        of one byte on the line
  /// @param record_length    in bytes; a line too slow for one a cycle makes the unit skip turns
  /// @param clocks           must outlive this
  /// @param cycles           the clock of the unit's cycles there, which restarts
  FastrakClock(int active_stations, Time byte_time, std::size_t record_length, Clocks& clocks,
               ClockId cycles);

  /// The time of measurement of a record, later than that of the record before.
  ///
  /// @param turn      place of its station among the active ones, from 0
  /// @param arrivals  by when its first byte had arrived, and those of the records behind it that
  ///                  came up to now; never too early
  /// @return          nothing when it is too early to decide; call again for the same record
  std::optional<Time> measured(int turn, std::span<const Time> arrivals, Time now);

  /// Number of the last record among those that the line can carry, the first one's being its turn;
  /// a hole is a record that did not come.
  std::int64_t record() const { return record_; }
  bool started() const { return clocks_.started(cycles_); }

 private:
  std::int64_t records_in(std::int64_t cycles, int offset) const;

  int active_;
  Clocks& clocks_;
  ClockId cycles_;
  double lag_us_;
  double line_cycles_;  ///< that the line takes for a record
  int turn_ = 0;
  std::int64_t cycle_ = 0;   ///< of the last record
  std::int64_t record_ = 0;  ///< its number
  std::int64_t step_ = 1;    ///< cycles from a record to the next station's, if none is lost
};

}  // namespace headpin::devices
