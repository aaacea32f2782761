#pragma once

#include <string>
#include <string_view>

/// Text from outside, made safe for the parser.
namespace headpin::scene {

/// The text of a scenario's file.
/// @throws std::runtime_error  naming the file and the reason: cannot be read, is a folder, is
///                             longer than any scenario
std::string read_scenario_file(const std::string& path);

/// Refuses text whose tables or arrays lie deeper in each other than any scenario's: the parser
/// goes down by recursion, and some depth would end the process.
///
/// @param where  name of the file, for messages
/// @throws std::invalid_argument  naming file and line
void require_shallow(std::string_view toml, std::string_view where);

/// Enough of a text to know it again.
std::string brief(std::string_view text);

}  // namespace headpin::scene
