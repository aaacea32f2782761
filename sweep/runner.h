#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "scene/record/trial.h"
#include "scene/stage/stage.h"
#include "sweep/apart.h"
#include "sweep/rows.h"
#include "sweep/shared_start.h"

namespace headpin::sweep {

/// The places of bodies under a trial's own condition, simulated on the first request.
struct OwnCondition {
  std::once_flag once;
  Frames frames;  ///< none where it cannot be simulated
};

/// A recorded trial in memory, read once for all rows.
struct Trial {
  std::string sha256;  ///< of its file
  scene::Scenario scenario;
  std::string scenario_text;             ///< whole; trials with the same one share stages
  std::vector<devices::Sample> samples;  ///< in the order of the log
  scene::TrialSummary summary;           ///< says how long a replay is
  std::shared_ptr<OwnCondition> own = std::make_shared<OwnCondition>();  ///< for all threads
};

/// @throws std::runtime_error  as scene::load_trial
Trial read_trial(const std::string& path);

/// Simulates trials under conditions, one after the other. Each thread has its own.
class Replayer {
 public:
  /// @param keys    those of the conditions, see condition_of()
  /// @param trials  must outlive this, as `keys` must
  Replayer(const std::vector<std::string>& keys, const std::vector<Trial>& trials)
      : keys_(keys), trials_(trials) {}

  /// @param trial   its number
  /// @param values  of the keys, in their order
  /// @param check   called at every tick; may throw
  /// @return  the cells of result_columns(); a replay that fails has its reason in the last
  /// @throws  whatever `check` throws, and std::bad_alloc: memory that is out is not the row's error
  std::vector<std::string> run(std::size_t trial, const std::vector<std::string>& values,
                               const std::function<void()>& check);

 private:
  std::shared_ptr<const scene::Stage> stage_of(std::size_t trial,
                                               const std::vector<std::string>& values);

  const std::vector<std::string>& keys_;
  const std::vector<Trial>& trials_;
  std::shared_ptr<const scene::Stage> stage_;  ///< of the last replay
  std::string stage_text_;                     ///< what it was made from
  SharedStart start_;
};

/// Simulates rows, one after the other. Each thread has its own.
class Runner {
 public:
  /// @param rows, trials  must outlive this
  Runner(const Rows& rows, const std::vector<Trial>& trials)
      : rows_(rows), replayer_(rows.keys(), trials) {}

  /// @param check  called at every tick; may throw
  /// @return  the cells of a line, the row's own first; a row that fails has its reason in it
  /// @throws  whatever `check` throws
  std::vector<std::string> run(const Row& row, const std::function<void()>& check);

 private:
  const Rows& rows_;
  Replayer replayer_;
};

}  // namespace headpin::sweep
