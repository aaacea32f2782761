#pragma once

#include "apps/command.h"
#include "sweep/folder.h"

/// The commands of `headpin sweep`: thin ones over `sweep/`.
namespace headpin::apps {

void add_sweep_merge(CLI::App& group);
void add_sweep_plan(CLI::App& group);
void add_sweep_report(CLI::App& group);
void add_sweep_run(CLI::App& group);
void add_sweep_slurm(CLI::App& group);
void add_sweep_status(CLI::App& group);

/// Adds the folder of a sweep, which every command of the group takes.
CLI::Option* add_sweep_folder(CLI::App& command, std::string& folder);

/// Opens a sweep that was planned.
/// @throws std::runtime_error  as sweep::open_sweep, and naming what makes a sweep where there is none
sweep::Sweep open_planned(const std::string& folder);

/// How long a row takes on one core of this machine [s], from a few that are tried: their mean.
double seconds_per_row(const sweep::Sweep& sweep);

/// "2 h 05 min", rounded up.
std::string duration_in_words(double seconds);

struct SweepProgress {
  std::int64_t rows = 0, done = 0, failed = 0;
};

/// What is there.
/// @throws std::runtime_error  naming a piece that is damaged
SweepProgress progress_of(const sweep::Sweep& sweep);

}  // namespace headpin::apps
