#pragma once

#include <atomic>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>

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

  /// As it was named.
  const std::string& path() const { return path_; }
  /// The same file, whatever the working folder is now.
  const std::string& file_path() const { return file_path_; }
  const scene::TrialSummary& summary() const { return file_.summary(); }
  const scene::TrialFile& file() const { return file_; }

  /// The trial's own scenario; to be called with the file locked.
  /// @throws std::invalid_argument  when it cannot be read
  const scene::Scenario& scenario();

  /// Keeps other threads from the file and the scenario.
  class Lock {
   public:
    explicit Lock(OpenTrial& trial) : trial_(trial), reading_(trial.reading_) {
      trial_.reader_ = std::this_thread::get_id();
    }
    ~Lock() { trial_.reader_ = std::thread::id(); }
    Lock(const Lock&) = delete;
    Lock& operator=(const Lock&) = delete;

   private:
    OpenTrial& trial_;
    std::lock_guard<std::mutex> reading_;
  };

  /// Who reads the file or the scenario locks it, with the GIL released.
  /// @throws std::runtime_error  when this thread has locked it already: in a law of response
  Lock lock() {
    if (reader_ == std::this_thread::get_id()) {
      throw std::runtime_error(path_ +
                               ": is replayed by this thread; expected other calls after it");
    }
    return Lock(*this);
  }

 private:
  std::string path_, file_path_;
  scene::TrialFile file_;
  std::optional<scene::Scenario> scenario_;
  std::mutex reading_;
  std::atomic<std::thread::id> reader_;  ///< who has it locked; none without one
};

/// The simulation of a trial. The GIL must be released, and the trial locked, for as long as it exists.
struct Run {
  /// @throws DamagedTrial           when the trial holds no samples
  /// @throws std::invalid_argument  when the scenario cannot be played
  ///
  /// @param own  a law of response in place of the scenario's, which must outlive this; null: none
  Run(OpenTrial& trial, const scene::Scenario& scenario, const engine::Response* own,
      scene::TrialPlayer::Beside beside = {});

  /// Makes all ticks, or until `enough`; stops at Ctrl-C.
  void go(std::span<scene::Observer* const> seen_by, const std::function<bool()>& enough = {});

  scene::Session session;
  scene::TrialPlayer source;
  std::int64_t ticks;
};

}  // namespace headpin::python
