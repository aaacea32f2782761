#pragma once

#include <string>

namespace headpin::base {

/// Removes the files NAME.PROCESS-N.part that killed processes left in a folder: those whose
/// process is not running, here or, by their locks, on another machine.
void remove_left_parts(const std::string& folder);

}  // namespace headpin::base
