#pragma once

#include <string>
#include <string_view>

#include "devices/recordings/motion_files.h"

namespace headpin::devices {

/// What stands beside a ..._motion.tsv.
struct BidsFrame {
  std::string axes = {};  ///< where +x, +y and +z point, as MotionOptions has it
  std::string rotation_order =
      {};                    ///< of Euler angles: about the frame's fixed axes, the first first
  bool left_handed = false;  ///< its rotation rule
  double rate_hz = 0.0;      ///< of the samples, where no LATENCY channel has their times
};

/// The tracked points of a Motion-BIDS recording, in our frame. Samples with n/a in them, and those
/// at the time of the one before, are left out.
///
/// @param motion    the ..._motion.tsv, numbers only
/// @param channels  the ..._channels.tsv that names its columns
MotionTracks parse_motion_bids(std::string_view motion, std::string_view channels,
                               std::string_view where, const BidsFrame& frame);

}  // namespace headpin::devices
