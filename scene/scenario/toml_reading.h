#pragma once

#include <string>
#include <string_view>

#include <toml++/toml.h>

/// Reads TOML, and says what is wrong with it and where.
namespace headpin::scene {

/// @param where     name of the text, for messages
/// @param one_line  as on the command line: messages name no line
/// @throws std::invalid_argument  "FILE:LINE: not TOML: column COLUMN: 'WORD THERE': REASON"
toml::table parse_toml(std::string_view text, std::string_view where, bool one_line = false);

/// A value for messages, short: 'text', 0.35, [0.35, -0.25], {low = 0.0, high = 0.1}, a list of 12
/// values.
std::string value_in_words(const toml::node& node);

}  // namespace headpin::scene
