#include "apps/study_folder.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>
#include <set>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/stat.h>
#include <unistd.h>

#include "apps/command.h"
#include "apps/streams.h"
#include "base/input_file.h"
#include "base/lock.h"
#include "scene/play/score.h"
#include "scene/record/events.h"
#include "scene/record/file.h"
#include "scene/scenario/files.h"
#include "scene/stage/read_scenario.h"
#include "study/csv.h"

namespace headpin::apps {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kVirtual = "virtual ";

/// Names of the bundled files of that kind.
std::set<std::string> bundled_names(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".toml") names.insert(entry.path().stem().string());
  }
  return names;
}

/// What is in a folder; nothing if it does not exist.
/// @throws fs::filesystem_error  for a folder that cannot be read
std::vector<fs::path> entries_of(const fs::path& folder) {
  std::error_code error;
  fs::directory_iterator entries(folder, error);
  if (error == std::errc::no_such_file_or_directory) return {};
  if (error) throw fs::filesystem_error("cannot be read", folder, error);
  std::vector<fs::path> paths;
  for (const auto& entry : entries) paths.push_back(entry.path());
  return paths;
}

/// Whose session it is, and what its versions were, if that is not what the plan has. The plan may have
/// been edited since, or the file is another participant's.
std::string not_planned(const Study& study, const study::PlannedParticipant& who,
                        const scene::TrialHeader& header, const fs::path& path) try {
  const std::string& name = header.participant;
  const std::string id = is_virtual_name(name) ? name.substr(kVirtual.size()) : name;
  if (id != who.id &&
      std::ranges::find(study.plan, id, &study::PlannedParticipant::id) != study.plan.end()) {
    return "it is the session of " + id;
  }
  const scene::Scenario played = scene::scenario_of_trial(header.scenario, path.string());
  scene::Scenario wanted = played;
  for (const study::PlannedGame& game : study::games_of(study.design, who.allotted)) {
    for (std::size_t i = 0; i < study.design.factors.size(); ++i) {
      scene::set(wanted, study::assignment(study.design.factors[i], game.red ? "red" : "blue",
                                           game.values[i]));
    }
  }
  const std::vector<scene::KeyDifference> others = scene::differences(wanted, played);
  if (others.empty()) return "";
  return fmt::format("{} is {}, planned is {}", others.front().key, others.front().b,
                     others.front().a);
} catch (const std::invalid_argument&) {
  return "its scenario cannot be read";
}

bool is_run(const fs::path& path) {
  const std::string name = path.filename().string();
  return name.starts_with("run-") && name.ends_with(".lcmlog");
}

/// Whether a folder has recordings. One that cannot be read may have some.
bool has_runs(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) return false;
  fs::directory_iterator entry(folder, error);
  for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
    if (is_run(entry->path())) return true;
  }
  return static_cast<bool>(error);
}

/// Whether a file has a line below its heading. One that cannot be read may have some.
bool has_rows(const fs::path& file) try {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return false;
  const std::string text = read_study_file(file);
  const std::size_t heading = text.find_first_of("\n\r");
  return heading != std::string::npos &&
         text.find_first_not_of("\n\r", heading) != std::string::npos;
} catch (const std::runtime_error&) {
  return true;
}

/// The newest of the regular files of a folder and its folders, as far as they can be read, and the given
/// time.
/// @param extension  of the files that count; empty for all
fs::file_time_type newest(const fs::path& folder, std::string_view extension,
                          fs::file_time_type last) {
  std::error_code error;
  fs::recursive_directory_iterator entry(folder, fs::directory_options::skip_permission_denied,
                                         error);
  for (; !error && entry != fs::recursive_directory_iterator(); entry.increment(error)) {
    std::error_code gone;
    if (!extension.empty() && entry->path().extension() != extension) continue;
    if (!entry->is_regular_file(gone)) continue;
    const fs::file_time_type time = entry->last_write_time(gone);
    if (!gone) last = std::max(last, time);
  }
  return last;
}

Run look_into(const Study& study, const study::PlannedParticipant& who, const fs::path& path) try {
  Run run{path.stem().string(), path};
  const scene::TrialFile file(path.string());
  const scene::TrialSummary& trial = file.summary();
  run.complete = trial.complete;
  run.seconds = seconds(trial.end);
  run.is_virtual = is_virtual_name(trial.header.participant);
  if (trial.has_header) run.not_planned = not_planned(study, who, trial.header, path);
  std::set<std::string> versions;
  for (const scene::Event& event : trial.events) {
    if (event.kind != scene::kind::version) continue;
    if (versions.empty()) run.first = event.detail.text();
    versions.insert(event.detail.text());
  }
  run.both = versions.size() == 2;
  std::set<std::string> games;
  for (const scene::Sheet& game : scene::score(trial).games) {
    run.one_game_each = run.one_game_each && game.over && games.insert(game.version).second;
  }
  return run;
} catch (const scene::NotBegun&) {
  return {.name = path.stem().string(), .path = path, .begun = false};
}

}  // namespace

std::string read_study_file(const fs::path& path) {
  constexpr std::size_t kMost = 16'000'000;
  return base::read_text(path.string(), kMost);
}

Study open_study(const std::string& folder, IfNoPlan without) {
  Study study{{folder}, {}, {}, {}};
  if (!fs::exists(study.at.design())) {
    throw std::runtime_error(
        fmt::format("{}: expected a study, found no design.toml; `headpin experiment plan -o {}` "
                    "makes one",
                    folder, folder));
  }
  const auto parsed = [](const fs::path& path, auto parse) {
    return parse(read_study_file(path), path.string());
  };
  study.design = parsed(study.at.design(), study::parse_design);
  study.questions = parsed(study.at.questionnaire(), study::parse_questionnaire);
  if (without == IfNoPlan::empty && !fs::exists(study.at.plan())) return study;
  study.plan =
      study::parse_plan(read_study_file(study.at.plan()), study.at.plan().string(), study.design);
  return study;
}

std::set<std::string> names_with_data(const StudyFolder& at) {
  std::set<std::string> names;
  for (const fs::path& path : entries_of(at.root / "sessions")) {
    if (has_runs(path)) names.insert(path.filename().string());
  }
  for (const fs::path& path : entries_of(at.root / "answers")) {
    if (path.extension() == ".csv" && has_rows(path)) names.insert(path.stem().string());
  }
  std::erase_if(names,
                [](const std::string& name) { return !study::wrong_with_name(name).empty(); });
  return names;
}

std::set<std::string> not_in_plan(const Study& study) {
  std::set<std::string> names = names_with_data(study.at);
  for (const study::PlannedParticipant& one : study.plan) names.erase(one.id);
  return names;
}

void say_not_in_plan(const Study& study) {
  for (const std::string& name : not_in_plan(study)) {
    say("{}: {} has sessions or answers but is not in the plan\n", study.at.plan().string(),
        study::shown(name));
  }
}

fs::file_time_type last_change(const Study& study) {
  fs::file_time_type last =
      std::max(fs::last_write_time(study.at.plan()), fs::last_write_time(study.at.questionnaire()));
  for (const auto& [folder, extension] :
       {std::pair("answers", ".csv"), std::pair("sessions", ".lcmlog")}) {
    last = newest(study.at.root / folder, extension, last);
  }
  return last;
}

fs::file_time_type newest_of(const fs::path& folder) {
  return newest(folder, {}, fs::file_time_type::min());
}

const study::PlannedParticipant& planned(const Study& study, const std::string& id) {
  const auto found = std::ranges::find(study.plan, id, &study::PlannedParticipant::id);
  if (found != study.plan.end()) return *found;
  throw UsageError(fmt::format("--participant: expected a name of {}, found '{}'",
                               study.at.plan().string(), study::shown(id)));
}

fs::path bundled(const std::string& kind, const std::string& name_or_file) {
  if (name_or_file.find_first_of("./") != std::string::npos) return name_or_file;
  std::error_code none;
  std::set<std::string> names;
  for (const fs::path& data : scene::data_folders()) {
    if (!fs::is_directory(data / kind, none)) continue;
    names = bundled_names(data / kind);
    if (names.contains(name_or_file)) return data / kind / (name_or_file + ".toml");
    break;
  }
  throw UsageError(fmt::format(
      "none of the {} is called '{}'; expected a file (./{} if it is one) "
      "or one of: {}",
      kind, study::shown(name_or_file), study::shown(name_or_file), fmt::join(names, ", ")));
}

std::string path_beside(const fs::path& design_file, const std::string& name) {
  const bool file = name.find_first_of("./") != std::string::npos;
  return file ? (design_file.parent_path() / name).string() : name;
}

fs::path questionnaire_of(const study::Design& design, const fs::path& design_file) {
  try {
    return bundled("questionnaires", path_beside(design_file, design.questionnaire));
  } catch (const UsageError& error) {
    throw std::invalid_argument(fmt::format("{}:{}: questionnaire: {}", design_file.string(),
                                            design.questionnaire_line, error.what()));
  }
}

StudyLock::StudyLock(const fs::path& path, const std::string& what)
    : descriptor_(open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
  if (descriptor_ < 0) {
    throw std::runtime_error(
        fmt::format("{}: cannot be opened: {}", path.string(), std::strerror(errno)));
  }
  if (base::lock(descriptor_)) return;
  close(descriptor_);
  throw base::Busy(fmt::format("{}: another headpin is {}", path.string(), what));
}

StudyLock::~StudyLock() {
  close(descriptor_);
}

bool StudyLock::is_of(const fs::path& path) const {
  struct stat held = {}, now = {};
  return fstat(descriptor_, &held) == 0 && stat(path.c_str(), &now) == 0 &&
         held.st_dev == now.st_dev && held.st_ino == now.st_ino;
}

std::optional<int> run_number(std::string_view name) {
  constexpr int kMost = 999'999;
  constexpr std::string_view kDigits = "0123456789";
  const std::string_view rest = name.substr(std::string_view("run-").size());
  const std::size_t end = std::min(rest.find_first_not_of(kDigits), rest.size());
  const std::string_view digits = rest.substr(0, end), behind = rest.substr(end);
  const std::optional<int> number = study::whole_in(digits);
  const bool year = digits.size() == 4 && (digits.starts_with("19") || digits.starts_with("20"));
  const bool month = behind.size() > 2 && std::string_view("-_.").find(behind[0]) != behind.npos &&
                     behind.substr(1, 2).find_first_not_of(kDigits) == behind.npos;
  return (year && month) || number > kMost ? std::nullopt : number;
}

std::vector<Run> runs_of(const Study& study, const std::string& id) {
  const study::PlannedParticipant& who = planned(study, id);
  std::vector<fs::path> paths;
  for (const fs::path& path : entries_of(study.at.sessions(id))) {
    if (is_run(path)) paths.push_back(path);
  }
  // run-100 behind run-99, a copy of run-01 between it and run-02, and other names at the end.
  std::ranges::sort(paths, {}, [](const fs::path& path) {
    const std::string name = path.stem().string();
    return std::pair(run_number(name).value_or(std::numeric_limits<int>::max()), name);
  });
  std::vector<Run> runs;
  for (const fs::path& path : paths) runs.push_back(look_into(study, who, path));
  return runs;
}

std::string why_not(const Run& run) {
  if (!run.complete) return "cut off";
  if (!run.both) return "without both versions";
  return run.not_planned.empty() ? "" : "not as planned: " + run.not_planned;
}

const Run* counting(const std::vector<Run>& runs) {
  const auto found = std::ranges::find_if(runs, &Run::done);
  return found == runs.end() ? nullptr : &*found;
}

const Run* of_person(const std::vector<Run>& runs) {
  if (const Run* const counts = counting(runs)) return counts->is_virtual ? nullptr : counts;
  const auto found =
      std::ranges::find_if(runs, [](const Run& run) { return run.begun && !run.is_virtual; });
  return found == runs.end() ? nullptr : &*found;
}

bool began_otherwise(const Study& study, const study::PlannedParticipant& participant,
                     const Run& run) {
  const bool red = study::games_of(study.design, participant.allotted)[0].red;
  return !run.first.empty() && (run.first == "red") != red;
}

bool is_virtual_name(const std::string& participant) {
  return participant.starts_with(kVirtual);
}

std::string virtual_name(const std::string& id) {
  return std::string(kVirtual) + id;
}

}  // namespace headpin::apps
