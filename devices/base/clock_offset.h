#pragma once

#include <limits>
#include <optional>

#include "base/math.h"

namespace headpin::devices {

/// Converts times of another clock to ours, from messages that may arrive late but never early.
///
/// The message with the smallest delay shows the offset of the clocks. So the offset is corrected
/// when a message has a smaller delay than expected, in small steps, because speeds are computed
/// from intervals. Otherwise it follows the smallest delay of about a second, which is the drift of
/// the clocks.
class ClockOffset {
 public:
  /// @param theirs_us  when it was measured or sent, on their clock
  /// @param seen_us    its time of arrival on our clock, minus the constant part of the delay
  /// @return           `theirs_us` on our clock [us]
  double carry_over(double theirs_us, double seen_us);

  /// Converts a time near the last one, without a correction. @pre  started()
  double ours(double theirs_us) const { return theirs_us + *offset_us_; }
  bool started() const { return offset_us_.has_value(); }

 private:
  void correct(double late_us, double passed_us);

  std::optional<double> offset_us_;
  double last_us_ = 0.0;  ///< on their clock

  static constexpr double kNone = std::numeric_limits<double>::infinity();
  double least_late_us_ = kNone;  ///< in the current window
  double window_us_ = 0.0;        ///< elapsed part of the window
  double drift_ = 0.0;
};

}  // namespace headpin::devices
