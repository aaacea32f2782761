#include "devices/trial/resample.h"

#include <algorithm>

namespace headpin::devices {

bool PoseTrack::push(Time time, const Pose& pose) {
  if (!samples_.empty() && time <= samples_.back().time) return false;
  samples_.push_back({time, pose});
  return true;
}

std::optional<Pose> PoseTrack::at(Time time) const {
  if (samples_.empty()) return std::nullopt;
  const auto after =
      std::upper_bound(samples_.begin(), samples_.end(), time,
                       [](Time t, const Stamped<Pose>& sample) { return t < sample.time; });
  if (after == samples_.begin()) return after->value;
  const auto before = after - 1;
  if (after == samples_.end()) return before->value;
  return interpolate(before->value, after->value,
                     seconds(time - before->time) / seconds(after->time - before->time));
}

void PoseTrack::forget_before(Time time) {
  const auto after =
      std::upper_bound(samples_.begin(), samples_.end(), time,
                       [](Time t, const Stamped<Pose>& sample) { return t < sample.time; });
  if (after - samples_.begin() > 1) samples_.erase(samples_.begin(), after - 1);
}

}  // namespace headpin::devices
