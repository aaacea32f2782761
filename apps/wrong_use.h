#pragma once

#include <string>
#include <string_view>

#include <CLI/CLI.hpp>

/// Messages about a command line that cannot be understood.
namespace headpin::apps {

/// The command of that name below `app`; null for an unknown name.
const CLI::App* find_command(const CLI::App& app, std::string_view name);

/// Refuses a first word that is not a command, and names it. The parser would only say that a
/// command is missing.
/// @throws UsageError
void check_command(const CLI::App& app, std::string_view word);

/// What is wrong, what was expected and what was found: the error of the parser in our words.
std::string wrong_use(const CLI::ParseError& error, const CLI::App& app);

}  // namespace headpin::apps
