#include "apps/wrong_use.h"

#include <optional>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/command.h"
#include "scene/scenario/nearest.h"

namespace headpin::apps {

namespace {

/// The visible commands of a command.
std::vector<std::string> commands_of(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (!command->get_group().empty()) names.push_back(command->get_name());
  }
  return names;
}

/// The visible options of a command.
std::vector<std::string> options_of(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_group().empty()) continue;
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

/// The command that was given: of `experiment plan`, plan.
const CLI::App& innermost(const CLI::App& app) {
  const CLI::App* command = &app;
  while (!command->get_subcommands().empty()) command = command->get_subcommands().front();
  return *command;
}

/// "; the nearest is replay", or nothing.
std::string nearest_in_words(std::string_view word, const std::vector<std::string>& names) {
  const std::optional<std::string> meant = scene::nearest(word, names);
  return meant ? fmt::format("; the nearest is {}", *meant) : "";
}

/// What is wrong where a command is missing: the parser does not name the word in its place.
std::string without_command(const CLI::App& app) {
  const std::vector<std::string> names = commands_of(innermost(app));
  const std::string all = fmt::format("one of {}", fmt::join(names, ", "));
  const std::vector<std::string> rest = app.remaining(true);
  if (rest.empty()) return "expected a command: " + all;
  const char* const kind = rest.front().starts_with('-') ? "option" : "command";
  const std::string meant = nearest_in_words(rest.front(), names);
  return fmt::format("unknown {} '{}'{}", kind, rest.front(),
                     meant.empty() ? "; expected a command: " + all : meant);
}

/// What is wrong with an option among the words that are left over; empty if there is none.
std::string unknown_option(const CLI::App& app) {
  for (const std::string& word : app.remaining(true)) {
    const std::string bare = word.substr(0, word.find('='));
    if (!bare.starts_with('-') || bare == "-") continue;
    return fmt::format("unknown option {}{}", bare,
                       nearest_in_words(bare, options_of(innermost(app))));
  }
  return "";
}

/// What is wrong with words that are left over: the unknown option, else the first of them.
std::string left_over(const CLI::App& app) {
  if (std::string unknown = unknown_option(app); !unknown.empty()) return unknown;
  const std::vector<std::string> rest = app.remaining(true);
  return fmt::format("'{}' is one argument too many", rest.empty() ? "" : rest.front());
}

/// What an option takes: "a number".
std::string kind_of_value(const CLI::App& app, const std::string& name) {
  const CLI::Option* const option = innermost(app).get_option_no_throw(name);
  if (option == nullptr) return "another value";
  const std::string type = option->get_type_name();
  if (type.empty()) return "no value";
  if (type.starts_with("FLOAT")) return "a number";
  if (type.starts_with("UINT")) return "a whole number from 0 on";
  return type.starts_with("INT") ? "a whole number" : "another value";
}

}  // namespace

const CLI::App* find_command(const CLI::App& app, std::string_view name) {
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (command->get_name() == name) return command;
  }
  return nullptr;
}

void check_command(const CLI::App& app, std::string_view word) {
  if (find_command(app, word)) return;
  const std::vector<std::string> names = commands_of(app);
  if (names.empty()) {
    throw UsageError(
        fmt::format("unknown command '{}'; {} has no commands of its own", word, app.get_name()));
  }
  const std::string meant = nearest_in_words(word, names);
  throw UsageError(
      fmt::format("unknown command '{}'{}", word,
                  meant.empty() ? fmt::format("; one of {}", fmt::join(names, ", ")) : meant));
}

std::string wrong_use(const CLI::ParseError& error, const CLI::App& app) {
  const std::string said = error.what();
  const auto ends = [&](std::string_view words) { return said.ends_with(words); };
  if (said.find("subcommand is required") != std::string::npos) return without_command(app);
  if (dynamic_cast<const CLI::ExtrasError*>(&error)) return left_over(app);
  if (dynamic_cast<const CLI::RequiredError*>(&error)) {  // often it is there, misspelt
    if (std::string unknown = unknown_option(app); !unknown.empty()) return unknown;
  }
  const std::string name = said.substr(0, said.find(": "));
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&error)) {
    if (ends(" missing")) return name + ": expected a value, found none";
    if (said.find(": At Most 1 ") != std::string::npos) {
      return fmt::format("{}: expected once, found {} times", name,
                         said.substr(said.rfind(' ') + 1));
    }
  }
  const std::string_view not_read = "Could not convert: ";
  if (said.starts_with(not_read)) {
    const std::size_t sign = said.find(" = ");
    const std::string option = said.substr(not_read.size(), sign - not_read.size());
    return fmt::format("{}: expected {}, found {}", option, kind_of_value(app, option),
                       said.substr(sign + 3));
  }
  return said;
}

}  // namespace headpin::apps
