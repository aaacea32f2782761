#pragma once

#include <optional>
#include <stdexcept>
#include <string>

#include "scene/people/throw.h"

/// How the numbers of a file would be a person's throw.
namespace headpin::scene {

/// A recording that cannot be a person's throw.
struct NoThrow : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
  /// How the file's numbers would be a person's throw, if there is such a way.
  std::optional<devices::Reading> would_be = {};
};

/// Throws an exception if the recording cannot be a person's throw.
///
/// If it would be one with other units, axes, times or quaternions, or by the other hand, the message
/// says so.
///
/// @param where  name of the file, for the message
/// @throws NoThrow
void require_throw(const devices::MotionRecording& recording, const Hand& hand,
                   const std::string& where, Side side = Side::right);

/// How the file's numbers would be a person's throw: one change of unit, of time, of the quaternion's
/// order, of axes (of positions and rotations, or of one of them), or of unit and axes together.
/// @param what  in words, such as "in centimetres"
std::optional<devices::Reading> reading_of_a_throw(const devices::MotionRecording& recording,
                                                   const Hand& hand, Side side, std::string& what);

/// A recording of which a part says no unit of positions, beside others that say one: in that unit, or in another
/// one where it is a person's throw only so, or at least a person's head; with a note. Others are returned unchanged.
///
/// @param head_alone  the hands do not count
devices::MotionRecording in_likely_units(devices::MotionRecording recording, const Hand& hand,
                                         bool head_alone);

/// A reading in other axes, units and so on, of the same recording.
devices::MotionRecording read_again(devices::MotionRecording recording,
                                    const devices::Reading& reading);

}  // namespace headpin::scene
