#include "apps/run_again.h"

#include <optional>

#include "apps/progress.h"
#include "apps/stop.h"
#include "scene/watch/verifier.h"

namespace headpin::apps {

void run_again(const std::string& name, const scene::Recorded& trial, scene::Session& session,
               std::vector<scene::Observer*> observers) {
  const std::int64_t ticks = trial.ticks();
  ProgressLine progress("ticks", ticks);
  observers.push_back(&progress);
  scene::TrialPlayer source(trial.file, {.states = true});
  std::optional<scene::Verifier> verifier;
  if (source.has_states()) {
    observers.insert(observers.begin(), &verifier.emplace(name, source, session));
  }
  scene::NoPace pace;
  scene::run(session, source, pace, observers, [&](const scene::Session& s) {
    check_stop();
    return s.tick >= ticks;
  });
}

}  // namespace headpin::apps
