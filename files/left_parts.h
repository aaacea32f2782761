#pragma once

#include <string>

namespace headpin::files {

/// Removes what OutputFiles left in a folder when their process was killed: NAME.PROCESS-N.part,
/// where no process of that number is running.
void remove_left_parts(const std::string& folder);

}  // namespace headpin::files
