#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "base/math.h"
#include "devices/base/clock_offset.h"
#include "devices/base/genlock.h"

namespace headpin::devices {

/// Names one of the clocks of a session's devices.
enum class ClockId : std::size_t {};

/// Whether the session's clock may follow a clock.
enum class Lead { may, never };

/// What a source knows about the time of a measurement.
struct Measured {
  ClockId clock{};
  Time theirs{};            ///< by that clock
  double arrived_us = 0.0;  ///< by the session's clock, minus the constant part of the delay
  /// As `theirs`, with the part of a microsecond for a clock that has one.
  double theirs_us = static_cast<double>(theirs.count());
  double apart_us = 0.0;  ///< least time after the measurement before on this clock
};

/// Dates the measurements of a session: converts times of the devices' clocks to the session's.
///
/// Each clock has an offset, which it learns from the arrivals (ClockOffset). The session's clock
/// may follow the first one (Genlock).
class Clocks {
 public:
  /// From now on, the session's clock follows the first clock that dates a measurement and may lead.
  /// @param rate_hz  of the ticks, as Genlock takes it
  void follow_first(std::int64_t rate_hz) { genlock_.emplace(rate_hz); }

  ClockId add(Lead lead = Lead::may);

  /// The clock starts again, or it is another one by now. A leader stays the leader.
  void restart(ClockId clock) { at(clock).offset = {}; }

  /// The time of a measurement on the session's clock. A later one on the same clock stays later,
  /// even if the clock's offset was corrected.
  Time date(const Measured& measured);
  /// The same for one without a time of its own.
  Time date_by_arrival(ClockId clock, Time arrived);
  /// The same for one whose delay is not known, by a clock that shows the same time. Its own clock
  /// continues from the offset of that one. @pre  started(like)
  Time date_like(ClockId like, ClockId clock, Time theirs);

  /// Whether the clock has dated a measurement since it was added or restarted.
  bool started(ClockId clock) const { return at(clock).offset.started(); }
  /// The estimated time of the clock's last measurement. If the session's clock follows a clock, its
  /// date is a different one, see Genlock.
  double estimate_us(ClockId clock) const { return at(clock).estimate_us; }
  /// An estimate for a time near the last one, without a correction. @pre  started(clock)
  double ours_us(ClockId clock, double theirs_us) const { return at(clock).offset.ours(theirs_us); }

  /// The correction of the next tick's length, see Genlock; 0 without a leader.
  double stretch_us(Time tick) { return genlock_ ? genlock_->stretch_us(tick) : 0.0; }

 private:
  struct Clock {
    Lead lead = Lead::may;
    ClockOffset offset = {};
    double theirs_us = 0.0;    ///< of the measurement dated last, on its clock
    double estimate_us = 0.0;  ///< the same on the session's
    Time ours{};               ///< its date
  };
  Clock& at(ClockId clock) { return clocks_[static_cast<std::size_t>(clock)]; }
  const Clock& at(ClockId clock) const { return clocks_[static_cast<std::size_t>(clock)]; }
  Time held(Time theirs, const Clock& clock, double offset_us, bool leads);

  std::vector<Clock> clocks_;
  std::optional<Genlock> genlock_;
  std::optional<ClockId> leader_;
};

}  // namespace headpin::devices
