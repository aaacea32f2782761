#pragma once

#include <string>
#include <vector>

#include "devices/recordings/motion_recording.h"

namespace headpin::devices {

/// The 22 columns of the catalogue, as published: delta_time_ms (since the start), then for head,
/// left_hand and right_hand NAME_pos_x, _pos_y, _pos_z and NAME_rot_w, _rot_x, _rot_y, _rot_z.
std::vector<std::string> catalogue_columns();

/// The CSV of the XR motion catalogue (Schell et al., cschell/kinematic-maze), to a ten-thousandth of a
/// millimetre. It is read as any table is.
///
/// @param unit_m  what one unit of the positions is [m]; 0.01 as published
std::string to_catalogue_csv(const MotionRecording& recording, double unit_m);

}  // namespace headpin::devices
