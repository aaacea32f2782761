#pragma once

#include <string>
#include <vector>

#include "scene/play/run.h"
#include "scene/watch/recorded.h"

namespace headpin::apps {

/// Simulates a trial again to its end, with a progress line. A signal stops it.
///
/// Where the trial has states, each tick is compared with them before the observers see it.
///
/// @param name       of the trial, for errors
/// @param session    of the trial, before its first tick
/// @param observers  see each tick
/// @throws scene::Differs  at the first tick that is not as recorded
void run_again(const std::string& name, const scene::Recorded& trial, scene::Session& session,
               std::vector<scene::Observer*> observers);

}  // namespace headpin::apps
