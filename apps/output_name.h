#pragma once

#include <string>
#include <vector>

namespace headpin::apps {

/// "a", "a or b", "a, b or c"
std::string either_of(const std::vector<std::string>& words);

/// The error in the name of an output; empty if it is correct. A name with the ending of another known kind of
/// file is wrong; one without an ending, or with an unknown one, is not.
/// @param endings  of the kinds that may be written; none: a folder
std::string wrong_output(const std::string& name, const std::vector<std::string>& endings);

}  // namespace headpin::apps
