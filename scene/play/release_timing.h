#pragma once

#include <vector>

#include "scene/record/file.h"
#include "scene/scenario/scenario.h"

namespace headpin::scene {

/// The timing of releases, which the paper's participants found hard.
struct ReleaseTiming {
  Time release{};  ///< time of the release event
  Time fastest{};  ///< time of the fastest possible release within half a second
  double fastest_speed =
      0.0;  ///< speed of the ball at that release, with the walk and `release.speed` [m/s]
};

/// The timing of each release of a ball in a trial during which the hand was tracked, in order.
///
/// @throws std::runtime_error  when the file was changed in the meantime
std::vector<ReleaseTiming> release_timings(const TrialFile& trial, const Scenario& scenario);

}  // namespace headpin::scene
