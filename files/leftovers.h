#pragma once

#include <string>
#include <vector>

namespace headpin::files {

/// What an output is called while it is written, up to the process: NAME of NAME.PROCESS-N.part.
std::string part_stem(const std::string& target);

/// Removes from an open folder what killed runs have left of an output: regular files of ours,
/// STEM.PROCESS-N.part, whose process is no more and that nobody has locked.
///
/// @return  their names
std::vector<std::string> remove_leftovers(int folder, const std::string& stem);

}  // namespace headpin::files
