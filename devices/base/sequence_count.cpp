#include "devices/base/sequence_count.h"

#include <algorithm>

namespace headpin::devices {

std::int64_t SequenceCount::take(std::int64_t number, Time measured) {
  if (last_ && number <= *last_ && measured <= measured_) {
    if (fill(number)) return -1;
    ++repeated_;
    return 0;
  }
  std::int64_t missing = 0;
  if (last_ && number > *last_ + 1) {
    missing = number - *last_ - 1;
    holes_.emplace_back(*last_ + 1, number - 1);
    if (holes_.size() > kMostHoles) holes_.pop_front();
  } else if (!last_ || number <= *last_) {
    holes_.clear();  // measured later, with a lower number: numbering has restarted
  }
  measured_ = last_ ? std::max(measured_, measured) : measured;
  last_ = number;
  lost_ += missing;
  return missing;
}

/// @return  whether it was missing
bool SequenceCount::fill(std::int64_t number) {
  const auto hole = std::ranges::find_if(
      holes_, [&](const auto& h) { return h.first <= number && number <= h.second; });
  if (hole == holes_.end()) return false;
  const auto [first, last] = *hole;
  const auto at = holes_.erase(hole);
  const auto behind = number < last ? holes_.insert(at, {number + 1, last}) : at;
  if (first < number) holes_.insert(behind, {first, number - 1});
  --lost_;
  return true;
}

}  // namespace headpin::devices
