#include <cstdlib>
#include <iostream>

#include "apps/command.h"
#include "devices/version.h"

namespace {

/// Says what went wrong on one line, under the name of the command it went wrong in.
int fail(const CLI::App& app, const std::exception& error, int code) {
  std::string name = app.get_name();
  for (const CLI::App* command : app.get_subcommands()) name += " " + command->get_name();
  std::cerr << name << ": " << error.what() << "\n";
  return code;
}

/// Refuses a first word that is no command, by name: the parser would only ask for one.
void check_command(const CLI::App& app, int argc, const char* const* argv) {
  if (argc < 2 || argv[1][0] == '-') return;
  std::string names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (command->get_name() == argv[1]) return;
    names += (names.empty() ? "" : ", ") + command->get_name();
  }
  throw headpin::apps::UsageError("unknown command '" + std::string(argv[1]) + "'; one of " +
                                  names);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"headpin: a headless immersive bowling simulator with a tracked-device layer",
               "headpin"};
  app.require_subcommand(1);
  app.set_version_flag("--version", std::string("headpin ") + headpin::devices::software_version());
  headpin::apps::add_synthesize(app);
  headpin::apps::add_import(app);
  headpin::apps::add_info(app);
  headpin::apps::add_replay(app);
  headpin::apps::add_frames(app);
  headpin::apps::add_compare(app);
  headpin::apps::add_live(app);
  headpin::apps::add_doctor(app);
  headpin::apps::add_stream(app);
  headpin::apps::add_emulate(app);
  try {
    check_command(app, argc, argv);
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == EXIT_SUCCESS ? EXIT_SUCCESS : 2;
  } catch (const headpin::apps::UsageError& error) {
    return fail(app, error, 2);
  } catch (const headpin::apps::TryAgain& error) {
    return fail(app, error, 75);
  } catch (const std::exception& error) {
    return fail(app, error, 1);
  }
}
