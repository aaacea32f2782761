#include "devices/base/clock_offset.h"

#include <algorithm>

namespace headpin::devices {
namespace {

constexpr double kWindow_us = 1e6;
constexpr double kMostDrift = 1e-3;      // ten times the difference of quartz clocks
constexpr double kMostStep_us = 900.0;   // largest correction backwards at once
constexpr double kBeyondDelay_us = 8e3;  // earlier by more: the old offset was wrong

}  // namespace

double ClockOffset::carry_over(double theirs_us, double seen_us) {
  if (!offset_us_) {
    offset_us_ = seen_us - theirs_us;
  } else if (theirs_us < last_us_) {
    return ours(theirs_us);  // out of order: no new information
  } else {
    correct(seen_us - ours(theirs_us), theirs_us - last_us_);
  }
  last_us_ = theirs_us;
  return ours(theirs_us);
}

void ClockOffset::correct(double late_us, double passed_us) {
  if (late_us < 0.0) {
    *offset_us_ += late_us < -kBeyondDelay_us ? late_us : std::max(late_us, -kMostStep_us);
  } else {
    *offset_us_ += std::min(late_us, drift_ * passed_us);
  }
  least_late_us_ = std::min(least_late_us_, std::max(0.0, late_us));
  window_us_ += passed_us;
  if (window_us_ < kWindow_us) return;
  // Correct half of it in the next window; a larger part would oscillate.
  drift_ = std::min(0.5 * least_late_us_ / window_us_, kMostDrift);
  least_late_us_ = kNone;
  window_us_ = 0.0;
}

}  // namespace headpin::devices
