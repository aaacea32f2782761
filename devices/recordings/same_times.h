#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

#include "devices/base/resample.h"
#include "devices/recordings/motion_recording.h"

/// Head and hands, each with its own times, as one recording.
namespace headpin::devices {

/// Head, left and right hand, as kPartNames; null for one that was not tracked.
using PartTracks = std::array<const PoseTrack*, 3>;

/// The part that throws: the only hand, the told one, or the one that is faster at its fastest. Without
/// hands it is the head.
std::size_t throwing_part(const PartTracks& tracks, std::optional<bool> left_throws = {});

/// The part whose times a recording takes: the throwing one; the head, if the hand has more samples a second than a trial
/// may have (250) and the head has not.
std::size_t timing_part(const PartTracks& tracks, std::size_t thrower);

/// Head and hands at the times of one of them, while head and throwing hand are both tracked. The others are
/// interpolated.
///
/// Samples in a gap of the head above 0.1 s are left out; a gap of the throwing hand is one of the
/// recording. An idle hand that is not tracked keeps its first or its last pose; in its gaps it is
/// interpolated. Notes say so, and tell tracks that have another rate.
///
/// @param tracks   with a head
/// @param thrower  throwing_part(); 0 for a recording of the head
/// @param timer    whose times are taken: timing_part(), so that each sample of the throwing hand is kept
/// @throws std::invalid_argument  when head and throwing hand were never tracked at the same time
MotionRecording together(const PartTracks& tracks, std::size_t thrower, std::size_t timer,
                         std::string_view where);

}  // namespace headpin::devices
