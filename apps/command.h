#pragma once

#include <stdexcept>

#include <CLI/CLI.hpp>

/// The commands of `headpin`: one file each; main.cpp adds them to the program.
///
/// Each adds its subcommand, options and example to `app` and does its work in the callback.
/// Exceptions and exit codes: UsageError (2), base::Busy if another process uses a file (75),
/// Stopped by a signal (128 + its number), any other exception (1). main() prints the message on
/// standard error.
namespace headpin::apps {

struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

void add_apart(CLI::App& app);
void add_compare(CLI::App& app);
void add_conformance(CLI::App& app);
void add_doctor(CLI::App& app);
void add_draw(CLI::App& app);
void add_emulate(CLI::App& app);
void add_experiment(CLI::App& app);
void add_export(CLI::App& app);
void add_frames(CLI::App& app);
void add_help(CLI::App& app);
void add_import(CLI::App& app);
void add_info(CLI::App& app);
void add_live(CLI::App& app);
void add_manual(CLI::App& app);
void add_play(CLI::App& app);
void add_plot(CLI::App& app);
void add_replay(CLI::App& app);
void add_report(CLI::App& app);
void add_scenario(CLI::App& app);
void add_serve(CLI::App& app);
void add_stream(CLI::App& app);
void add_sweep(CLI::App& app);
void add_synthesize(CLI::App& app);
void add_whatif(CLI::App& app);

}  // namespace headpin::apps
