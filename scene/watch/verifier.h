#pragma once

#include <stdexcept>
#include <string>

#include "scene/play/run.h"
#include "scene/record/file.h"
#include "scene/record/first_difference.h"

namespace headpin::scene {

/// A run differs from the recording.
struct Differs : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Compares a run with the recorded states of a trial.
class Verifier : public Observer {
 public:
  /// @param trial     its name, for errors
  /// @param recorded  with the states beside it; must outlive this
  /// @throws std::runtime_error  when there are none
  Verifier(std::string trial, TrialPlayer& recorded, const Session& session);

  /// @throws Differs  naming the trial, the tick, and the first body that differs
  void tick(const Session& session) override;

  /// Compares what is known at the end: the game hash and the number of states. A complete recording may
  /// end before its last samples; an incomplete one has lost states.
  ///
  /// @return  ticks up to the end of the recording that have no state in it
  /// @throws Differs             when the game hash differs
  /// @throws std::runtime_error  when states are missing, except for that of the tick in which a
  ///                             recording was cut off
  std::int64_t finish(const TrialSummary& trial, const Session& session) const;

  std::int64_t compared() const { return compared_; }  ///< ticks found equal

 private:
  std::string trial_;
  TrialPlayer& recorded_;
  SharedBodies bodies_;  ///< all of them
  TickState state_;
  std::int64_t first_;  ///< tick before the first compared one
  std::int64_t compared_ = 0;
};

}  // namespace headpin::scene
