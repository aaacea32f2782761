#include "apps/experiment.h"

namespace headpin::apps {

CLI::Option* add_study(CLI::App& command, std::string& folder) {
  return command.add_option("STUDY", folder, "folder of the study")->required();
}

void add_experiment(CLI::App& app) {
  CLI::App* group = app.add_subcommand(
      "experiment", "Plan, play, ask and score an experiment: a study is a folder");
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
      "A study has design.toml, scenario.toml, questionnaire.toml and plan.csv, and whatever was "
      "played,\nanswered and counted beside them. Every command takes the folder.\n\n"
      "Example:\n  headpin experiment plan -o study --design uno-slater-1997 --seed 7\n"
      "  headpin experiment status study");
}

}  // namespace headpin::apps
