#pragma once

#include "devices/fastrak/asking.h"

namespace headpin::devices {

/// Checks that the unit is a Fastrak, and that its poses agree in all forms: inches and centimetres,
/// ASCII and binary, angles, quaternion, direction cosines and extended precision, up to the motion
/// of a receiver between two readings. Where receivers move so far between them that nothing can be
/// told, the demand says so.
///
/// @return  number of receivers, from station 1; 0 if the unit does not report it
int examine_readings(FastrakLine& line, FastrakDemands& demands);

}  // namespace headpin::devices
