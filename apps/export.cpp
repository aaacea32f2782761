#include <algorithm>
#include <fstream>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/options.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "devices/log.h"
#include "devices/tables.h"
#include "files/output_folder.h"

namespace headpin::apps {

namespace {

struct Options {
  std::string trial;
  std::optional<std::string> folder;
  bool force = false, json = false;
};

template <typename Write>
void write_file(const files::OutputFolder& folder, const std::string& name, Write write) {
  check_stop();
  std::ofstream file(folder.part() / name, std::ios::binary);
  write(file);
  file.close();
  if (!file) throw std::runtime_error((folder.part() / name).string() + ": cannot be written");
}

/// What stands in no table: who, under what, made by what.
nlohmann::ordered_json about(const devices::Trial& trial) {
  return {{"participant", trial.header.participant},
          {"condition", trial.header.condition},
          {"seed", trial.header.seed},
          {"format_version", trial.header.format_version},
          {"version", trial.header.software_version},
          {"commit", trial.header.software_commit},
          {"complete", trial.complete}};
}

void run(const Options& options) {
  const devices::Trial trial = devices::read_trial(options.trial);
  watch_stop_signals();
  files::OutputFolder folder(*options.folder,
                             {.overwrite = options.force, .others = {options.trial}});
  nlohmann::ordered_json rows;
  for (const std::string& table : devices::table_names()) {
    write_file(folder, table + ".csv",
               [&](std::ostream& out) { rows[table] = devices::write_table(out, table, trial); });
  }
  write_file(folder, "columns.csv", [](std::ostream& out) { devices::write_dictionary(out); });
  write_file(folder, "scenario.toml", [&](std::ostream& out) { out << trial.header.scenario; });
  write_file(folder, "trial.json", [&](std::ostream& out) { out << about(trial).dump(2) << '\n'; });
  folder.commit("trial.json");

  if (options.json) {
    print_json({{"output", *options.folder}, {"rows", rows}});
    return;
  }
  for (const auto& [table, count] : rows.items()) {
    fmt::print("{:<12}{:>8} rows\n", table + ".csv", count.get<std::int64_t>());
  }
  fmt::print(
      "columns.csv tells what each column is; trial.json and scenario.toml what it was made "
      "under\n");
}

}  // namespace

void add_export(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("export", "Write a trial as tables (CSV)");
  command->add_option("TRIAL", options->trial, "a trial (.lcmlog)")->required();
  add_output(*command, "-o,--output", options->folder, "folder to write the tables to")->required();
  add_force(*command, options->force);
  add_json(*command, options->json);
  command->footer(
      "One row an observation, one column a quantity; numbers read back to the same bits.\n"
      "trackers.csv, buttons.csv, events.csv, states.csv (a body and tick a row), frames.csv (an\n"
      "eye and frame a row); columns.csv says what each column is.\n\n"
      "Example:\n  headpin export game.lcmlog -o tables");
  command->callback([options] { run(*options); });
}

}  // namespace headpin::apps
