#pragma once

#include <string>
#include <string_view>

/// Checks of text before it is parsed.
namespace headpin::scene {

/// The text of a scenario's file.
/// @throws std::runtime_error  naming the file and the reason: cannot be read, is a folder, is
///                             longer than any scenario
std::string read_scenario_file(const std::string& path);

/// Refuses text with too deeply nested tables or arrays: the parser is recursive, and deep nesting
/// would crash the process.
///
/// @param where  name of the file, for messages
/// @throws std::invalid_argument  naming file and line
void require_shallow(std::string_view toml, std::string_view where);

/// A text on one line, for messages: control characters as TOML writes them, such as \n.
std::string on_one_line(std::string_view text);

/// The beginning of a text, on one line, for messages.
/// @param most  bytes; a longer text ends in "..."
std::string brief(std::string_view text, std::size_t most = 60);

}  // namespace headpin::scene
