#include "scene/watch/entered.h"

#include <stdexcept>
#include <utility>

#include <fmt/format.h>

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

/// Refuses another condition that a session in its middle cannot go on under.
///
/// @throws std::invalid_argument  naming the keys
void check_goes_on(const Scenario& own, const Scenario& other) {
  if (own.rates.physics_hz != other.rates.physics_hz) {
    throw std::invalid_argument(
        fmt::format("rates.physics_hz: expected that of the trial, {}, found {}",
                    own.rates.physics_hz, other.rates.physics_hz));
  }
  const GameRules &game = own.game, &now = other.game;
  if (game.rules != now.rules || game.frames != now.frames || game.balls != now.balls) {
    throw std::invalid_argument(fmt::format(
        "game.rules, game.frames and game.balls: expected those of the trial, {}, {} and {}, found {}, {} "
        "and {}; a score sheet has the rules of one game",
        name_of(game.rules), game.frames, game.balls, name_of(now.rules), now.frames, now.balls));
  }
}

/// @throws std::invalid_argument  if the skittles of a stage have other spots than those of the other one
void check_spots(const Stage& own, const Stage& other) {
  for (const engine::BodyId skittle : own.skittles) {
    const Vec3 &before = own.world.states[skittle].X_WB.p,
               &now = other.world.states[skittle].X_WB.p;
    if (before.head<2>() == now.head<2>()) continue;
    throw std::invalid_argument(fmt::format(
        "lane.head_pin and rack.spots: expected the spots of the trial, where its skittles stand; {} has "
        "the spot {:g}, {:g} there, and {:g}, {:g} here",
        own.world.bodies[skittle].name, before.x(), before.y(), now.x(), now.y()));
  }
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
  check_goes_on(own, other);
  Session begun = make_session(other);
  const bool in_version = session.version > 0 && begun.versions[0];
  const std::shared_ptr<const Stage> stage =
      in_version ? begun.versions[session.version - 1] : begun.stage;
  if (body_names(*session.stage) != body_names(*stage)) {
    throw std::invalid_argument("expected the bodies of the trial; this condition has others");
  }
  check_spots(*session.stage, *stage);
  Session moved = on_its_own(std::move(session), stage);
  moved.versions = begun.versions;
  moved.unbegun = begun.unbegun;
  return moved;
}

}  // namespace headpin::scene
