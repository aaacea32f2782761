#pragma once

#include <string>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json_fwd.hpp>

/// Standard output and error, checked: what could not be said is a failure.
namespace headpin::apps {

/// Makes sure that 0, 1 and 2 are taken, so that no file of ours gets their numbers, and that a
/// reader that goes away is an error and not the end of the process.
void open_standard_streams();

/// Writes out what is left for standard output.
///
/// A full disk or a closed descriptor is said on standard error; a reader that went away is not, as
/// in `headpin info | head`.
/// @param code  exit code so far
/// @return      the exit code: `code`, or 1, or 128 + SIGPIPE where the reader went away
int close_standard_output(const std::string& command, int code);

/// Says something on standard error. A terminal that is gone, or a reader that went away, is no
/// reason to end what it is said of.
void say(const std::string& text);
template <typename... Args>
void say(fmt::format_string<Args...> format, Args&&... args) {
  say(fmt::format(format, std::forward<Args>(args)...));
}

/// One object on one line; bytes that are not UTF-8 are replaced.
void print_json(const nlohmann::ordered_json& object);

/// Text from a file or the user, fit for one line of a terminal: control characters are replaced.
std::string printable(std::string text);

}  // namespace headpin::apps
