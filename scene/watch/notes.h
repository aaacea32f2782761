#pragma once

#include "scene/play/run.h"
#include "scene/record/outside.h"
#include "scene/watch/trial_writer.h"

namespace headpin::scene {

/// Copies what was told of a trial outside any simulation into a trial that is simulated from it. What is about
/// its pictures is left out: they are not copied.
///
/// Each event is written at its time, because the stamps of a log do not go back. One that was told in a tick
/// gets the tick of that time, which is another one at another rate.
class Notes : public Observer {
 public:
  /// @param writer  of the new trial; must outlive this, and see each tick after this
  Notes(const TrialSummary& trial, TrialWriter& writer) : told_(trial.events), writer_(writer) {}

  void start(const Session& session) override { copy(session, session.now()); }
  void tick(const Session& session) override { copy(session, session.now()); }
  /// Copies what was told later than the last tick. To be called before the writer is closed.
  void finish(const Session& session) { copy(session, Time::max()); }

 private:
  void copy(const Session& session, Time until);

  OutsideEvents told_;
  TrialWriter& writer_;
};

}  // namespace headpin::scene
