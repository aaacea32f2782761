#include "apps/import_session.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "base/input_file.h"
#include "base/output_file.h"
#include "devices/base/sources.h"
#include "devices/recordings/xdf_motion.h"
#include "scene/record/events.h"
#include "scene/record/log.h"
#include "scene/record/xdf.h"
#include "scene/stage/read_scenario.h"
#include "scene/watch/recorded.h"
#include "study/bids_read.h"
#include "study/trial_tables.h"

namespace headpin::apps {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMostOfTable = 1'000'000'000;

/// A complete trial, from any of the formats.
struct WholeTrial {
  scene::TrialHeader header;
  std::vector<devices::Sample> samples;
  std::vector<scene::Event> events = {};
  std::vector<std::string> notes = {};
  std::vector<std::string> files = {};  ///< that were read
  std::string scenario_from = {};       ///< the file that has its scenario
  Time end{};                           ///< of the session; 0 if nothing tells
  bool complete = true;                 ///< false: it was not when it was exported
};

// A trial of `export --xdf`.

bool is_xdf_trial(const std::string& path) {
  if (!fs::is_regular_file(path)) return false;
  devices::FileWindow file(path);
  return scene::is_xdf_trial(devices::bytes_of(file));
}

WholeTrial xdf_trial(const std::string& path) {
  devices::FileWindow file(path);
  scene::XdfTrial trial = scene::read_xdf_trial(devices::bytes_of(file), path);
  return {.header = std::move(trial.header),
          .samples = std::move(trial.samples),
          .events = std::move(trial.events),
          .notes = std::move(trial.notes),
          .files = {path},
          .scenario_from = path,
          .end = trial.end,
          .complete = trial.complete};
}

// A session of `experiment export --motion-bids`: one table per tracker, and the events.

/// "_run-01_" of a file's name; empty if there is none.
std::string run_of(const std::string& name) {
  const std::size_t at = name.find("_run-");
  return at == std::string::npos ? "" : name.substr(at, name.find('_', at + 1) - at) + "_";
}

constexpr std::string_view kTracksys = "_tracksys-";

/// "sub-01_task-bowling" of "sub-01_task-bowling_tracksys-head_run-01_motion.tsv".
std::string task_of(const std::string& name) {
  return name.substr(0, name.find(kTracksys));
}

/// "head" of the same; empty if a name has none.
std::string system_of(const std::string& name) {
  const std::size_t at = name.find(kTracksys);
  if (at == std::string::npos) return "";
  const std::size_t begin = at + kTracksys.size();
  return name.substr(begin, name.find('_', begin) - begin);
}

/// Whether `experiment export` writes what a tracker of this name measured.
bool is_our_tracker(std::string_view system) {
  if (system == "head" || system == "hand" || system == "lefthand") return true;
  constexpr std::string_view kStation = "station";
  if (!system.starts_with(kStation)) return false;
  const std::string_view number = system.substr(kStation.size());
  return !number.empty() &&
         std::ranges::all_of(number, [](char c) { return c >= '0' && c <= '9'; });
}

bool is_bids_trial(const std::string& path) {
  const fs::path file = path;
  const std::string name = file.filename().string(), system = system_of(name);
  if (!name.ends_with("_motion.tsv") || !(is_our_tracker(system) || system == "simulated")) {
    return false;
  }
  const std::string run = run_of(name);
  const fs::path sidecar = file.parent_path() / (task_of(name) + run + "events.json");
  if (run.empty() || !fs::is_regular_file(sidecar)) return false;
  const nlohmann::json json =
      nlohmann::json::parse(base::read_text(sidecar.string(), kMostOfTable), nullptr, false);
  return json.is_object() && json.contains("HeadpinTrial");
}

/// The tables of the same participant, task and run, without the simulated ones.
WholeTrial bids_trial(const std::string& path) {
  const std::string given = fs::path(path).filename().string();
  const std::string task = task_of(given), run = run_of(given);
  std::map<std::string, std::string> texts;
  std::vector<std::string> files, notes;
  for (const auto& entry : fs::directory_iterator(fs::absolute(path).parent_path())) {
    const std::string name = entry.path().filename().string(), system = system_of(name);
    const bool events = name == task + run + "events.tsv" || name == task + run + "events.json";
    const bool motion = !system.empty() && system != "simulated" && task_of(name) == task &&
                        run_of(name) == run && name.ends_with("_motion.tsv");
    if (motion && !is_our_tracker(system)) {
      notes.push_back(
          fmt::format("{}: headpin writes no tracking system '{}': left out", name, system));
      continue;
    }
    if (!events && !motion) continue;
    texts[name] = base::read_text(entry.path().string(), kMostOfTable);
    files.push_back(entry.path().string());
  }
  std::ranges::sort(notes);  // a folder has no order
  try {
    study::BidsTrial trial = study::session_of(texts);
    return {.header = std::move(trial.header),
            .samples = std::move(trial.samples),
            .notes = std::move(notes),
            .files = std::move(files),
            .scenario_from = path,
            .end = trial.end};
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error((fs::path(path).parent_path() / error.what()).string());
  }
}

// The tables of `export -o FOLDER`, as the folder or its trackers.csv.

fs::path trackers_in(const std::string& path) {
  return fs::is_directory(path) ? fs::path(path) / "trackers.csv" : fs::path(path);
}

bool is_tables_trial(const std::string& path) {
  const fs::path trackers = trackers_in(path);
  if (trackers.filename() != "trackers.csv" || !fs::is_regular_file(trackers)) return false;
  std::ifstream file(trackers);
  std::string first(4096, '\0');
  file.read(first.data(), static_cast<std::streamsize>(first.size()));
  first.resize(static_cast<std::size_t>(file.gcount()));
  return study::is_trackers_table(first.substr(0, first.find('\n')));
}

WholeTrial tables_trial(const std::string& path) {
  const fs::path folder = trackers_in(path).parent_path();
  std::vector<std::string> files;
  const auto text_of = [&](const char* name) -> std::optional<std::string> {
    const std::string file = (folder / name).string();
    if (!fs::exists(file)) return std::nullopt;
    files.push_back(file);
    return base::read_text(file, kMostOfTable);
  };
  study::TrialTexts texts;
  texts.trackers = *text_of("trackers.csv");
  texts.buttons = text_of("buttons.csv");
  texts.events = text_of("events.csv");
  texts.scenario = text_of("scenario.toml");
  texts.header = text_of("trial.json");
  study::TablesTrial trial = study::trial_of_tables(texts, folder.empty() ? "." : folder.string());
  return {.header = std::move(trial.header),
          .samples = std::move(trial.samples),
          .events = std::move(trial.events),
          .notes = std::move(trial.notes),
          .files = std::move(files),
          .scenario_from = (folder / "scenario.toml").string(),
          .end = trial.end,
          .complete = trial.complete};
}

/// A format: how it is known, and how it is read.
struct Format {
  bool (*is)(const std::string& path);
  WholeTrial (*read)(const std::string& path);
};
constexpr std::array kFormats = {Format{is_xdf_trial, xdf_trial}, Format{is_bids_trial, bids_trial},
                                 Format{is_tables_trial, tables_trial}};

void refuse_options_of_throws(const ImportOptions& options) {
  const ImportOptions none;
  const std::pair<const char*, bool> given[] = {
      {"--units", options.units != none.units},
      {"--time-unit", options.time_unit != none.time_unit},
      {"--rotations", options.rotations != none.rotations},
      {"--transmitter", options.transmitter != none.transmitter},
      {"--head", options.head != none.head},
      {"--events", options.events != none.events},
      {"--no-trigger", options.no_trigger},
      {"--hand", options.hand != none.hand},
      {"--throw", options.which.has_value()},
      {"--heading", options.heading != none.heading},
      {"--scenario", options.scenario != none.scenario}};
  for (const auto& [option, is_given] : given) {
    if (!is_given) continue;
    throw UsageError(
        fmt::format("{}: {} is a complete trial with a scenario of its own; this option is for "
                    "recordings of a throw",
                    option, options.file));
  }
}

/// Adds the end of a session that went on after its last sample: a replay would stop at that sample.
void tell_end(WholeTrial& trial, std::int64_t rate_hz) {
  if (trial.end == Time{}) return;
  std::erase_if(trial.events, [](const scene::Event& event) {
    return event.kind == scene::kind::session_end;  // of an earlier import
  });
  Time last{};
  for (const devices::Sample& sample : trial.samples) {
    last = std::max(last, devices::available(sample));
  }
  if (trial.end <= tick_time(scene::ticks_until(last, rate_hz), rate_hz)) return;
  scene::Event event;
  event.time = trial.end;
  event.kind = scene::kind::session_end;
  trial.events.push_back(std::move(event));
  if (const Time rest = trial.end - last; rest > devices::kLongestGap) {
    trial.notes.push_back(
        fmt::format("the session ends {:.3f} s after its last sample: --longest-gap {} replays it",
                    seconds(rest), std::ceil(seconds(rest))));
  }
}

/// Notes that a trial is only what was left of one: as a log of its own it is complete.
void tell_incomplete(WholeTrial& trial) {
  if (trial.complete) return;
  trial.notes.emplace_back("the trial was not complete when it was exported");
  scene::Event event;
  event.kind = scene::kind::import_note;
  event.detail = trial.notes.back();
  trial.events.insert(trial.events.begin(), std::move(event));
}

void write_trial(const ImportOptions& options, const WholeTrial& trial) {
  watch_stop_signals();
  std::vector<fs::path> inputs(trial.files.begin(), trial.files.end());
  inputs.emplace_back(options.file);
  scene::Recorder recorder(base::OutputFile(*options.output, {.overwrite = options.force,
                                                              .standard_output = true,
                                                              .inputs = std::move(inputs)}),
                           trial.header);
  try {
    scene::write(recorder, trial.samples, trial.events);
  } catch (const std::invalid_argument& error) {  // a number that no device has
    throw std::runtime_error(fmt::format("{}: {}", options.file, error.what()));
  }
  check_stop();
  recorder.close();
}

}  // namespace

bool import_session(const ImportOptions& options) {
  if (!options.axes.empty() || !options.columns.empty() || !options.names.empty()) return false;
  const auto* format =
      std::ranges::find_if(kFormats, [&](const Format& one) { return one.is(options.file); });
  if (format == kFormats.end()) return false;
  refuse_options_of_throws(options);
  if (options.explain && options.output) {
    throw UsageError(fmt::format("--output: {} is a complete trial, which has no columns to write",
                                 options.file));
  }
  WholeTrial trial = format->read(options.file);
  if (!options.participant.empty()) trial.header.participant = options.participant;
  if (!options.condition.empty()) trial.header.condition = options.condition;
  const scene::Scenario scenario =
      scene::scenario_of_trial(trial.header.scenario, trial.scenario_from);
  tell_end(trial, scenario.rates.physics_hz);
  tell_incomplete(trial);
  if (!options.explain) write_trial(options, trial);
  for (const std::string& note : trial.notes) {
    say("headpin import: {}: {}\n", printable(options.file), printable(note));
  }
  const std::string& written = options.explain ? options.file : *options.output;
  if (options.json) {
    print_json({{"output", written}, {"samples", trial.samples.size()}, {"notes", trial.notes}});
  } else if (written != "-") {
    fmt::print("{}\n  samples            {}, {} session\n", printable(written),
               trial.samples.size(), trial.complete ? "a whole" : "the rest of a");
  }
  return true;
}

}  // namespace headpin::apps
