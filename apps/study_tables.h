#pragma once

#include <filesystem>
#include <string>

#include "apps/study_folder.h"
#include "base/output_folder.h"

/// Folders of results of a study: all files of a set are new, or all are old.
namespace headpin::apps {

class StudyTables {
 public:
  /// @throws as base::OutputFolder; what headpin wrote there before is replaced
  explicit StudyTables(const std::filesystem::path& folder);

  void write(const std::string& name, const std::string& text);
  void commit(const std::string& last);

 private:
  base::OutputFolder folder_;
};

/// The file of an analysis that says from which table it was made.
constexpr const char* kMadeFrom = "made-from.txt";

/// Its text for this text of tables/participants.csv: a line as of `sha256sum`, relative to the
/// folder of the analysis.
std::string made_from(const std::string& participants_csv);

/// The design's notes about this table.
void print_notes(const Study& study, const std::string& table);

}  // namespace headpin::apps
