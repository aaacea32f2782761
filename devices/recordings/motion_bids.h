#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "devices/recordings/motion_files.h"

namespace headpin::devices {

/// What stands beside a ..._motion.tsv.
struct BidsFrame {
  std::string name = {};  ///< of the reference frame that the channels name; may be empty
  std::string axes = {};  ///< where +x, +y and +z point, as MotionOptions has it
  /// Axes of the angles, where the user said others than those of positions; else empty.
  std::string turning = {};
  std::string rotation_order =
      {};  ///< of Euler angles: about the frame's fixed axes, the first first
  /// By which hand angles turn about an axis. Where nothing says it, by the hand of the axes.
  std::optional<bool> left_handed = {};
  std::vector<std::string> others = {};  ///< tracked points in other frames, which are left out
  double rate_hz = 0.0;        ///< of the samples, where no LATENCY channel has their times
  std::string rate_from = {};  ///< what says it: "SamplingFrequency"; for a note
  /// What stands besides n/a in cells that are not known: "NaN", "-9999", "0". Where it is 0, a 0 may be measured
  /// in a unit quaternion, and as a time in the first row or after an earlier one.
  std::string missing = {};
};

/// The reference frame of most tracked points, with its name, axes, rotation order and rule, as far as
/// they are said, and the points that are in others.
///
/// @param channels  the ..._channels.tsv; its column reference_frame names a level
/// @param levels    the ..._channels.json that describes the levels; empty where there is none
/// @param where     name of the ..._motion.tsv
/// @param axes      that the user says, and that hold for any frame; empty if none
/// @throws std::invalid_argument  where positions and orientations of one point are in different frames, as
///                                many points are in one frame as in another of different meaning, or nothing
///                                says which frame it is
BidsFrame bids_frame(std::string_view channels, std::string_view levels, std::string_view where,
                     const std::string& axes = {});

/// The tracked points of a Motion-BIDS recording, in our frame. Samples with n/a or what stands for it in them,
/// those without a unit quaternion, and those at the time of the one before are left out, with notes. So are
/// points without a whole place and rotation, but for those that are needed.
///
/// @param motion    the ..._motion.tsv, numbers only
/// @param channels  the ..._channels.tsv that names its columns
/// @param names     of head and hands, as MotionOptions has them
/// @param turns     false: rotations are not read, and need not be there
/// @throws std::invalid_argument  naming the file, and the line if there is one: no times, what is no number,
///                                most rows of a point without a rotation, a head or hand that is not whole
MotionTracks parse_motion_bids(std::string_view motion, std::string_view channels,
                               std::string_view where, const BidsFrame& frame,
                               const std::array<std::string, 3>& names = {}, bool turns = true);

}  // namespace headpin::devices
