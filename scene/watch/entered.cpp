#include "scene/watch/entered.h"

#include <stdexcept>
#include <utility>

#include "scene/play/save.h"
#include "scene/watch/alone.h"

namespace headpin::scene {

namespace {

constexpr int kMostTries = 3;  // snapshots of one trial fail together, or one is damaged

/// The session at the last usable snapshot of at most this time, or a new one.
Session at_last_snapshot(const Recorded& trial, Time at) {
  Session session = make_session(trial.scenario);
  for (int i = 0; i < kMostTries; ++i) {
    const std::optional<Snapshot> snapshot = trial.file.last_snapshot(at);
    if (!snapshot) break;
    try {
      Session restored = restore(session, snapshot->saved);
      if (restored.tick == snapshot->tick && restored.now() <= at) return restored;
    } catch (const std::invalid_argument&) {
    }
    at = snapshot->time - Time{1};
  }
  return session;
}

}  // namespace

Entered enter(const Recorded& trial, Time at, TrialPlayer::Beside beside) {
  Entered entered{at_last_snapshot(trial, at), std::make_unique<TrialPlayer>(trial.file, beside)};
  // A tick at a time, so that states and frames of earlier ticks are not kept.
  std::vector<devices::Sample> used;
  const std::int64_t rate_hz = trial.scenario.rates.physics_hz;
  for (std::int64_t tick = 1; tick <= entered.session.tick; ++tick) {
    used.clear();
    entered.source->poll(tick_time(tick, rate_hz), used);
    if (beside.states) entered.source->state(tick);
    while (beside.frames && entered.source->next_frame(tick)) {
    }
  }
  return entered;
}

Session under_from_now_on(Session session, const Scenario& own, const Scenario& other) {
  if (differences(own, other).empty()) return session;
  Session begun = make_session(other);
  if (session.scenario().rates.physics_hz != other.rates.physics_hz) {
    throw std::invalid_argument("rates.physics_hz: expected that of the trial");
  }
  const bool in_version = session.version > 0 && begun.versions[0];
  const std::shared_ptr<const Stage> stage =
      in_version ? begun.versions[session.version - 1] : begun.stage;
  if (body_names(*session.stage) != body_names(*stage)) {
    throw std::invalid_argument("expected the bodies of the trial; this condition has others");
  }
  Session moved = on_its_own(std::move(session), stage);
  moved.versions = begun.versions;
  return moved;
}

}  // namespace headpin::scene
