#pragma once

#include <functional>

#include "base/math.h"

/// The true motion of an emulated Fastrak's receivers, as a function of time.
namespace headpin::devices {

/// The true state of a receiver.
struct FastrakTruth {
  Pose X_TS;             ///< in the transmitter's frame: +X forward, +Y right, +Z down [m]
  bool pressed = false;  ///< its switch, if it is a stylus
  char error = ' ';      ///< an error letter to report, for example a recorded one
};

/// The true state of a station (1 to 4) at a time of the emulator's clock.
using FastrakMotion = std::function<FastrakTruth(int station, Time time)>;

/// All receivers at rest in front of the transmitter, side by side, 0.4 m away.
FastrakTruth still_motion(int station, Time time);

/// The receivers move and turn along a circle with a radius of 0.2 m in 4 s.
FastrakTruth circling_motion(int station, Time time);

/// The place of the transmitter, and settings of the unit, with which clients that set nothing
/// receive the poses of a recording unchanged.
struct FastrakPlace {
  Vec3 p_TP = Vec3::Zero();  ///< of the new place P in the recorded one's frame, turned as that [m]
  double envelope = 2.0;  ///< as FastrakEmulatorOptions has it; the factory's unless too small [m]
  double farthest = 0.0;  ///< that a receiver gets from the new place [m]
};

/// The motion as seen from the new place.
FastrakMotion seen_from(const FastrakPlace& place, FastrakMotion motion);

}  // namespace headpin::devices
