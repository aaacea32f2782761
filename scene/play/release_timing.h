#pragma once

#include <vector>

#include "devices/trial/file.h"
#include "scene/scenario/scenario.h"

namespace headpin::scene {

/// How well the moment was caught in which something was let go: the paper's participants found that
/// hard.
struct ReleaseTiming {
  Time release{};              ///< as the session noted it
  Time fastest{};              ///< when it would have left the hand fastest, within half a second
  double fastest_speed = 0.0;  ///< with which [m/s]; a walk's not in it
};

/// Of each release of a trial whose hand was tracked then; in their order.
///
/// @throws std::runtime_error  when the file is another by now
std::vector<ReleaseTiming> release_timings(const devices::TrialFile& trial,
                                           const Scenario& scenario);

}  // namespace headpin::scene
