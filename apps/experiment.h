#pragma once

#include "apps/command.h"

/// The commands of `headpin experiment`, one file each: thin ones over `study/`.
namespace headpin::apps {

void add_experiment_analyse(CLI::App& group);
void add_experiment_ask(CLI::App& group);
void add_experiment_export(CLI::App& group);
void add_experiment_plan(CLI::App& group);
void add_experiment_power(CLI::App& group);
void add_experiment_report(CLI::App& group);
void add_experiment_run(CLI::App& group);
void add_experiment_score(CLI::App& group);
void add_experiment_status(CLI::App& group);

/// Adds the folder of a study, which every command of the group takes.
CLI::Option* add_study(CLI::App& command, std::string& folder);

}  // namespace headpin::apps
