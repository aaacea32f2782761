#pragma once

#include <string_view>

#include "devices/trial/trial.h"

namespace headpin::apps {

/// Prints on standard error that a trial is incomplete: where it ends and how much of it is
/// unreadable. Prints nothing for a complete trial.
///
/// @param command  name of the command, which continues
void say_what_is_missing(std::string_view command, const std::string& path,
                         const devices::TrialSummary& trial);

}  // namespace headpin::apps
