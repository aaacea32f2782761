#pragma once

#include <optional>
#include <vector>

#include "base/math.h"

namespace headpin::devices {

/// How a pose of a track is known. Nothing is ever extrapolated.
enum class PoseKnown { sampled, interpolated, held };

struct KnownPose {
  Pose pose;
  PoseKnown how = PoseKnown::sampled;
  Time last{};  ///< of the last sample up to that time; before the first sample, its time
};

/// The recent poses of one sensor, oldest first, for interpolation.
class PoseTrack {
 public:
  /// Adds a pose; one that is not later than the last one is dropped.
  /// @return whether it was taken
  bool push(Time time, const Pose& pose);

  /// The pose at `time`: that of a sample, interpolated between two, or held before the first and
  /// after the last. Nothing for an empty track.
  std::optional<KnownPose> read(Time time) const;
  /// The pose of read().
  std::optional<Pose> at(Time time) const;

  /// Removes samples before `time`, except the last of them.
  void forget_before(Time time);

  const std::vector<Stamped<Pose>>& samples() const { return samples_; }

 private:
  std::vector<Stamped<Pose>> samples_;
};

}  // namespace headpin::devices
