#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "engine/math.h"

namespace headpin::devices {

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
};

/// The 22 columns of the catalogue, as published: delta_time_ms (since the start), then for head,
/// left_hand and right_hand NAME_pos_x, _pos_y, _pos_z and NAME_rot_w, _rot_x, _rot_y, _rot_z.
std::vector<std::string> catalogue_columns();

/// Reads the CSV of the XR motion catalogue (Schell et al., cschell/kinematic-maze).
///
/// One line with the names of the columns, in any order, others are ignored; then a sample a line.
/// Only the unit is converted.
///
/// @param text    the whole file
/// @param where   its name, for messages
/// @param unit_m  what one unit of the positions is [m]; 0.01 as published
/// @throws std::invalid_argument  naming line and column, for columns (all at once) or fields
///         that are missing, what is no finite number, quaternions whose length is not 1 to
///         1e-3, time that does not advance
MotionRecording parse_catalogue_csv(std::string_view text, std::string_view where, double unit_m);

/// The same the other way, to a ten-thousandth of a millimetre.
std::string to_catalogue_csv(const MotionRecording& recording, double unit_m);

}  // namespace headpin::devices
