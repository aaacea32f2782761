#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "devices/recordings/motion_files.h"

/// Tracker files of the Unity Experiment Framework.
namespace headpin::devices {

/// One object's poses of a UXF folder, a `trackers/OBJECT_movement_T001.csv`.
///
/// Unity's frame is left-handed, y up, +z ahead, its Euler angles are degrees about z, x and y, in
/// this order; metres. The z axis is turned round. A last line that does not end may be cut inside
/// a number: it is left out.
///
/// @param turns  false: rotations are not read, and need not be there
PoseTrack parse_uxf(std::string_view text, std::string_view where, std::vector<std::string>& notes,
                    bool turns = true);

}  // namespace headpin::devices
