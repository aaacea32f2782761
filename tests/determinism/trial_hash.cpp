/// Replays whole trials and compares every recorded tick: builds that promise equal bits print equal
/// lines. Usage: trial_hash TRIAL...

#include <cstdio>
#include <exception>

#include "engine/world.h"
#include "scene/play/run.h"
#include "scene/watch/recorded.h"
#include "scene/watch/totals.h"
#include "scene/watch/verifier.h"

namespace {

using namespace headpin;

void replay(const char* path) {
  const scene::Recorded recorded = scene::load_trial(path);
  scene::Session session = scene::make_session(recorded.scenario);
  scene::TrialPlayer source(recorded.file, {.states = true});
  scene::Totals totals;
  scene::Verifier verifier(path, source, session);
  scene::Observer* const observers[] = {&totals, &verifier};
  scene::NoPace pace;
  const std::int64_t ticks = recorded.ticks();
  scene::run(session, source, pace, observers,
             [&](const scene::Session& s) { return s.tick >= ticks; });
  std::printf("%s: %016llx after %lld ticks, %lld verified, %lld down\n", path,
              static_cast<unsigned long long>(engine::state_hash(session.world)),
              static_cast<long long>(session.tick), static_cast<long long>(verifier.compared()),
              static_cast<long long>(totals.score().skittles_down));
  for (const scene::Sheet& game : totals.score().games) {
    std::printf("  %s\n", scene::in_words(game).c_str());
  }
}

}  // namespace

int main(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    try {
      replay(argv[i]);
    } catch (const std::exception& error) {
      std::printf("%s: %s\n", argv[i], error.what());
      return 1;
    }
  }
}
