#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace headpin::devices {

/// The median of the steps by which times advance, which lost samples and pauses hardly change.
///
/// @param times  in the order of the samples; steps back and repeated times do not count
/// @return       in the unit of the times; 0 where they never advance
inline double median_step(const std::vector<double>& times) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < times.size(); ++i) {
    if (times[i] > times[i - 1]) steps.push_back(times[i] - times[i - 1]);
  }
  if (steps.empty()) return 0.0;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

}  // namespace headpin::devices
