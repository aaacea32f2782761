#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "scene/people/throw.h"

/// Measurements on the tracks of a recorded throw, in its own frame. For the sources of throw.h.
namespace headpin::scene {

inline const Vec3 kUp = Vec3::UnitY();
inline constexpr double kSlowestThrow = 3.0;  ///< least top speed of the hand in a throw [m/s]
inline constexpr double kLongestGap = 0.1;    ///< between two samples of a throw [s]
inline constexpr Time kReadLate{28'000};      ///< a pose is used this long after its sample

inline Vec3 horizontal(const Vec3& v) {
  return Vec3(v.x(), 0.0, v.z());
}

/// The samples from `begin` to before `end`, as a recording of its own, whose times begin at 0.
devices::MotionRecording samples_of(const devices::MotionRecording& r, std::size_t begin,
                                    std::size_t end);

/// Velocity of a track at a sample, from the samples before and after it.
Vec3 velocity(const std::vector<Time>& times, const std::vector<Pose>& track, std::size_t i);

/// The largest speed between neighbours of a sample.
double fastest(const devices::MotionRecording& r, const std::vector<Pose>& track);

/// Motion of a ball held at p_HB, at its release, in the recording's frame; computed like in a session that uses
/// each pose kReadLate after its sample.
Motion ball_motion(const devices::MotionRecording& r, Time release, Side side, const Vec3& p_HB,
                   const Hand& rules);

/// Velocity of the hand at the release, with the same fit as for the ball.
Vec3 hand_velocity_at(const devices::MotionRecording& r, const Throw& found, const Hand& hand);

/// The samples of the second before the release: the first one and the end. In this second the
/// thrower has lifted the ball and sees the lane.
std::pair<std::size_t, std::size_t> samples_of_swing(const devices::MotionRecording& r,
                                                     const Throw& found);

/// The mean direction of sight in that second; not of unit length.
Vec3 mean_gaze(const devices::MotionRecording& r, const Throw& found);

}  // namespace headpin::scene
