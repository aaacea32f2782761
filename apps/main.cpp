#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <sstream>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/failed_with.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "apps/wrap.h"
#include "apps/wrong_use.h"
#include "base/lock.h"
#include "base/shell_word.h"
#include "devices/base/version.h"
#include "scene/record/log.h"
#include "scene/scenario/files.h"

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

/// Whether the command that is run has the option.
bool has_option(const CLI::App& app, const std::string& option) {
  const std::vector<CLI::App*> commands = app.get_subcommands();  // those that were typed
  if (!commands.empty()) return has_option(*commands.front(), option);
  return app.get_option_no_throw(option) != nullptr;
}

/// What went wrong, and the option with which it would not.
std::string with_option(const CLI::App& app, const std::exception& error) {
  const std::string what = error.what();
  if (dynamic_cast<const base::Exists*>(&error)) {
    return what + (has_option(app, "--force") ? "; --force replaces it" : "");
  }
  if (dynamic_cast<const scene::LongGap*>(&error)) return what + "; --longest-gap accepts more";
  return what;
}

/// Once installed, the examples of all commands name the bundled trial where it lies.
void place_examples(CLI::App& app) {
  namespace fs = std::filesystem;
  const fs::path beside = scene::program_folder() / "share/headpin";  // so it is in a build folder
  for (const fs::path& data : scene::data_folders()) {
    std::error_code none;
    if (data == beside || !fs::exists(data / "trials/demo.lcmlog", none)) continue;
    const std::string trials = base::typed_word((data / "trials/").string());
    for (CLI::App* command : app.get_subcommands({})) {
      command->footer(
          CLI::detail::find_and_replace(command->get_footer(), "assets/trials/", trials));
    }
    return;
  }
}

/// Prints an error with the name of its command; with --json also as an object, with the results in it.
int fail(const CLI::App& app, bool json, const std::string& why, int code,
         const nlohmann::ordered_json& results = nlohmann::ordered_json::object()) {
  const std::string name = name_of(app), message = brief(printable(why));
  say("{}: {}\n", name, message);
  if (!json) return code;
  nlohmann::ordered_json all = {{"command", name}, {"error", message}, {"exit_code", code}};
  all.update(results);
  print_json(all);
  return code;
}

int run(CLI::App& app, int argc, char** argv) {
  const bool json = std::any_of(
      argv, argv + argc, [](const char* word) { return std::string_view(word) == "--json"; });
  const auto failed = [&](const std::exception& error, int code) {
    if (stop_signal() != 0) {  // other failures are its consequences
      return fail(app, json, Stopped(stop_signal()).what(), 128 + stop_signal());
    }
    const auto* with = dynamic_cast<const FailedWith*>(&error);
    return fail(app, json, with_option(app, error), code,
                with ? with->results : nlohmann::ordered_json::object());
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
    return fail(app, json, fmt::format("{}; see `{} --help`", wrong_use(error, app), name_of(app)),
                2);
  } catch (const Stopped& error) {
    return fail(app, json, error.what(), 128 + error.signal);
  } catch (const UsageError& error) {
    return failed(error, 2);
  } catch (const base::Busy& error) {
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
  apps::add_play(app);
  apps::add_serve(app);
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
  apps::place_examples(app);
  const int code = apps::run(app, argc, argv);
  return apps::close_standard_output(apps::name_of(app), code);
}
