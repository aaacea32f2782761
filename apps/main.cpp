#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <sstream>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/nearest.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "apps/topics.h"
#include "apps/wrap.h"
#include "devices/base/version.h"
#include "files/lock.h"

namespace headpin::apps {
namespace {

/// "headpin replay": the beginning of messages.
std::string name_of(const CLI::App& app) {
  std::string name = app.get_name();
  for (const CLI::App* command : app.get_subcommands()) name += " " + name_of(*command);
  return name;
}

/// Shortens a text to about twenty lines of a terminal; keys and paths in it may be very long.
std::string brief(std::string text) {
  constexpr std::size_t kMost = 1600;
  if (text.size() <= kMost) return text;
  text.resize(kMost);
  return text + " ...";
}

/// Prints an error with the name of its command; with --json also as an object.
int fail(const CLI::App& app, bool json, const std::string& why, int code) {
  const std::string name = name_of(app), message = brief(printable(why));
  say("{}: {}\n", name, message);
  if (json) print_json({{"command", name}, {"error", message}, {"exit_code", code}});
  return code;
}

/// The visible commands of a command.
std::vector<std::string> commands_of(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (!command->get_group().empty()) names.push_back(command->get_name());
  }
  return names;
}

const CLI::App* find_command(const CLI::App& app, std::string_view name) {
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (command->get_name() == name) return command;
  }
  return nullptr;
}

/// Refuses a first word that is not a command, and names it. The parser would only say that a
/// command is missing.
void check_command(const CLI::App& app, std::string_view word) {
  if (find_command(app, word)) return;
  const std::vector<std::string> names = commands_of(app);
  const std::optional<std::string> meant = nearest(word, names);
  const std::string all =
      names.empty() ? "there are none here" : fmt::format("one of {}", fmt::join(names, ", "));
  throw UsageError(fmt::format("unknown command '{}'; {}", word,
                               meant ? fmt::format("the nearest is {}", *meant) : all));
}

/// The command that was given: of `experiment plan`, plan.
const CLI::App* innermost(const CLI::App& app) {
  const CLI::App* command = &app;
  while (!command->get_subcommands().empty()) command = command->get_subcommands().front();
  return command;
}

/// What is wrong where a command is missing: the parser does not name the word in its place.
std::string without_command(const CLI::App& app) {
  const std::string all = fmt::format("one of {}", fmt::join(commands_of(*innermost(app)), ", "));
  const std::vector<std::string> rest = app.remaining(true);
  if (rest.empty()) return "expected a command: " + all;
  const char* const kind = rest.front().starts_with('-') ? "option" : "command";
  return fmt::format("unknown {} '{}'; expected a command: {}", kind, rest.front(), all);
}

/// A hint for an unknown word: "; the nearest to --frction is --friction".
std::string what_is_meant(const CLI::App& app) {
  const CLI::App* command = innermost(app);
  std::vector<std::string> options;
  for (const CLI::Option* option : command->get_options()) {
    for (const std::string& name : option->get_lnames()) options.push_back("--" + name);
  }
  for (const std::string& word : app.remaining(true)) {
    const std::string bare = word.substr(0, word.find('='));
    const auto meant = nearest(bare, bare.starts_with('-') ? options : commands_of(*command));
    if (meant) return fmt::format("; the nearest to {} is {}", bare, *meant);
  }
  return "";
}

/// All topics with the titles of their pages, and the folder of the pages.
void print_topics() {
  fmt::print("Topics; `headpin help TOPIC` prints the file of its page:\n");
  for (const Topic& topic : topics()) fmt::print("  {:<20}{}\n", topic.name, topic.title);
  fmt::print("All pages are in {}\n", docs_folder().string());
}

/// Prints the information about a topic. @return whether there is such a topic
bool print_topic(const std::string& name) {
  if (name == "topics") {
    print_topics();
    return true;
  }
  const std::optional<Topic> topic = find_topic(name);
  if (topic) fmt::print("{}\n{}\n", topic->title, (docs_folder() / topic->page).string());
  return topic.has_value();
}

/// Adds `help`: it prints the help of a command, like --help, or the page of a topic.
void add_help(CLI::App& app) {
  const auto words = std::make_shared<std::vector<std::string>>();
  CLI::App* command =
      app.add_subcommand("help", "Show how to use a command, or which page explains a topic");
  command->add_option("COMMAND", *words,
                      "a command such as replay, or a topic; `topics` lists the topics; default: "
                      "list all commands");
  command->footer("Examples:\n  headpin help replay\n  headpin help topics");
  command->callback([words, &app] {
    if (words->size() == 1 && print_topic(words->front())) return;
    const CLI::App* at = &app;
    std::string before;
    for (const std::string& word : *words) {
      check_command(*at, word);
      before += (before.empty() ? "" : " ") + at->get_name();
      at = find_command(*at, word);
    }
    const std::string name = before.empty() ? at->get_name() : before + " " + at->get_name();
    const std::string help = at->get_formatter()->make_help(at, name, CLI::AppFormatMode::Normal);
    fmt::print("{}", wrapped(help, terminal_width()));
  });
}

int run(CLI::App& app, int argc, char** argv) {
  const bool json = std::any_of(
      argv, argv + argc, [](const char* word) { return std::string_view(word) == "--json"; });
  const auto failed = [&](const std::exception& error, int code) {
    if (stop_signal() != 0) {  // other failures are its consequences
      return fail(app, json, Stopped(stop_signal()).what(), 128 + stop_signal());
    }
    return fail(app, json, error.what(), code);
  };
  try {
    if (argc < 2) throw UsageError("expected a command; `headpin --help` lists them");
    if (argv[1][0] != '-') check_command(app, argv[1]);
    app.parse(argc, argv);
    return EXIT_SUCCESS;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == EXIT_SUCCESS) {  // --help and --version
      std::ostringstream help;
      app.exit(error, help);
      std::fputs(wrapped(help.str(), terminal_width()).c_str(), stdout);  // fails when it is closed
      return EXIT_SUCCESS;
    }
    const bool no_command =
        std::string_view(error.what()).find("subcommand is required") != std::string_view::npos;
    const std::string why = (no_command ? without_command(app) : error.what()) + what_is_meant(app);
    return fail(app, json, fmt::format("{}; see `{} --help`", why, name_of(app)), 2);
  } catch (const Stopped& error) {
    return fail(app, json, error.what(), 128 + error.signal);
  } catch (const UsageError& error) {
    return failed(error, 2);
  } catch (const files::Busy& error) {
    return failed(error, 75);
  } catch (const std::filesystem::filesystem_error& error) {
    return failed(std::runtime_error(error.path1().string() + ": " + error.code().message()), 1);
  } catch (const std::system_error& error) {
    if (std::ferror(stdout)) return EXIT_SUCCESS;  // from fmt; the later close reports it
    if (error.code() == std::errc::resource_unavailable_try_again) {
      return failed(std::runtime_error("cannot start a thread: " + error.code().message()), 1);
    }
    return failed(error, 1);
  } catch (const std::exception& error) {
    return failed(error, 1);
  }
}

}  // namespace
}  // namespace headpin::apps

int main(int argc, char** argv) {
  using namespace headpin;
  apps::open_standard_streams();
  CLI::App app{"headpin: a headless immersive bowling simulator with a tracked-device layer",
               "headpin"};
  app.require_subcommand(1);
  app.set_version_flag("--version", std::string("headpin ") + devices::software_version());
  apps::add_scenario(app);
  apps::add_synthesize(app);
  apps::add_import(app);
  apps::add_info(app);
  apps::add_replay(app);
  apps::add_frames(app);
  apps::add_compare(app);
  apps::add_export(app);
  apps::add_plot(app);
  apps::add_report(app);
  apps::add_live(app);
  apps::add_experiment(app);
  apps::add_sweep(app);
  apps::add_whatif(app);
  apps::add_apart(app);
  apps::add_doctor(app);
  apps::add_stream(app);
  apps::add_emulate(app);
  apps::add_conformance(app);
  apps::add_help(app);
  apps::add_manual(app);
  apps::add_draw(app);
  const int code = apps::run(app, argc, argv);
  return apps::close_standard_output(apps::name_of(app), code);
}
