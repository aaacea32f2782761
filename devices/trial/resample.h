#pragma once

#include <optional>
#include <vector>

#include "engine/math.h"

namespace headpin::devices {

/// The recent poses of one sensor, oldest first, for interpolation.
class PoseTrack {
 public:
  /// Adds a pose; one that is not later than the last one is dropped.
  /// @return whether it was taken
  bool push(Time time, const Pose& pose);

  /// The pose at `time`, interpolated; constant before the first and after the last sample. Nothing
  /// for an empty track.
  std::optional<Pose> at(Time time) const;

  /// Removes samples before `time`, except the last of them.
  void forget_before(Time time);

  const std::vector<Stamped<Pose>>& samples() const { return samples_; }

 private:
  std::vector<Stamped<Pose>> samples_;
};

}  // namespace headpin::devices
