#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/math.h"
#include "base/random.h"
#include "devices/fastrak/geometry.h"

namespace headpin::devices {

/// From a time until another time, or for ever.
struct FaultWindow {
  Time from{};
  Time to = Time::max();

  bool holds(Time t) const { return from <= t && t < to; }
};

struct StationFault {
  int station = 1;
  FaultWindow when;
};

/// Faults of an emulated Fastrak, repeatable by a seed.
struct FastrakFaults {
  double noise = 1.0;    ///< factor of the unit's own noise; 0: exact poses
  double dropout = 0.0;  ///< probability that a whole record is lost
  double garbage = 0.0;  ///< probability of 1 to 8 random bytes before a record
  double damage = 0.0;   ///< probability that one bit of a record is flipped
  double metal = 0.0;    ///< distortion by metal nearby, at 1 m [m]
  int slow_baud = 0;     ///< the line is no faster than this; 0: as set
  int deaf = 0;          ///< status requests that get no answer, from power-on or set_faults() on
  std::vector<StationFault> stuck;      ///< a receiver whose pose stands still
  std::vector<StationFault> unplugged;  ///< a receiver pulled out
  std::vector<FaultWindow> silence;     ///< the unit neither receives nor sends
};

/// Reads a list like `noise=3,dropout=0.01,stuck=2@5-8,silence=4@10,deaf=2`.
///
///     noise=F  dropout=P  garbage=P  damage=P  metal=METRES  slow=BAUD  deaf=N
///     stuck=STATION@FROM[-TO]   unplug=STATION@FROM[-TO]   silence=SECONDS@FROM
///
/// Times are seconds since the emulator started; P is a chance from 0 to 1. Spaces around an entry do
/// not count.
/// @throws std::invalid_argument  naming the entry and what was expected; for one value given twice
FastrakFaults parse_faults(const std::string& spec);

/// @throws std::invalid_argument  for a fault of a receiver that a unit with so many does not have
void check_stations(const FastrakFaults& faults, int receivers);

/// The entries of `parse_faults`, one a line, for help texts.
std::string faults_help();

/// Distorts a pose like metal nearby: a smooth error that grows with the square of the distance and
/// depends on the direction. At 1 m the position is off by `metal` [m], the orientation by as much
/// in radians.
Pose distort(const Pose& X_TS, double metal);

}  // namespace headpin::devices
