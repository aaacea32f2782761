#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace headpin::scene {

/// The quantile of the values; 0 without values.
///
/// @param share  0 to 1: 0.5 is the median
inline double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, at);
  return *at;
}

}  // namespace headpin::scene
