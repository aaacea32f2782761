#include "scene/live/played.h"

#include <stdexcept>

#include "scene/record/file.h"
#include "scene/stage/read_scenario.h"

namespace headpin::scene {

std::vector<PlayedTrial> played_by(const LiveSources& sources) {
  std::vector<PlayedTrial> all;
  for (const devices::OpenSource& source : sources.each()) {
    if (source.recording.empty()) continue;
    const TrialFile file(source.recording);
    if (file.summary().has_header) all.push_back({source.recording, file.summary()});
  }
  return all;
}

TrialHeader header_from(std::span<const PlayedTrial> played) {
  TrialHeader header;
  if (played.empty()) return header;
  header.participant = played[0].summary.header.participant;
  header.condition = played[0].summary.header.condition;
  header.seed = played[0].summary.header.seed;
  return header;
}

Scenario scenario_of(const PlayedTrial& trial) {
  return scenario_of_trial(trial.summary.header.scenario, trial.path);
}

bool is_of_another(const PlayedTrial& trial, const Scenario& scenario) {
  try {
    Scenario its = scenario_of(trial);
    its.look = scenario.look;
    return to_toml(its) != to_toml(scenario);
  } catch (const std::invalid_argument&) {
    return true;  // not complete
  }
}

}  // namespace headpin::scene
