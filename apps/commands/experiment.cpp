#include "apps/experiment.h"

namespace headpin::apps {

CLI::Option* add_study(CLI::App& command, std::string& folder) {
  return command.add_option("STUDY", folder, "folder of the study")->required();
}

void add_experiment(CLI::App& app) {
  CLI::App* group = app.add_subcommand(
      "experiment", "Plan, play, score and analyse an experiment in the folder of a study");
  group->require_subcommand(1);
  add_experiment_plan(*group);
  add_experiment_run(*group);
  add_experiment_ask(*group);
  add_experiment_score(*group);
  add_experiment_analyse(*group);
  add_experiment_power(*group);
  add_experiment_export(*group);
  add_experiment_report(*group);
  add_experiment_status(*group);
  group->footer(
      "The folder of a study contains design.toml, scenario.toml, questionnaire.toml and plan.csv, "
      "and the\nsessions, answers and tables. Every command takes the folder as its first "
      "argument.\n\n"
      "Example:\n  headpin experiment plan -o study --design uno-slater-1997 --seed 7\n"
      "  headpin experiment status study");
}

}  // namespace headpin::apps
