#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "devices/recordings/reading.h"

namespace headpin::devices {

/// Of a recording that can be a throw.
inline constexpr std::size_t kFewestSamples = 100;

/// Head and hands of one person, as recorded; entry i of each list is at times[i]. A hand that was
/// not tracked has an empty list.
///
/// In the frame of the recording: right-handed, x right, y up, the floor at y = 0; a head or hand
/// at rest has its axes along those, looking along -z.
struct MotionRecording {
  std::vector<Time> times;              ///< since the start, increasing
  std::vector<Pose> head;               ///< [m]
  std::vector<Pose> left_hand;          ///< [m]
  std::vector<Pose> right_hand;         ///< [m]
  std::vector<std::string> notes = {};  ///< notes about ignored parts of the file
  /// Changes of each hand's trigger, left and right; empty where there is none, or it was not pressed.
  std::array<std::vector<Stamped<bool>>, 2> triggers = {};
  bool head_turns = true;        ///< the head's rotation was measured
  bool hands_turn = true;        ///< the hands' rotations were measured
  bool head_moves = true;        ///< the head's place was measured, not given by the user
  Reading reading = {};          ///< how the numbers of the file were read
  Vec3 p_origin = Vec3::Zero();  ///< where they count from [m]
  Time start{};                  ///< time of the first sample in the file
};

}  // namespace headpin::devices
