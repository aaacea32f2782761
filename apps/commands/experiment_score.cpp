#include <cerrno>
#include <fstream>
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "apps/experiment.h"
#include "apps/options.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "apps/study_people.h"
#include "apps/study_tables.h"
#include "study/csv.h"
#include "study/paper_tables.h"

namespace headpin::apps {

namespace {

struct ScoreOptions {
  std::string study;
  Mixing mixing;
  int jobs = 1;
  bool json = false;
};

std::string dictionary(const std::vector<std::pair<std::string, std::vector<study::Column>>>& all) {
  std::string text = study::csv_line({"table", "column", "kind", "unit", "meaning"});
  for (const auto& [table, columns] : all) {
    for (const study::Column& column : columns) {
      text += study::csv_line({table, column.name, column.kind, column.unit, column.meaning});
    }
  }
  return text;
}

void write_tables(const Study& study, const std::vector<study::Person>& people,
                  const std::vector<study::Table>& tables) {
  StudyTables folder(study.at.root / "tables");
  std::vector<std::pair<std::string, std::vector<study::Column>>> columns = {
      {"participants", study::people_columns(study.design, study.questions)}};
  folder.write("participants.csv", study::people_csv(study.design, study.questions, people));
  for (const study::Table& table : tables) {
    folder.write(table.name + ".csv", study::to_csv(table));
    columns.emplace_back(table.name, table.columns);
  }
  folder.write("columns.csv", dictionary(columns));
  folder.commit("participants.csv");
}

void score(const ScoreOptions& options) {
  watch_stop_signals();
  const Study study = open_study(options.study);
  say_not_in_plan(study);
  const std::vector<study::Person> people = people_of(study, options.jobs);
  const Counted counted = counted_of(study, people, options.mixing);
  const std::vector<study::Table> tables =
      study::paper_tables(study.design, study.questions, counted.people, counted.of);
  write_tables(study, people, tables);
  nlohmann::ordered_json not_counted = nlohmann::ordered_json::array();
  std::vector<std::string> other_order, other_games, not_played, otherwise;
  for (const study::Person& person : people) {
    const std::string why = study::why_not(study.design, study.questions, person);
    if (!why.empty()) not_counted.push_back({{"participant", person.planned.id}, {"why_not", why}});
    if (why.empty() && person.played.run.empty()) not_played.push_back(person.planned.id);
    if (study::is_in_other_order(person)) other_order.push_back(person.planned.id);
    if (study::has_other_games(person)) other_games.push_back(person.planned.id);
    if (why.empty() && !person.played.replays) otherwise.push_back(person.planned.id);
  }
  if (options.json) {
    return print_json({{"output", (study.at.root / "tables").string()},
                       {"participants", people.size()},
                       {"counted", counted.people.size()},
                       {"of_virtual", counted.of},
                       {"not_counted", not_counted},
                       {"not_played", not_played},
                       {"other_order", other_order},
                       {"other_games", other_games},
                       {"simulated_otherwise", otherwise}});
  }
  fmt::print("{} of {} participants count{}\n", counted.people.size(), people.size(),
             counted.of == "yes"     ? ", all virtual"
             : counted.of == "mixed" ? ", people and virtual ones"
                                     : "");
  for (const auto& one : not_counted) {
    fmt::print("  not {}: {}\n", one["participant"].get<std::string>(),
               one["why_not"].get<std::string>());
  }
  if (!not_played.empty() && not_played.size() < counted.people.size()) {
    fmt::print("  without a session, by drawn answers alone: {}\n", fmt::join(not_played, ", "));
  }
  if (!other_order.empty()) {
    fmt::print("  played in another order than planned: {} (see planned_first and played_first)\n",
               fmt::join(other_order, ", "));
  }
  if (!other_games.empty()) {
    fmt::print(
        "  a version played more than once, or not to its end: {} (see base_games and changed_games)\n",
        fmt::join(other_games, ", "));
  }
  if (!otherwise.empty()) {
    fmt::print("  simulated otherwise than recorded: {} (see replays)\n",
               fmt::join(otherwise, ", "));
  }
  for (const study::Table& table : tables) {
    fmt::print("\n{}: {}", table.name, study::in_words(table));
    print_notes(study, table.name);
  }
}

}  // namespace

void add_experiment_score(CLI::App& group) {
  CLI::App* command =
      group.add_subcommand("score", "Count answers, measure sessions and write the study's tables");
  const auto options = std::make_shared<ScoreOptions>();
  add_study(*command, options->study);
  add_mixing(*command, options->mixing);
  command->add_option("--jobs", options->jobs, "number of sessions to simulate in parallel")
      ->check(whole_number_from(1, 256))
      ->capture_default_str();
  add_json(*command, options->json);
  command->footer(
      "The command simulates every session again from its trial. It writes tables/participants.csv "
      "(one row per\nparticipant; for those who do not count, with the reason), Tables 2 to 4 of "
      "the paper, and columns.csv,\nwhich explains each column.\n\n"
      "Example:\n  headpin experiment score study --jobs 2");
  command->callback([options] { score(*options); });
}

}  // namespace headpin::apps
