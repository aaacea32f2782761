#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "devices/recordings/motion_files.h"

namespace headpin::devices {

/// The sensors of a VRPN log, by DEVICE:NUMBER, as they are written there; time since the first.
///
/// @param notes  gets a note if the log ends within a message
/// @param turns  false: rotations are not read
std::vector<std::pair<std::string, PoseTrack>> parse_vrpn(std::span<const std::uint8_t> bytes,
                                                          std::string_view where, double unit_m,
                                                          std::vector<std::string>& notes,
                                                          bool turns = true);

}  // namespace headpin::devices
