#pragma once

#include <string>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json_fwd.hpp>

/// Checked standard output and error: a failed write is a failure of the command.
namespace headpin::apps {

/// Opens the descriptors 0, 1 and 2 if they are closed, so that no file gets these numbers, and
/// ignores SIGPIPE, so that a closed pipe is an error.
void open_standard_streams();

/// Flushes standard output.
///
/// Reports a full disk or a closed descriptor on standard error, but not a closed pipe, as in
/// `headpin info | head`.
/// @param code  exit code so far
/// @return      the exit code: `code`, or 1, or 128 + SIGPIPE where the reader went away
int close_standard_output(const std::string& command, int code);

/// Prints on standard error. Errors are ignored, so that a closed terminal or pipe does not end the
/// command.
void say(const std::string& text);
template <typename... Args>
void say(fmt::format_string<Args...> format, Args&&... args) {
  say(fmt::format(format, std::forward<Args>(args)...));
}

/// Prints one object on one line; bytes that are not UTF-8 are replaced.
void print_json(const nlohmann::ordered_json& object);

/// Text from a file or the user, fit for one line of a terminal: control characters are replaced.
std::string printable(std::string text);

}  // namespace headpin::apps
