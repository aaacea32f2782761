#pragma once

#include "scene/record/trial.h"
#include "scene/stage/stage.h"

namespace headpin::apps {

/// The bodies of a scenario at the poses of a recorded state.
class RecordedWorld {
 public:
  explicit RecordedWorld(const scene::Scenario& scenario);

  /// Energy of balls and skittles, including a ball in the hand [J].
  struct Energy {
    double all = 0.0;     ///< of motion and height
    double height = 0.0;  ///< from the lane
  };
  Energy energy(const scene::TickState& state);

  const scene::Stage& stage() const { return stage_; }

 private:
  scene::Stage stage_;
};

}  // namespace headpin::apps
