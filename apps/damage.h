#pragma once

#include <string_view>

#include "scene/record/trial.h"

namespace headpin::apps {

/// Prints on standard error what what_is_missing() says of a trial: where an incomplete one ends, and how
/// much of it is not read. Prints nothing for a trial of which all is read.
///
/// @param command  name of the command, which continues
void say_what_is_missing(std::string_view command, const std::string& path,
                         const scene::TrialSummary& trial);

}  // namespace headpin::apps
