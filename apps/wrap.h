#pragma once

#include <string>
#include <string_view>

/// Help that fits the terminal. CLI11 does not wrap lines.
namespace headpin::apps {

/// Breaks the lines of a help text between words.
///
/// A line goes on below its own description, or below its own first word. Lines of commands to copy
/// stay whole, and so does a word that is longer than a line.
/// @param width  most characters in a line; 0: the text stays as it is
std::string wrapped(std::string_view text, std::size_t width);

/// Characters in a line of the terminal that standard output goes to; 0 where it goes elsewhere, or
/// where the terminal is too narrow for two columns.
std::size_t terminal_width();

/// A value of a scenario in TOML on one line, cut after 40 characters; - for nothing.
std::string in_a_line(const std::string& toml);

}  // namespace headpin::apps
