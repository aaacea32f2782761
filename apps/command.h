#pragma once

#include <stdexcept>

#include <CLI/CLI.hpp>

/// The commands of `headpin`: one file each, joined to the program in main.cpp.
///
/// Each adds its subcommand, options and example to `app` and does its work in the callback.
/// A wrong use throws UsageError (exit code 2), what another process is using files::Busy (75), a
/// signal Stopped (128 + its number), any other failure another exception (1). main() says each on
/// standard error.
namespace headpin::apps {

struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

void add_compare(CLI::App& app);
void add_conformance(CLI::App& app);
void add_doctor(CLI::App& app);
void add_draw(CLI::App& app);
void add_emulate(CLI::App& app);
void add_experiment(CLI::App& app);
void add_export(CLI::App& app);
void add_frames(CLI::App& app);
void add_import(CLI::App& app);
void add_info(CLI::App& app);
void add_live(CLI::App& app);
void add_manual(CLI::App& app);
void add_plot(CLI::App& app);
void add_replay(CLI::App& app);
void add_report(CLI::App& app);
void add_scenario(CLI::App& app);
void add_stream(CLI::App& app);
void add_synthesize(CLI::App& app);

}  // namespace headpin::apps
