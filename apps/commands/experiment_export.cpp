#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/experiment.h"
#include "apps/options.h"
#include "apps/stop.h"
#include "apps/streams.h"
#include "apps/study_people.h"
#include "apps/study_play.h"
#include "base/input_file.h"
#include "base/left_parts.h"
#include "base/output_file.h"
#include "devices/base/version.h"
#include "scene/play/game_hash.h"
#include "scene/record/events.h"
#include "scene/record/outside.h"
#include "scene/scenario/files.h"
#include "scene/watch/recorded.h"
#include "scene/watch/verifier.h"
#include "study/bids.h"

namespace headpin::apps {

namespace fs = std::filesystem;

namespace {

struct ExportStudyOptions {
  std::string study;
  std::optional<std::string> output;
  bool deidentify = false, json = false;
  int jobs = 1;
};

/// The files of a dataset. The folder is complete when the description is written.
class Dataset {
 public:
  explicit Dataset(fs::path root) : root_(std::move(root)) {}

  void write(const std::string& name, const std::string& text) {
    check_stop();
    const fs::path path = root_ / name;
    fs::create_directories(path.parent_path());
    base::remove_left_parts(path.parent_path().string());
    // Overwrites the files of a killed export.
    base::write_text({path.string(), {.overwrite = true, .durable = false}}, text);
    written_.insert(path);
  }

  /// Throws if a folder has files that were not written now: those of another person in the same place. A
  /// file with a dot is that of a file browser.
  void require_own(const fs::path& folder) const {
    if (!fs::exists(root_ / folder)) return;
    for (const auto& entry : fs::recursive_directory_iterator(root_ / folder)) {
      const bool hidden = entry.path().filename().string().starts_with('.');
      if (entry.is_directory() || hidden || written_.contains(entry.path())) continue;
      throw std::runtime_error(fmt::format(
          "{}: expected only files that this export writes, found that of another export; expected a "
          "new or empty folder",
          entry.path().string()));
    }
  }

  const fs::path& root() const { return root_; }

 private:
  fs::path root_;
  std::set<fs::path> written_;
};

/// Throws if the folder, of the dataset or of its trials, holds a subject that this export does not
/// write.
void require_subjects(const fs::path& folder, const std::vector<std::string>& subjects) {
  if (!fs::exists(folder)) return;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with("sub-")) continue;
    if (std::ranges::find(subjects, name.substr(4)) != subjects.end()) continue;
    throw std::runtime_error(
        fmt::format("{}: expected only subjects that this export writes, found that of another "
                    "export; expected a new or empty folder",
                    entry.path().string()));
  }
}

/// Throws unless the dataset is new, or an unfinished one of the same study with the same choice of
/// names or numbers. Its README, which tells the choice, is the first file; its description is the
/// last one.
void require_free(const fs::path& root, const std::string& readme,
                  const std::vector<std::string>& subjects) {
  std::error_code none;
  if (fs::exists(root / "dataset_description.json")) {
    throw std::runtime_error(root.string() + ": a dataset exists there; expected a new folder");
  }
  if (fs::is_empty(root)) return;
  if (!fs::exists(root / "README", none)) {
    throw std::runtime_error(root.string() + ": expected a new or empty folder");
  }
  if (read_study_file(root / "README") != readme) {
    throw std::runtime_error(
        fmt::format("{}: expected a new or empty folder, or an unfinished export of the same study "
                    "that was begun with the same choice of --deidentify; its README is that of "
                    "another export",
                    root.string()));
  }
  require_subjects(root, subjects);
  require_subjects(root / "sourcedata", subjects);
}

/// Properties of the body that the motion data show even without a name.
struct Traits {
  double eyes_m = 0.0;   ///< height of the display while standing: the median of all
  double reach_m = 0.0;  ///< from display to hand, at most
};

Traits traits_of(const scene::Recorded& recorded, const std::vector<devices::Sample>& samples) {
  std::vector<double> heights;
  Traits traits;
  std::optional<Vec3> head;
  const scene::Rig& rig = recorded.scenario.rig;
  for (const devices::Sample& sample : samples) {
    const auto* tracker = std::get_if<devices::TrackerSample>(&sample);
    if (!tracker || !tracker->good()) continue;
    if (tracker->station == rig.head_station) {
      head = (rig.X_WT * tracker->X_TS * rig.X_SD).p;
      heights.push_back(head->z());
    } else if (tracker->station == rig.hand_station && head) {
      traits.reach_m =
          std::max(traits.reach_m, ((rig.X_WT * tracker->X_TS * rig.X_SH).p - *head).norm());
    }
  }
  if (heights.empty()) return traits;
  const auto middle = heights.begin() + std::ssize(heights) / 2;
  std::ranges::nth_element(heights, middle);
  traits.eyes_m = *middle;
  return traits;
}

/// The samples of a trial, as its log has them. Stations below 1 have no table: how many samples of them are
/// left out is told.
std::vector<devices::Sample> samples_of(const scene::Recorded& recorded, const std::string& path) {
  std::vector<devices::Sample> samples;
  std::int64_t left_out = 0;
  recorded.file.walk([&](scene::TrialFile::Item& item) {
    const auto* sample = std::get_if<devices::Sample>(&item);
    if (!sample) return true;
    const auto* tracker = std::get_if<devices::TrackerSample>(sample);
    if (tracker && tracker->station < 1) {
      ++left_out;
    } else {
      samples.push_back(*sample);
    }
    return true;
  });
  if (left_out > 0) {
    say("headpin experiment export: {}: {} samples of stations below 1 are left out\n",
        printable(path), left_out);
  }
  return samples;
}

/// Simulates a session again.
/// @throws scene::Differs  where that is not what was recorded
void simulate_again(const scene::Recorded& recorded, const std::string& path, bool same_game,
                    scene::Observer& seen_by) {
  scene::Session again = scene::make_session(recorded.scenario);
  scene::TrialPlayer source(recorded.file, {.states = true});
  std::vector<scene::Observer*> observers;
  std::optional<scene::Verifier> verifier;
  if (source.has_states()) observers.push_back(&verifier.emplace(path, source, again));
  observers.push_back(&seen_by);
  scene::NoPace pace;
  const std::int64_t ticks = recorded.ticks();
  scene::run(again, source, pace, observers, [&](const scene::Session& s) {
    check_stop();
    return s.tick >= ticks;
  });
  const auto said = scene::said_game_hash(recorded.file.summary());
  if (!said || same_game) return;
  throw scene::Differs(
      fmt::format("{}: the replayed game differs from the recorded one, whose game hash is {}",
                  path, said->hash));
}

/// Writes the simulated bodies. They are left out, with a warning, where they contradict the trial.
/// @param same_game  the game hash of a replay is the recorded one
void write_simulated(Dataset& dataset, const scene::Recorded& recorded, const std::string& path,
                     bool same_game, const study::BidsSession& session) {
  std::string table;
  study::SimulatedSystem simulated([&](const std::string& row) { table += row; });
  try {
    simulate_again(recorded, path, same_game, simulated);
  } catch (const scene::Differs& error) {
    return say("headpin experiment export: {}; its tracksys-simulated is left out\n",
               printable(error.what()));
  }
  dataset.write(study::SimulatedSystem::table_name(session), table);
  for (const auto& [name, text] : simulated.files(session)) dataset.write(name, text);
}

/// Names a mesh file by what it is of, unless it is a bundled one: paths have names of people.
void rename_mesh(scene::MeshFile& mesh, const std::string& of) {
  if (mesh.file.empty()) return;
  const fs::path name = fs::path(mesh.file).filename();
  std::error_code none;
  const bool bundled = std::ranges::any_of(scene::data_folders(), [&](const fs::path& data) {
    return fs::exists(data / "meshes" / name, none);
  });
  mesh.file = bundled ? name.string() : of + "-mesh" + name.extension().string();
}

/// The text of a scenario without the comments of its trial, without its own name unless it is that of
/// a bundled one, and without the places of its meshes.
std::string scenario_without_names(scene::Scenario scenario) {
  const std::vector<std::string> bundled = scene::scenario_names();
  if (std::ranges::find(bundled, scenario.name) == bundled.end()) scenario.name = "scenario";
  rename_mesh(scenario.room.mesh, "room");
  rename_mesh(scenario.skittle.mesh, "skittle");
  rename_mesh(scenario.ball.mesh, "ball");
  rename_mesh(scenario.hand.mesh, "hand");
  int number = 0;
  for (scene::SkittlePart& part : scenario.skittle.parts) {
    rename_mesh(part.mesh, fmt::format("skittle-part-{}", ++number));
  }
  return scene::to_toml(scenario);
}

/// Empties what events from outside the simulation say: names of files, devices and programs, and of an
/// imported recording its first time stamp, which may be a date.
void remove_names(std::vector<scene::Event>& events) {
  for (scene::Event& event : events) {
    if (!scene::is_outside(event.tick, event.kind)) continue;
    if (event.kind == scene::kind::imported) event.value = 0.0;
    if (!event.detail.get_if<scene::KeptPace>()) event.detail = {};
  }
}

/// The index of the run that counts, as BIDS takes it: 01 of "run-01" and of "run-01 copy".
std::string run_index(const Study& study, const study::Person& person) {
  const std::string number = person.played.run.substr(std::string_view("run-").size());
  const std::string digits = number.substr(0, number.find_first_not_of("0123456789"));
  if (!digits.empty()) return digits;
  throw std::runtime_error(fmt::format(
      "{}: expected a number behind run-, as Motion-BIDS takes it; rename it to run-01.lcmlog or the like",
      (study.at.sessions(person.planned.id) / (person.played.run + ".lcmlog")).string()));
}

/// Writes one participant's session; simulates it again for the bodies.
Traits write_session(Dataset& dataset, const Study& study, const study::Person& person,
                     const std::string& subject, bool deidentify) {
  const fs::path path = study.at.sessions(person.planned.id) / (person.played.run + ".lcmlog");
  const scene::Recorded recorded = scene::load_trial(path.string());
  const scene::TrialSummary& trial = recorded.file.summary();
  scene::TrialHeader header = trial.header;
  header.participant = is_virtual_name(header.participant) ? virtual_name(subject) : subject;
  study::BidsSession session{subject,
                             run_index(study, person),
                             &header,
                             samples_of(recorded, path.string()),
                             trial.events,
                             recorded.scenario.rig,
                             scene::end_of(trial, recorded.recorded_hz)};
  if (deidentify) {
    header.condition = condition_of(study, person.planned);
    header.scenario = scenario_without_names(recorded.scenario);
    remove_names(session.events);
  }
  for (const auto& [name, text] : study::session_files(session)) dataset.write(name, text);
  write_simulated(dataset, recorded, path.string(), person.played.replays, session);
  return traits_of(recorded, session.samples);
}

void copy_trial(Dataset& dataset, const Study& study, const study::Person& person,
                const std::string& subject) {
  constexpr std::size_t kMost = 4'000'000'000;
  const std::string name = person.played.run + ".lcmlog";
  dataset.write(fmt::format("sourcedata/sub-{}/{}", subject, name),
                base::read_text((study.at.sessions(person.planned.id) / name).string(), kMost));
}

void export_study(const ExportStudyOptions& options) {
  watch_stop_signals();
  const Study study = open_study(options.study);
  const fs::path root = *options.output;
  std::vector<study::Person> people = people_of(study, options.jobs);
  std::erase_if(people, [](const study::Person& one) { return one.played.run.empty(); });
  if (people.empty()) {
    throw std::runtime_error(fmt::format("{}: expected sessions to export, found none that counts",
                                         study.at.root.string()));
  }
  std::vector<std::string> subjects;
  for (const study::Person& person : people) {
    run_index(study, person);  // is refused before anything is written
    subjects.push_back(options.deidentify ? fmt::format("{:03}", subjects.size() + 1)
                                          : person.planned.id);
  }
  fs::create_directories(root);
  const StudyLock lock(root, "exporting to this folder");
  base::remove_left_parts(root.string());
  const std::string readme = study::bids_readme(study.design, people, options.deidentify);
  require_free(root, readme, subjects);
  Dataset dataset(root);
  dataset.write("README", readme);
  nlohmann::ordered_json gives_away = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < people.size(); ++i) {
    study::Person& person = people[i];
    const std::string& subject = subjects[i];
    const std::string run = run_index(study, person);
    const Traits traits = write_session(dataset, study, person, subject, options.deidentify);
    if (!options.deidentify) copy_trial(dataset, study, person, subject);
    dataset.require_own("sub-" + subject);
    dataset.require_own("sourcedata/sub-" + subject);
    gives_away.push_back({{"participant", subject},
                          {"eyes_m", std::round(100.0 * traits.eyes_m) / 100.0},
                          {"reach_m", std::round(100.0 * traits.reach_m) / 100.0}});
    person.planned.id = subject;
    if (!options.deidentify) continue;
    if (!person.replaced_by.empty()) person.replaced_by = "another";
    person.played.sha256 = study::kNoAnswer;
    person.played.run = "run-" + run;  // a file's name may have a person's behind the number
  }
  const auto all =
      study::dataset_files(study.design, study.questions, people, devices::software_version());
  for (const auto& [name, text] : all) dataset.write(name, text);  // the description comes last
  if (options.json) {
    return print_json({{"output", root.string()}, {"sessions", gives_away}});
  }
  fmt::print("{}: {} sessions\n", root.string(), people.size());
  if (!options.deidentify) return;
  fmt::print("names, dates and trials are left out; the motion data still reveal:\n");
  for (const auto& one : gives_away) {
    fmt::print("  sub-{}: eyes at {:.2f} m, reach {:.2f} m, the hand that throws\n",
               one["participant"].get<std::string>(), one["eyes_m"].get<double>(),
               one["reach_m"].get<double>());
  }
}

}  // namespace

void add_experiment_export(CLI::App& group) {
  CLI::App* command = group.add_subcommand("export", "Write the whole study as Motion-BIDS");
  const auto options = std::make_shared<ExportStudyOptions>();
  add_study(*command, options->study);
  add_output(*command, "--motion-bids", options->output, "folder for the dataset", {})->required();
  command->add_flag(
      "--deidentify", options->deidentify,
      "write numbers instead of names, leave out the trials (they contain the date) and "
      "what events say of files and devices, and list what the motion data still reveal");
  command->add_option("--jobs", options->jobs, "number of sessions to process in parallel")
      ->check(whole_number_from(1, 256))
      ->capture_default_str();
  add_json(*command, options->json);
  command->footer(
      "The dataset has one subject for each participant whose session counts: both receivers, the "
      "simulated\nbodies in each frame, events with the buttons, participants.tsv, answers in "
      "phenotype/, and trials in\nsourcedata/. `headpin import` reads a session back to the same "
      "samples.\n\n"
      "Example:\n  headpin experiment export study --motion-bids dataset\n"
      "  headpin import dataset/sub-p001/motion/"
      "sub-p001_task-bowling_tracksys-head_run-01_motion.tsv -o again.lcmlog");
  command->callback([options] { export_study(*options); });
}

}  // namespace headpin::apps
