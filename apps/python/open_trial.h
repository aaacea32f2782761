#pragma once

#include <mutex>
#include <optional>
#include <span>
#include <string>

#include "apps/python/interrupts.h"
#include "scene/play/run.h"
#include "scene/record/file.h"
#include "scene/scenario/scenario.h"

namespace headpin::python {

/// A trial that is open. The file stays readable when it is deleted.
class OpenTrial {
 public:
  /// @throws FileMissing, NotPermitted, DamagedTrial
  OpenTrial(const std::string& path, Time longest_gap);

  const std::string& path() const { return path_; }
  const scene::TrialSummary& summary() const { return file_.summary(); }
  const scene::TrialFile& file() const { return file_; }

  /// The trial's own scenario; to be called with the file locked.
  /// @throws std::invalid_argument  when it cannot be read
  const scene::Scenario& scenario();

  /// Who reads the file or the scenario locks it, with the GIL released.
  std::unique_lock<std::mutex> lock() { return std::unique_lock(reading_); }

 private:
  std::string path_;
  scene::TrialFile file_;
  std::optional<scene::Scenario> scenario_;
  std::mutex reading_;
};

/// The simulation of a trial. The GIL must be released, and the trial locked, for as long as it exists.
struct Run {
  /// @throws DamagedTrial           when the trial holds no samples
  /// @throws std::invalid_argument  when the scenario cannot be played
  Run(OpenTrial& trial, const scene::Scenario& scenario, scene::TrialPlayer::Beside beside = {});

  /// Makes all ticks, or until `enough`; stops at Ctrl-C.
  void go(std::span<scene::Observer* const> seen_by, const std::function<bool()>& enough = {});

  scene::Session session;
  scene::TrialPlayer source;
  std::int64_t ticks;
};

}  // namespace headpin::python
