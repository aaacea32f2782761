#pragma once

#include <vector>

#include "scene/play/run.h"
#include "scene/watch/recorded.h"

namespace headpin::apps {

/// Simulates a trial again to its end, with a progress line. A signal stops it.
///
/// @param session    of the trial, before its first tick
/// @param observers  see each tick
void run_again(const scene::Recorded& trial, scene::Session& session,
               std::vector<scene::Observer*> observers);

}  // namespace headpin::apps
