#pragma once

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "apps/study_folder.h"

namespace headpin::apps {

/// The participant has played the session.
struct PlayedAlready : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A person has begun the session that a virtual participant was to play.
struct PersonsSession : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Asked before a virtual participant plays.
/// @throws PersonsSession  where a person has begun one of the participant's runs, and plays now or was cut off
void leave_to_person(const std::vector<Run>& runs, const std::string& id);

/// A participant's folder of sessions, locked during the lifetime of this object, and the name of
/// the next run.
class NextRun {
 public:
  /// Says on standard error which recordings are kept.
  ///
  /// @param command     that says it
  /// @param is_virtual  a virtual participant is to play
  /// @throws base::Busy         when another one plays this participant's session
  /// @throws PlayedAlready
  /// @throws PersonsSession     for a virtual participant where a person's session was cut off
  NextRun(const Study& study, const std::string& id, const std::string& command, bool is_virtual);
  /// Locks the folder also where it was put elsewhere meanwhile and made anew.
  /// @throws base::Busy, PlayedAlready  where no other run can be played now
  void require_unplayed(const Study& study, const std::string& id);
  /// Names the run after this one, which was cut off. The folder stays locked, whether it can or not; one that
  /// was put elsewhere meanwhile is made anew.
  /// @throws base::Busy, PlayedAlready, PersonsSession  as above
  void renew(const Study& study, const std::string& id, const std::string& command,
             bool is_virtual);
  const std::string& path() const { return path_; }

 private:
  void lock(const std::string& id);

  std::filesystem::path folder_;
  std::optional<StudyLock> lock_;
  std::string path_;
};

}  // namespace headpin::apps
