#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "devices/base/source.h"
#include "scene/play/game.h"
#include "scene/play/game_hash.h"
#include "scene/play/player.h"
#include "scene/play/presence.h"

/// The flow of one tick: samples in, hand and head moved, the world stepped, what happened out.
namespace headpin::scene {

struct Session {
  std::shared_ptr<const Stage> stage;  ///< as it was before anything happened; shared by many runs
  engine::World world;
  Player player;
  Game game;
  Presence presence;                                     ///< what flies at the player
  std::array<std::shared_ptr<const Stage>, 2> versions;  ///< red, blue; where there are buttons
  bool version_begun = false;                            ///< by one of them
  std::uint64_t version = 0;                             ///< that is played: 0 none, 1 red, 2 blue
  std::optional<std::size_t> touched;                    ///< the button that the hand is at
  std::int64_t tick = 0;          ///< of the session's own clock, which no new world restarts
  engine::Statistics statistics;  ///< of all steps so far
  std::uint64_t state_hash = 0;   ///< of the world after the last tick
  GameHash game_hash;             ///< of all ticks so far

  // What the last tick took in and gave out.
  std::vector<devices::Sample> samples;
  std::vector<devices::Event> events;

  const Scenario& scenario() const { return stage->scenario; }
  Time now() const { return tick_time(tick, scenario().rates.physics_hz); }
  Time next_tick() const { return tick_time(tick + 1, scenario().rates.physics_hz); }
};

/// A session at the start of its stage. Copies the stage's world; nothing is worked out again.
Session make_session(std::shared_ptr<const Stage> stage);
Session make_session(const Scenario& scenario);

/// One tick: everything the source knows by then, then one step of the world, what of it flies at
/// the player, and what the rules make of it.
///
/// A button that the hand comes to starts its version: another stage and its world, with the
/// session's tick, clock and ledger going on. Without buttons the game is on from the start, with
/// them from the first touch.
///
/// The samples taken in, each stamped with the tick's time, and the events stand in the session
/// until the next tick.
/// @throws std::runtime_error  naming tick and body when the state turns non-finite
void advance(Session& session, devices::Source& source);

/// The world after the last tick, for the log.
void tick_state(const Session& session, devices::TickState& out);

/// Head and hand now: read between the samples `rig.delay_s` ago, held after the last one.
std::optional<Pose> head_pose(const Session& session);  ///< X_WD
std::optional<Pose> hand_pose(const Session& session);  ///< X_WH
/// The head at a time since the tick before, by the samples known now.
std::optional<Pose> head_pose(const Session& session, Time at);

}  // namespace headpin::scene
