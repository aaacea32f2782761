#include "devices/base/genlock.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace headpin::devices {
namespace {

// Largest difference of the delays of one clock's messages on a busy machine; and the change of an
// estimate from which a clock counts as set to another time.
constexpr double kSameOffset_us = 5e3, kSetAnew_us = 15e3;
constexpr double kWidestGrid_us = 25e3;  // largest delay of poses until it is corrected
constexpr double kMadeUpIn_us = 1e6;     // time constant of the correction
constexpr double kMostLonger = 1e-2, kMostShorter = 1e-3;

}  // namespace

Genlock::Genlock(std::int64_t rate_hz)
    : grid_us_(1e6 / static_cast<double>(std::gcd(std::int64_t{1'000'000}, rate_hz))) {
  if (grid_us_ > kWidestGrid_us) grid_us_ = 1e6 / static_cast<double>(rate_hz);
}

double Genlock::follow(double estimated_us) {
  // Rounded down, so that the session waits for the tracker and not the tracker for the session.
  if (!offset_us_ || std::abs(estimated_us - *offset_us_) > std::max(grid_us_, kSetAnew_us)) {
    offset_us_ = std::floor(estimated_us / grid_us_) * grid_us_;
  }
  off_us_ = estimated_us - *offset_us_;
  return *offset_us_;
}

double Genlock::same_or_own(double estimated_us) const {
  // Beside what the reference's is by now: the session's clock makes up for the rest in a second or more.
  const bool same = offset_us_ && std::abs(estimated_us - *offset_us_ - off_us_) < kSameOffset_us;
  return same ? *offset_us_ : estimated_us;
}

double Genlock::stretch_us(Time tick) {
  const auto length_us = static_cast<double>(tick.count());
  const double stretch_us = std::clamp(off_us_ * length_us / kMadeUpIn_us,
                                       -kMostShorter * length_us, kMostLonger * length_us);
  off_us_ -= stretch_us;
  return stretch_us;
}

}  // namespace headpin::devices
