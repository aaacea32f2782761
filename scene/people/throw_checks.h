#pragma once

#include <string>
#include <vector>

#include "scene/people/throw.h"

/// Whether a recording is a person's throw.
namespace headpin::scene {

/// The reasons why a recording is not a person's throw: sentences with what was found and what was
/// expected. Empty for a person's throw.
///
/// Checks length and rate, height and tilt of the head, reach and speed of the hands, the direction
/// of the gaze, and the side of the throwing hand.
std::vector<std::string> why_no_throw(const devices::MotionRecording& recording, const Hand& hand,
                                      Side side = Side::right);

/// The reason why a recording of a head alone is not that of a person's: how high it is at first, or that it is too
/// fast for much of the time, measured over 50 ms. Empty for a person's head.
std::string why_no_head(const devices::MotionRecording& recording);

/// When the head of such a recording is too fast for a person, if it seldom is: a sentence. Empty for a good
/// recording.
std::vector<std::string> doubts_about_head(const devices::MotionRecording& recording);

/// Reasons why the release is less accurate: a low sample rate, long gaps, repeated poses. Sentences; empty for a
/// good recording.
///
/// @param found  its throw, as find_throw() finds it
std::vector<std::string> doubts(const devices::MotionRecording& recording, const Throw& found);

/// The hand with which the recording is a person's throw; or else the faster hand.
Side throwing_side(const devices::MotionRecording& recording, const Hand& hand);

/// A recording of which the rotation of the head was not measured, with a head that looks level along
/// the throw. Others are returned unchanged.
devices::MotionRecording looking_along(devices::MotionRecording recording, const Hand& hand,
                                       Side side);

}  // namespace headpin::scene
