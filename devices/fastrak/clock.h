#pragma once

#include <optional>
#include <span>

#include "devices/base/clock_offset.h"
#include "devices/base/genlock.h"
#include "engine/math.h"

namespace headpin::devices {

/// Estimates the time of measurement of each record of a Fastrak from its time of arrival.
///
/// The unit measures every 1/120 s, its stations in turn. Its cycles are its clock, and ClockOffset
/// converts it to ours.
///
/// If a record is late by a turn or more, either records before it were lost, or it was delayed
/// together with the records that arrive with it. The next record shows which; until then this
/// record waits.
class FastrakClock {
 public:
  /// @param active_stations  1 to 4: they take turns, a cycle each
  /// @param byte_time        of one byte on the line
  /// @param record_length    in bytes; a line too slow for one a cycle makes the unit skip turns
  /// @param genlock          uses the cycles as the session's clock; may be null
  FastrakClock(int active_stations, Time byte_time, std::size_t record_length,
               Genlock* genlock = nullptr);

  /// The time of measurement of a record, later than that of the record before.
  ///
  /// @param turn      place of its station among the active ones, from 0
  /// @param arrivals  by when its first byte had arrived, and those of the records behind it that
  ///                  came up to now; never too early
  /// @return          nothing when it is too early to decide; call again for the same record
  std::optional<Time> measured(int turn, std::span<const Time> arrivals, Time now);

  /// Number of the last record's cycle, the first one's being its turn; a hole is a record that did
  /// not come.
  std::int64_t cycle() const { return cycle_; }
  bool started() const { return offset_.started(); }

 private:
  int active_;
  Genlock* genlock_;
  double lag_us_;
  double line_cycles_;    ///< that the line takes for a record
  ClockOffset offset_;    ///< from its cycles, in microseconds
  double last_us_ = 0.0;  ///< estimate for the last record
  Time handed_out_{};     ///< for the last record
  int turn_ = 0;
  std::int64_t cycle_ = 0;
};

}  // namespace headpin::devices
