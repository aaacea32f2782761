#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace headpin::scene {

/// A histogram of delays, whose size does not grow with their number.
///
/// Its bins are 1 % wide, from 1 microsecond to about 1000 s.
class Delays {
 public:
  /// @param s  a delay [s]; negative ones count as 0
  void add(double s) {
    most_ = std::max(most_, s);
    const double bin = s > kLeast ? std::log(s / kLeast) / kStep : 0.0;
    ++counts_[static_cast<std::size_t>(std::min(bin, static_cast<double>(kBins - 1)))];
    ++count_;
  }
  std::int64_t count() const { return count_; }

  /// The quantile of the delays [s], accurate to 1 % of it or 1 microsecond; 0 without delays.
  ///
  /// @param share  0 to 1: 0.5 is the median, 1 the largest delay, which is exact
  double quantile(double share) const {
    if (share >= 1.0) return most_;
    const double before = share * static_cast<double>(count_ - 1);
    std::int64_t counted = 0;
    for (std::size_t i = 0; i + 1 < kBins; ++i) {
      counted += counts_[i];
      if (counted > 0 && static_cast<double>(counted) > before) {
        return std::min(most_, kLeast * std::exp(kStep * (static_cast<double>(i) + 0.5)));
      }
    }
    return most_;
  }

 private:
  static constexpr double kLeast = 1e-6;      // s: the upper end of the first bin
  static constexpr double kStep = 0.01;       // of the bins' logarithms
  static constexpr std::size_t kBins = 2100;  // the last one: all from 1300 s on
  std::vector<std::int64_t> counts_ = std::vector<std::int64_t>(kBins);
  std::int64_t count_ = 0;
  double most_ = 0.0;  ///< [s]
};

}  // namespace headpin::scene
