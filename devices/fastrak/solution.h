#pragma once

#include "base/math.h"
#include "devices/fastrak/codec.h"
#include "devices/fastrak/commands.h"

namespace headpin::devices {

/// The newest measurement of a station.
struct FastrakSolution {
  Time measured{};
  Pose X_TS;  ///< after hemisphere and filters
  char error = ' ';
  bool pressed = false;
  bool valid = false;
};

/// The pose that a station reports: that of the tip, in the alignment frame, by the mounting frame;
/// without boresight.
Pose pose_reported(const FastrakStationSetup& setup, const Pose& X_TS);

/// What a station reports of a measurement; without the number of the station.
///
/// @param p_last          the position that it reported before [m]
/// @param metre_per_unit  of the format of its records
FastrakRecord record_of(const FastrakStationSetup& setup, const FastrakSolution& solution,
                        const Vec3& p_last, double metre_per_unit);

}  // namespace headpin::devices
