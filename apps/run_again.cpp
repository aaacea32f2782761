#include "apps/run_again.h"

#include "apps/progress.h"
#include "apps/stop.h"

namespace headpin::apps {

void run_again(const scene::Recorded& trial, scene::Session& session,
               std::vector<scene::Observer*> observers) {
  const std::int64_t ticks = trial.ticks();
  ProgressLine progress("ticks", ticks);
  observers.push_back(&progress);
  scene::TrialPlayer source(trial.file);
  scene::NoPace pace;
  scene::run(session, source, pace, observers, [&](const scene::Session& s) {
    check_stop();
    return s.tick >= ticks;
  });
}

}  // namespace headpin::apps
