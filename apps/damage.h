#pragma once

#include <string_view>

#include "scene/record/trial.h"

namespace headpin::apps {

/// Prints on standard error that a trial is incomplete: where it ends and how much of it is
/// unreadable. Prints nothing for a complete trial.
///
/// @param command  name of the command, which continues
void say_what_is_missing(std::string_view command, const std::string& path,
                         const scene::TrialSummary& trial);

}  // namespace headpin::apps
