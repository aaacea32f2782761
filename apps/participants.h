#pragma once

#include <cstdint>
#include <string>

#include "base/output_file.h"
#include "scene/scenario/scenario.h"

namespace headpin::apps {

struct ParticipantSession {
  scene::Scenario scenario;  ///< as scenario_to_play() gives it
  std::string name, condition;
  std::uint64_t seed = 1;
  int throws = 10;
};

/// @param name  of a scenario or its file; empty: paper-experiment
scene::Scenario scenario_to_play(std::string name);

/// Lets the virtual participant of a seed play a session, writes its device samples and prints the
/// result, like `headpin synthesize --participant`.
///
/// @param json  prints JSON
void play_session(const ParticipantSession& plan, base::OutputFile output, bool json);

}  // namespace headpin::apps
