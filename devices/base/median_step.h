#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace headpin::devices {

/// The steps by which times advance, in their order; steps back and repeated times are left out.
inline std::vector<double> steps_ahead(const std::vector<double>& times) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < times.size(); ++i) {
    if (times[i] > times[i - 1]) steps.push_back(times[i] - times[i - 1]);
  }
  return steps;
}

/// The median of the steps by which times advance, which lost samples and pauses hardly change.
///
/// @param times  in the order of the samples; steps back and repeated times do not count
/// @return       in the unit of the times; 0 where they never advance
inline double median_step(const std::vector<double>& times) {
  std::vector<double> steps = steps_ahead(times);
  if (steps.empty()) return 0.0;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

/// The mean of the steps that differ from the median by less than half of it. In whole milliseconds, 60 Hz has
/// steps of 16 and 17 ms: their median is 17 ms, this is 16.67 ms.
///
/// @param times, @return  as above
inline double usual_step(const std::vector<double>& times) {
  const double median = median_step(times);
  double sum = 0.0, count = 0.0;
  for (const double step : steps_ahead(times)) {
    if (!(std::abs(step - median) < 0.5 * median)) continue;
    sum += step;
    count += 1.0;
  }
  return count > 0.0 ? sum / count : 0.0;
}

}  // namespace headpin::devices
