#pragma once

#include <optional>

#include "base/math.h"

namespace headpin::devices {

/// Synchronises the clock of a live session with its first tracker, like the cameras of a studio
/// (genlock).
///
/// Without it, the tracker's measurements would drift between two ticks, and their place there
/// decides close throws. With it, the tracker's clock differs from the session's by a constant
/// multiple of a grid step, so the same measurements belong to the same ticks in every session.
/// Slightly longer or shorter ticks correct the session's clock; the times of measurements are not
/// changed.
class Genlock {
 public:
  /// @param rate_hz  of the ticks. A grid step is the smallest number of ticks that lasts whole
  ///                 microseconds, such as 3 ticks (12.5 ms) at 240 Hz. So the ticks are at the
  ///                 same microseconds within each grid step. If this would be more than 25 ms,
  ///                 a grid step is one tick, and they are the same to a microsecond.
  explicit Genlock(std::int64_t rate_hz);

  /// The offset that is used for the reference's clock against the session's, also after it jumps.
  /// @param estimated_us  its estimated offset, to be added to its times
  double follow(double estimated_us);

  /// The same for another clock. It counts as the same one if its offset is equal up to the delay of
  /// messages, and otherwise keeps its own.
  double same_or_own(double estimated_us) const;

  /// The correction of the next tick's length; negative for a shorter tick.
  ///
  /// At most a hundredth longer, or a thousandth shorter.
  double stretch_us(Time tick);

 private:
  double grid_us_;
  std::optional<double> offset_us_;  ///< of the reference
  double off_us_ = 0.0;              ///< how far the session's clock is ahead of its target
};

}  // namespace headpin::devices
