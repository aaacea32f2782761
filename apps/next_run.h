#pragma once

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>

#include "apps/study_folder.h"

namespace headpin::apps {

/// The participant has played the session.
struct PlayedAlready : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A participant's folder of sessions, locked during the lifetime of this object, and the name of
/// the next run.
class NextRun {
 public:
  /// Says on standard error which recordings are kept.
  ///
  /// @param command  that says it
  /// @throws base::Busy         when another one plays this participant's session
  /// @throws PlayedAlready
  NextRun(const Study& study, const std::string& id, const std::string& command);
  const std::string& path() const { return path_; }

 private:
  std::filesystem::path folder_;
  std::optional<StudyLock> lock_;
  std::string path_;
};

}  // namespace headpin::apps
