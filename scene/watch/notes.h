#pragma once

#include <string>

#include "scene/play/run.h"
#include "scene/record/file.h"
#include "scene/record/outside.h"
#include "scene/watch/trial_writer.h"

namespace headpin::scene {

/// Copies what was told of a trial outside any simulation into a trial that is simulated from it. What is about
/// its pictures is left out: they are not copied. Of an incomplete trial an event says so: the new one has its end.
///
/// Each event is written at its time, because the stamps of a log do not go back. One that was told in a tick
/// gets the tick of that time, which is another one at another rate.
class Notes : public Observer {
 public:
  /// @param writer  of the new trial; must outlive this, and see each tick after this
  Notes(const TrialSummary& trial, TrialWriter& writer)
      : told_(trial.events),
        missing_(trial.complete ? "" : what_is_missing(trial)),
        writer_(writer) {}

  void start(const Session& session) override { copy(session, session.now()); }
  void tick(const Session& session) override { copy(session, session.now()); }
  /// Writes what was told later than the last tick, and what is missing. To be called before the writer is closed.
  void finish(const Session& session);

 private:
  void copy(const Session& session, Time until);

  OutsideEvents told_;
  std::string missing_;  // empty if nothing is
  TrialWriter& writer_;
};

}  // namespace headpin::scene
