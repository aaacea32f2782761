#pragma once

#include <algorithm>
#include <optional>
#include <span>

#include "scene/play/hand.h"
#include "scene/record/details.h"

/// Velocity and spin of the ball at the time of the trigger, how they are known, and the hand's pose.
namespace headpin::scene {

/// Longest delay of a sample: that of a Fastrak at 115200 baud.
inline constexpr Time kSampleLatency{8'000};

/// The time of the last sample that is used for a release at `time`, when poses are told so long
/// before they are read (`rig.delay_s` and `rig.predicted_s`): only samples that have arrived in any
/// case, so that a throw does not depend on the arrival times.
inline Time told_until(Time time, double before_s) {
  return time + std::max(Time{}, microseconds(before_s) - kSampleLatency);
}

/// The velocity of a point of the hand at a time.
///
/// Fits a cubic to the hand's positions and rotations before and after that time. The weight of a
/// sample decreases to zero at the end of the window, so the result is a smooth function of time
/// (docs/release.md explains this fit). The window has the length `window.least`, and up to
/// `window.most` if the tracker is noisy. Samples that a hand cannot reach from their neighbours
/// are left out, and so is one that disagrees with the fit of all others. Without a sample after
/// the time, the fit is extrapolated for 30 ms after the last sample; then the velocity stays
/// constant. A sample older than `window.least` is not used. The pose is that between the samples
/// that are used; it is not extrapolated, and there is none where no sample is used.
///
/// @param track  hand poses X_PH in the tracked space, oldest first, as far as they are known; the
///               motion is in that space too, and the walk is to be added
/// @param p_HB   the point in the hand [m]
Motion motion_at(std::span<const Stamped<Pose>> track, Time at, const Vec3& p_HB,
                 const ReleaseWindow& window);

}  // namespace headpin::scene
