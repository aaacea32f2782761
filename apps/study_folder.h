#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "study/design.h"
#include "study/plan.h"
#include "study/questionnaire.h"

/// The folder of a study.
namespace headpin::apps {

/// The paths in a study's folder.
struct StudyFolder {
  std::filesystem::path root;

  std::filesystem::path design() const { return root / "design.toml"; }
  std::filesystem::path scenario() const { return root / "scenario.toml"; }
  std::filesystem::path questionnaire() const { return root / "questionnaire.toml"; }
  std::filesystem::path plan() const { return root / "plan.csv"; }
  std::filesystem::path sessions(const std::string& id) const { return root / "sessions" / id; }
  std::filesystem::path answers(const std::string& id) const {
    return root / "answers" / (id + ".csv");
  }
};

struct Study {
  StudyFolder at;
  study::Design design;
  study::Questionnaire questions;
  study::Plan plan;
};

/// A file of a study, bundled or edited; at most 16 MB.
std::string read_study_file(const std::filesystem::path& path);

/// What a study whose plan.csv is not there is taken for.
enum class IfNoPlan { refused, empty };

/// Reads design, questionnaire and plan of a study.
/// @throws std::runtime_error     for a folder without a study
/// @throws std::invalid_argument  for invalid content, naming file and line
Study open_study(const std::string& folder, IfNoPlan without = IfNoPlan::refused);

/// Names of participants of whom the study's folder has recordings or answers, of the plan or not.
/// @throws std::filesystem::filesystem_error  for a folder that cannot be read
std::set<std::string> names_with_data(const StudyFolder& at);

/// The names of them that are not in the plan: of rows that were deleted, or of a plan that was lost.
std::set<std::string> not_in_plan(const Study& study);

/// Says on standard error which names have data and are not in the plan.
void say_not_in_plan(const Study& study);

/// When plan, questionnaire, recordings or answers were changed last.
std::filesystem::file_time_type last_change(const Study& study);

/// When a file of a folder, or of a folder in it, was changed last; the earliest time if there is none.
std::filesystem::file_time_type newest_of(const std::filesystem::path& folder);

/// The row of the plan.
/// @throws UsageError  for a name that is not in it
const study::PlannedParticipant& planned(const Study& study, const std::string& id);

/// The path of a bundled file by its name (`uno-slater-1997`), or of any other file.
///
/// @param kind  the folder of share/headpin: designs, questionnaires
/// @throws UsageError  for a name that is not there, with those that are
std::filesystem::path bundled(const std::string& kind, const std::string& name_or_file);

/// A file that a design names: relative to the design's folder, or a bundled one by its name.
std::string path_beside(const std::filesystem::path& design_file, const std::string& name);

/// The path of the questionnaire that a design names.
/// @throws std::invalid_argument  naming the design's file and line, if there is none of that name
std::filesystem::path questionnaire_of(const study::Design& design,
                                       const std::filesystem::path& design_file);

/// A lock against other headpin processes, until it is destroyed.
class StudyLock {
 public:
  /// @param path  of a file or folder that is there
  /// @throws base::Busy  when another process has locked it
  StudyLock(const std::filesystem::path& path, const std::string& what);
  ~StudyLock();
  StudyLock(const StudyLock&) = delete;
  StudyLock& operator=(const StudyLock&) = delete;

  /// Whether what it locks is still what has this path.
  bool is_of(const std::filesystem::path& path) const;

 private:
  int descriptor_ = -1;
};

/// One recording of a participant's session.
struct Run {
  std::string name;  ///< run-01
  std::filesystem::path path;
  bool begun = true;      ///< the recording has its beginning
  bool complete = false;  ///< and its end
  bool both = false;      ///< both versions were begun
  double seconds = 0.0;
  bool is_virtual = false;
  /// Neither version was begun more than once, and both were played to their end.
  bool one_game_each = true;
  std::string first = {};  ///< version that was begun first: red or blue; empty if none was
  /// The first thing in which the recording is not what the plan has; empty if there is none.
  std::string not_planned = {};

  bool done() const { return complete && both && not_planned.empty(); }
};

/// The number of a run of this name: 7 of "run-07", "run-07 copy" and "run-07_2026-11-30"; none of names of one's
/// own, as "run-x", "run-2026-11-30", or with a number above 999999.
std::optional<int> run_number(std::string_view name);

/// All recordings of a participant of the plan, in order of time: by their numbers, a copy behind its run. Those
/// without a number are at the end.
std::vector<Run> runs_of(const Study& study, const std::string& id);

/// Why a recording does not count: "cut off"; empty for one that may count.
std::string why_not(const Run& run);

/// The run that counts: the first complete one with both versions as planned; null if there is none.
const Run* counting(const std::vector<Run>& runs);

/// The run by which a participant is a person: the one that counts, or else the first that a person has begun.
/// Null if there is none, or if a virtual participant played the one that counts.
const Run* of_person(const std::vector<Run>& runs);

/// Whether a run began with another version than the plan has.
bool began_otherwise(const Study& study, const study::PlannedParticipant& participant,
                     const Run& run);

/// Whether a trial's header says that a virtual participant played it.
bool is_virtual_name(const std::string& participant);
std::string virtual_name(const std::string& id);

}  // namespace headpin::apps
