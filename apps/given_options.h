#pragma once

#include <set>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace headpin::apps {

/// The options that a user gave to a command, as words for another process of the same command.
///
/// Each is one word, --NAME=VALUE, in the order in which the command declares them; a flag has the
/// value true. Options with their default value are left out.
///
/// @param without  options that the other process does not get
std::vector<std::string> given_options(const CLI::App& command,
                                       const std::set<const CLI::Option*>& without);

}  // namespace headpin::apps
