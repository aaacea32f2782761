#include <cstdlib>
#include <iostream>

#include "apps/command.h"

namespace {

/// Says what went wrong on one line, under the name of the command it went wrong in.
int fail(const CLI::App& app, const std::exception& error, int code) {
  std::string name = app.get_name();
  for (const CLI::App* command : app.get_subcommands()) name += " " + command->get_name();
  std::cerr << name << ": " << error.what() << "\n";
  return code;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"headpin: a headless immersive bowling simulator with a tracked-device layer",
               "headpin"};
  app.require_subcommand(1);
  headpin::apps::add_replay(app);
  headpin::apps::add_frames(app);
  headpin::apps::add_compare(app);
  headpin::apps::add_import(app);
  headpin::apps::add_info(app);
  headpin::apps::add_synthesize(app);
  try {
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
