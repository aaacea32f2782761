#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "study/design.h"
#include "study/plan.h"
#include "study/questionnaire.h"

/// A study on the disk: a folder that a person can read.
namespace headpin::apps {

/// Where a study has what.
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

/// A file of a study as it came along or as it is edited; at most 16 MB.
std::string read_study_file(const std::filesystem::path& path);

/// Reads design, questionnaire and plan of a study.
/// @throws std::runtime_error     for a folder that holds none
/// @throws std::invalid_argument  for what cannot be, naming file and line
Study open_study(const std::string& folder);

/// The row of the plan.
/// @throws UsageError  for a name that is not in it
const study::PlannedParticipant& planned(const Study& study, const std::string& id);

/// A file that comes with the program, by its name (`uno-slater-1997`), or any other.
///
/// @param kind  the folder of share/headpin: designs, questionnaires
/// @throws UsageError  for a name that is not there, with those that are
std::filesystem::path bundled(const std::string& kind, const std::string& name_or_file);

/// Keeps others of us from working on the same thing until it goes.
class StudyLock {
 public:
  /// @param path  of a file or folder that is there
  /// @throws files::Busy  when another has it
  StudyLock(const std::filesystem::path& path, const std::string& what);
  ~StudyLock();
  StudyLock(const StudyLock&) = delete;
  StudyLock& operator=(const StudyLock&) = delete;

 private:
  int descriptor_ = -1;
};

/// One recording of a participant's session.
struct Run {
  std::string name;  ///< run-01
  std::filesystem::path path;
  bool complete = false;  ///< the recording has its end
  bool both = false;      ///< both versions were begun
  double seconds = 0.0;
  bool is_virtual = false;

  bool done() const { return complete && both; }
};

/// All of them, in the order in which they were played.
std::vector<Run> runs_of(const StudyFolder& at, const std::string& id);

/// The run that counts: the first that is done; null where none is.
const Run* counting(const std::vector<Run>& runs);

/// Whether a trial is of a virtual participant, as its header has it.
bool is_virtual_name(const std::string& participant);
std::string virtual_name(const std::string& id);

}  // namespace headpin::apps
