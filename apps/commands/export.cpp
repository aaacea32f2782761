#include <deque>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <sstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/damage.h"
#include "apps/gltf_trial.h"
#include "apps/mcap/export_mcap.h"
#include "apps/options.h"
#include "apps/run_again.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "base/output_file.h"
#include "base/output_folder.h"
#include "base/output_text.h"
#include "devices/base/version.h"
#include "scene/play/score.h"
#include "scene/record/file.h"
#include "scene/record/tables.h"
#include "scene/record/xdf.h"
#include "scene/scenario/scenario.h"
#include "scene/stage/read_scenario.h"
#include "scene/watch/recorded.h"

namespace headpin::apps {

namespace {

struct ExportOptions {
  std::string trial;
  std::optional<std::string> folder, gltf, mcap, xdf;
  double tolerance_mm = 0.0;
  bool eyes = false;
  bool force = false, json = false;
};

/// Writes all tables in one pass through the trial.
nlohmann::ordered_json write_tables(base::OutputFolder& folder, const scene::TrialFile& trial,
                                    const std::string& path) {
  std::deque<base::OutputText> files;
  std::deque<scene::TableWriter> tables;
  const std::vector<std::string> names = scene::table_names();
  const scene::TableRows::Walk walked = scene::walk_in_time(trial, path);
  for (const std::string& name : names) {
    tables.emplace_back(files.emplace_back(folder.file(name + ".csv")).out(), name,
                        trial.summary().header, walked);
  }
  const std::vector<scene::ThrowRow> throws = scene::score(trial.summary()).throws;
  for (scene::TableWriter& table : tables) {
    for (const scene::Event& event : trial.summary().events) table.add(event);
    for (const scene::ThrowRow& row : throws) table.add(row);
  }
  trial.walk([&](const scene::TrialFile::Item& item) {
    check_stop();
    for (scene::TableWriter& table : tables) {
      std::visit([&](const auto& one) { table.add(one); }, item);
    }
    return true;
  });
  nlohmann::ordered_json rows;
  for (std::size_t i = 0; i < names.size(); ++i) {
    check_stop();
    files[i].close();
    rows[names[i]] = tables[i].rows();
  }
  return rows;
}

/// What the scenario of a trial tells; nothing if it cannot be read.
scene::XdfSetting setting_of(const scene::TrialSummary& trial, const std::string& path) {
  try {
    const scene::Scenario scenario = scene::scenario_of_trial(trial.header.scenario, path);
    return {.X_WT = scenario.rig.X_WT, .end = scene::end_of(trial, scenario.rates.physics_hz)};
  } catch (const std::invalid_argument&) {
    return {};
  }
}

/// Data that are in no table: participant, condition, software.
nlohmann::ordered_json about(const scene::TrialSummary& trial, const std::string& path) {
  nlohmann::ordered_json all = {{"participant", trial.header.participant},
                                {"condition", trial.header.condition},
                                {"seed", trial.header.seed},
                                {"format_version", trial.header.format_version},
                                {"version", trial.header.software_version},
                                {"commit", trial.header.software_commit},
                                {"complete", trial.complete}};
  if (const auto end = setting_of(trial, path).end) all["end_s"] = nearest_seconds(*end);
  return all;
}

/// The complete scenario of the trial. If it cannot be read, its text is written unchanged.
std::string scenario_text(const std::string& text, const std::string& path) {
  try {
    return scene::whole_scenario(text, path);
  } catch (const std::invalid_argument&) {
    return text;
  }
}

/// Simulates the trial again and writes its motion as glTF.
void export_gltf(const ExportOptions& options) {
  watch_stop_signals();
  const scene::Recorded recorded = scene::load_trial(options.trial);
  say_what_is_missing("export", options.trial, recorded.file.summary());
  base::OutputFile file(
      *options.gltf,
      {.overwrite = options.force, .standard_output = true, .inputs = {options.trial}});
  scene::Session session = scene::make_session(recorded.scenario);
  GltfTrial gltf(session, scene::first_head_pose(recorded.file, recorded.scenario.rig),
                 recorded.file.summary(), 1e-3 * options.tolerance_mm);
  run_again(options.trial, recorded, session, {&gltf});
  const std::string bytes =
      gltf.file(session, {{"trial", options.trial}, {"version", devices::software_version()}});
  file.write(bytes.data(), bytes.size());
  file.commit();
  if (options.json) {
    print_json({{"gltf", *options.gltf}});
  } else if (*options.gltf != "-") {
    fmt::print("{}: {} ticks, {} keys\n", *options.gltf, session.tick, gltf.keys());
  }
}

/// Writes samples and events as streams.
void export_xdf(const ExportOptions& options) {
  watch_stop_signals();
  const scene::TrialFile trial(options.trial);
  trial.require_trial(devices::kLongestGap);
  const scene::TrialSummary& summary = trial.summary();
  say_what_is_missing("export", options.trial, summary);
  base::OutputFile file(
      *options.xdf,
      {.overwrite = options.force, .standard_output = true, .inputs = {options.trial}});
  const auto streams = scene::write_xdf_trial(trial, setting_of(summary, options.trial),
                                              [&](std::string_view bytes) {
                                                check_stop();
                                                file.write(bytes.data(), bytes.size());
                                              });
  file.commit();
  if (options.json) {
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    for (const auto& [name, samples] : streams)
      all.push_back({{"stream", name}, {"samples", samples}});
    print_json({{"xdf", *options.xdf},
                {"streams", all},
                {"left_out", {{"states", summary.state_count}, {"frames", summary.frame_count}}}});
    return;
  }
  if (*options.xdf == "-") return;
  fmt::print("{}\n", *options.xdf);
  for (const auto& [name, samples] : streams) fmt::print("  {:<14}{:>8} samples\n", name, samples);
  fmt::print("left out: {} states, {} frames\n", summary.state_count, summary.frame_count);
}

void export_trial(const ExportOptions& options) {
  if (options.folder.has_value() + options.gltf.has_value() + options.mcap.has_value() +
          options.xdf.has_value() !=
      1) {
    throw UsageError(
        "expected one of -o FOLDER (tables), --gltf FILE.glb (animation), --mcap FILE.mcap "
        "(messages) and --xdf FILE.xdf (streams)");
  }
  if (options.tolerance_mm > 0.0 && !options.gltf) throw UsageError("--tolerance needs --gltf");
  if (options.eyes && !options.mcap) throw UsageError("--eyes needs --mcap");
  if (options.gltf) return export_gltf(options);
  if (options.mcap) {
    watch_stop_signals();
    base::OutputFile file(
        *options.mcap,
        {.overwrite = options.force, .standard_output = true, .inputs = {options.trial}});
    return export_mcap(options.trial, std::move(file), options.eyes, options.json);
  }
  if (options.xdf) return export_xdf(options);
  const scene::TrialFile trial(options.trial);
  trial.require_trial(devices::kLongestGap);
  const scene::TrialSummary& summary = trial.summary();
  say_what_is_missing("export", options.trial, summary);
  if (summary.state_count == 0) {
    say("headpin export: {}: has no states, as before a replay; `headpin replay {} -o FILE` makes a "
        "trial with them\n",
        printable(options.trial), printable(options.trial));
  }
  watch_stop_signals();
  base::OutputFolder folder(*options.folder,
                            {.overwrite = options.force, .others = {options.trial}});
  const nlohmann::ordered_json rows = write_tables(folder, trial, options.trial);
  const auto write = [&](const std::string& name, const std::string& text) {
    base::OutputText file(folder.file(name));
    check_stop();
    file << text;
    file.close();
  };
  std::ostringstream columns;
  scene::write_dictionary(columns);
  write("columns.csv", columns.str());
  write("scenario.toml", scenario_text(summary.header.scenario, options.trial));
  write("trial.json",
        about(summary, options.trial)
                .dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) +
            "\n");
  folder.commit("trial.json");

  if (options.json) {
    print_json({{"output", *options.folder}, {"rows", rows}});
    return;
  }
  for (const auto& [table, count] : rows.items()) {
    fmt::print("{:<12}{:>8} rows\n", table + ".csv", count.get<std::int64_t>());
  }
  fmt::print(
      "columns.csv explains each column; trial.json and scenario.toml have the conditions of the "
      "trial\n");
}

}  // namespace

void add_export(CLI::App& app) {
  auto options = std::make_shared<ExportOptions>();
  CLI::App* command = app.add_subcommand(
      "export",
      "Write a trial as tables (CSV), an animated scene (glTF), messages (MCAP) or streams (XDF)");
  command->add_option("TRIAL", options->trial, "a trial (.lcmlog); - is standard input")
      ->required();
  add_output(*command, "-o,--output", options->folder, "folder for the tables", {});
  add_output(*command, "--gltf", options->gltf,
             "file for the animated scene (.glb); - is standard output", {".glb"});
  add_output(*command, "--mcap", options->mcap,
             "file of messages for Foxglove and Rerun (.mcap); - is standard output", {".mcap"});
  command->add_flag("--eyes", options->eyes,
                    "with --mcap: also the pictures of both eyes, at the frame rate of the trial");
  add_output(*command, "--xdf", options->xdf,
             "file for the streams of trackers, buttons and events (.xdf); - is standard output",
             {".xdf"});
  command
      ->add_option("--tolerance", options->tolerance_mm,
                   "leave out keys of the animation; 0.1 or 0.1mm is the largest error")
      ->transform(CLI::AsNumberWithUnit(std::map<std::string, double>{{"mm", 1.0}, {"m", 1000.0}}))
      ->check(number_from(0.0, 1000.0));
  add_force(*command, options->force);
  add_json(*command, options->json);
  command->footer(
      "Tables: trackers.csv, buttons.csv, events.csv, throws.csv (one row per throw), states.csv "
      "(one row per\nbody and tick), frames.csv (one row per eye and frame). columns.csv explains "
      "each column. The numbers\nread back to the same bits.\n\n"
      "With --gltf: room, bodies, hand, both eyes as cameras, and events, with a key at every "
      "tick. The "
      "trial is\nsimulated again. A camera of glTF is centred: where an eye's frustum is not, the "
      "camera shows more, and its\nextras have the edges.\n\n"
      "With --mcap: poses and shapes of bodies, head, eyes and hand, events and cameras as "
      "messages "
      "of Foxglove, at\nevery tick; and the messages of the trial's log as they are. The trial is "
      "simulated again.\n\n"
      "With --xdf: one stream per receiver, one for the 3D mouse, four for the events, as "
      "LabRecorder writes them.\nStates of bodies and frames are left out.\n\n"
      "Example:\n  headpin export game.lcmlog -o tables\n"
      "  headpin export game.lcmlog --gltf game.glb --tolerance 0.1mm\n"
      "  headpin export game.lcmlog --mcap game.mcap --eyes\n"
      "  headpin export game.lcmlog --xdf game.xdf");
  command->callback([options] { export_trial(*options); });
}

}  // namespace headpin::apps
