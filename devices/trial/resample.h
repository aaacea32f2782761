#pragma once

#include <optional>
#include <vector>

#include "engine/math.h"

namespace headpin::devices {

/// The recent poses of one sensor, oldest first, from which a pose at any time is read.
class PoseTrack {
 public:
  /// Adds a pose; one that is not later than the last one replaces nothing and is dropped.
  /// @return whether it was taken
  bool push(Time time, const Pose& pose);

  /// Pose at `time`: mixed from the samples on both sides of it, held before the first and after
  /// the last; nothing while the track is empty.
  std::optional<Pose> at(Time time) const;

  /// Forgets what is older than `time`, but for the last one before it.
  void forget_before(Time time);

  const std::vector<Stamped<Pose>>& samples() const { return samples_; }

 private:
  std::vector<Stamped<Pose>> samples_;
};

}  // namespace headpin::devices
