#pragma once

#include <optional>
#include <span>

#include "devices/base/clock_offset.h"
#include "devices/base/genlock.h"
#include "engine/math.h"

namespace headpin::devices {

/// Estimates when each record of a Fastrak was measured, from when it arrived.
///
/// The unit measures every 1/120 s, its stations in turn: its cycles are its clock, and ClockOffset
/// carries them over to ours.
///
/// A record that is late by a turn or more either follows some that never came, or was held up like
/// those that come in one go with it. The next record tells; until then this one has to wait.
class FastrakClock {
 public:
  /// @param active_stations  1 to 4: they take turns, a cycle each
  /// @param byte_time        of one byte on the line
  /// @param record_length    in bytes; a line too slow for one a cycle makes the unit skip turns
  /// @param genlock          takes the cycles for the session's clock; null: there is none
  FastrakClock(int active_stations, Time byte_time, std::size_t record_length,
               Genlock* genlock = nullptr);

  /// Time of the measurement behind a record, later than the one before.
  ///
  /// @param turn      place of its station among the active ones, from 0
  /// @param arrivals  by when its first byte had arrived, and those of the records behind it that
  ///                  came up to now; never too early
  /// @return          nothing when it is too soon to tell: the same record is to be asked for again
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
