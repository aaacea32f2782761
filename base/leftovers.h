#pragma once

#include <string>
#include <vector>

namespace headpin::base {

/// The name of an output while it is written, without the process: NAME of NAME.PROCESS-N.part.
std::string part_stem(const std::string& target);

/// Whether a process does not run, though nobody may have asked for its end yet.
bool is_gone(int process);

/// Whether a file of a folder is a regular one of this user that nobody has locked. A process on
/// another machine cannot be seen here, but it has its file locked. Where files cannot be locked, none is left.
bool is_left(int folder, const std::string& name);

/// Removes incomplete outputs of killed runs from an open folder: regular files STEM.PROCESS-N.part
/// of this user that are not locked and whose process is not running.
///
/// @return  the names of the removed files
std::vector<std::string> remove_leftovers(int folder, const std::string& stem);

}  // namespace headpin::base
