#pragma once

#include <string_view>

#include "devices/trial/trial.h"

namespace headpin::apps {

/// Says on standard error that a trial is not complete, how far it goes and how much of it cannot be
/// read. Nothing for one that is.
///
/// @param command  that works on it all the same
void say_what_is_missing(std::string_view command, const std::string& path,
                         const devices::TrialSummary& trial);

}  // namespace headpin::apps
