#include "devices/base/resample.h"

#include <algorithm>

namespace headpin::devices {

bool PoseTrack::push(Time time, const Pose& pose) {
  if (!samples_.empty() && time <= samples_.back().time) return false;
  samples_.push_back({time, pose});
  return true;
}

std::optional<KnownPose> PoseTrack::read(Time time) const {
  if (samples_.empty()) return std::nullopt;
  const auto after =
      std::upper_bound(samples_.begin(), samples_.end(), time,
                       [](Time t, const Stamped<Pose>& sample) { return t < sample.time; });
  if (after == samples_.begin()) return KnownPose{after->value, PoseKnown::held, after->time};
  const auto before = after - 1;
  const bool sampled = before->time == time;
  if (after == samples_.end()) {
    return KnownPose{before->value, sampled ? PoseKnown::sampled : PoseKnown::held, before->time};
  }
  const double part = seconds(time - before->time) / seconds(after->time - before->time);
  return KnownPose{interpolate(before->value, after->value, part),
                   sampled ? PoseKnown::sampled : PoseKnown::interpolated, before->time};
}

std::optional<Pose> PoseTrack::at(Time time) const {
  const std::optional<KnownPose> known = read(time);
  return known ? std::optional(known->pose) : std::nullopt;
}

void PoseTrack::forget_before(Time time) {
  const auto after =
      std::upper_bound(samples_.begin(), samples_.end(), time,
                       [](Time t, const Stamped<Pose>& sample) { return t < sample.time; });
  if (after - samples_.begin() > 1) samples_.erase(samples_.begin(), after - 1);
}

}  // namespace headpin::devices
