#pragma once

#include <span>
#include <string>
#include <vector>

#include "scene/live/sources.h"
#include "scene/record/trial.h"
#include "scene/scenario/scenario.h"

/// Trials that a live session plays in addition to devices or instead of them.
namespace headpin::scene {

struct PlayedTrial {
  std::string path;
  TrialSummary summary;
};

/// The sources that are logs of trials.
std::vector<PlayedTrial> played_by(const LiveSources& sources);

/// Participant, condition and seed of the first one; none without any.
TrialHeader header_from(std::span<const PlayedTrial> played);

/// @throws std::invalid_argument  when its scenario is not complete
Scenario scenario_of(const PlayedTrial& trial);

/// Whether a trial was recorded in another scenario; differences of the rendering quality do not
/// count.
bool is_of_another(const PlayedTrial& trial, const Scenario& scenario);

}  // namespace headpin::scene
