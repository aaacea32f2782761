#pragma once

#include <functional>

#include "engine/math.h"

/// What an emulated Fastrak measures: where its receivers really are, as a function of time.
namespace headpin::devices {

/// Where a receiver really is, and what else is true of it.
struct FastrakTruth {
  Pose X_TS;             ///< in the transmitter's frame: +X forward, +Y right, +Z down [m]
  bool pressed = false;  ///< its switch, if it is the stylus
  char error = ' ';      ///< a letter it shall report by itself, e.g. as it was recorded
};

/// The truth about a station (1 to 4) at a time of the emulator's clock.
using FastrakMotion = std::function<FastrakTruth(int station, Time time)>;

/// All receivers at rest in front of the transmitter, side by side, 0.4 m away.
FastrakTruth still_motion(int station, Time time);

/// The same going round: a circle of 0.2 m radius in 4 s, turning with it.
FastrakTruth circling_motion(int station, Time time);

/// Where a transmitter has to stand, and what its unit must have been told, for clients that set
/// nothing themselves to be given a recording's poses as they were.
struct FastrakPlace {
  Vec3 p_TP = Vec3::Zero();  ///< of the new place P in the recorded one's frame, turned as that [m]
  double envelope = 2.0;  ///< as FastrakEmulatorOptions has it; the factory's unless too small [m]
  double farthest = 0.0;  ///< that a receiver gets from the new place [m]
};

/// The motion as seen from the new place.
FastrakMotion seen_from(const FastrakPlace& place, FastrakMotion motion);

}  // namespace headpin::devices
