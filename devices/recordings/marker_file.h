#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "devices/recordings/motion_recording.h"

namespace headpin::devices {

/// Whether words say that a hand grabs or holds (true), or that it lets go (false): see parse_markers().
std::optional<bool> pressed_by(const std::vector<std::string>& words);

/// Reads when a hand grabbed and released from a file of markers: a line each, with a time and a word.
///
/// Blank lines and remarks (#) are left out. The first line that is left may be a header. The time is its
/// column called onset, time or t, or else the first number of a line. Words for grab:
/// grab, grasp, pick, press, down, take, hold, and their forms; for release: release, throw, let go, drop,
/// up. Other lines are ignored.
///
/// @param unit_s  of times that are numbers [s]; dates of ISO 8601 need none
/// @param near    times of day without a date are of the day on which they are nearest to this; none: of one day
/// @return  times as in the file, in order
/// @throws std::invalid_argument  naming file and line: no grab with a release after it
std::vector<Stamped<bool>> parse_markers(std::string_view text, std::string_view where,
                                         double unit_s, std::optional<Time> near = {});

}  // namespace headpin::devices
