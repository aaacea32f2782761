#pragma once

#include <optional>

#include "engine/math.h"

namespace headpin::devices {

/// Holds a live session's clock to that of its first tracker, as a studio's cameras are held to one
/// (genlock).
///
/// Two clocks of their own put a tracker's measurements now here, now there between two ticks, and
/// where they are there decides close throws. Held, the tracker's clock differs from the session's by
/// whole steps of a grid of ticks, for good: the same measurements meet the same ticks in every
/// session. What the session's clock is off by is made up by a tick that lasts a little longer or
/// shorter; no measurement's time is bent.
class Genlock {
 public:
  /// @param rate_hz  of the ticks. The grid is as many of them as are whole microseconds, 12.5 ms of
  ///                 240 Hz, so that it is the same from each step of it; of rates where those
  ///                 would be more than 25 ms, single ticks, and the same to a microsecond.
  explicit Genlock(std::int64_t rate_hz);

  /// By what a clock is to be taken to differ from the session's.
  ///
  /// The first that asks is the one that is held to; it is so again when it jumps. Another that
  /// differs from the session's by the same but for what messages are late is the same clock.
  ///
  /// @param whose         tells one from the other; null for one that is never held to
  /// @param estimated_us  of its times, to be added to them
  double offset_us(const void* whose, double estimated_us);

  /// By how much longer than its length the next tick is to last; less than nothing: shorter.
  ///
  /// At most a hundredth longer, or a thousandth shorter.
  double stretch_us(Time tick);

 private:
  double grid_us_;
  const void* held_to_ = nullptr;
  std::optional<double> offset_us_;
  double off_us_ = 0.0;  ///< what the session's clock is ahead of where it ought to be
};

}  // namespace headpin::devices
