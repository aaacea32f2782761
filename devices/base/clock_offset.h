#pragma once

#include <limits>
#include <optional>

#include "engine/math.h"

namespace headpin::devices {

/// Carries times of another clock over to ours, by messages that arrive late, never early.
///
/// The message that was late the least shows what the clocks differ by. So the offset comes back
/// when one is later by less than foreseen, by little at once, as speeds are made from intervals;
/// and otherwise moves only by what all messages of about a second were late: that is the drift of
/// one clock against the other.
class ClockOffset {
 public:
  /// @param theirs_us  when it was measured or sent, on their clock
  /// @param seen_us    by when that had been, on ours: when it arrived, less what it is late always
  /// @return           `theirs_us` on our clock [us]
  double carry_over(double theirs_us, double seen_us);

  /// Of a time near the last one, without learning from it. @pre  started()
  double ours(double theirs_us) const { return theirs_us + *offset_us_; }
  bool started() const { return offset_us_.has_value(); }

 private:
  void correct(double late_us, double passed_us);

  std::optional<double> offset_us_;
  double last_us_ = 0.0;  ///< on their clock

  static constexpr double kNone = std::numeric_limits<double>::infinity();
  double least_late_us_ = kNone;  ///< in the window at hand
  double window_us_ = 0.0;        ///< of which so much is over
  double drift_ = 0.0;
};

}  // namespace headpin::devices
