#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "devices/base/source.h"
#include "engine/workspace.h"
#include "scene/play/game.h"
#include "scene/play/game_hash.h"
#include "scene/play/player.h"
#include "scene/play/presence.h"
#include "scene/play/tracking.h"

/// One tick: take samples, move hand and head, step the world, report events.
namespace headpin::scene {

struct Session {
  std::shared_ptr<const Stage> stage;  ///< the initial stage; shared by many runs
  engine::World world;
  Player player;
  Game game;
  Tracking tracking;                                     ///< whether head and hand are seen
  Presence presence;                                     ///< bodies that fly at the player
  std::array<std::shared_ptr<const Stage>, 2> versions;  ///< red, blue; where there are buttons
  std::shared_ptr<const Stage> unbegun;  ///< before either of them; where there are buttons
  /// True after the hand has touched a button.
  bool version_begun = false;
  /// The version that is played: 0 none, 1 red, 2 blue.
  std::uint64_t version = 0;
  std::optional<std::size_t> touched;  ///< the button that the hand touches
  std::int64_t tick = 0;          ///< tick of the session's clock; a new world does not reset it
  engine::Statistics statistics;  ///< of all steps so far
  engine::Workspace workspace;    ///< of those steps
  /// False: the two hashes are not updated, which saves a fifth of a replay's time.
  bool hashes = true;
  std::uint64_t state_hash = 0;  ///< of the world after the last tick
  GameHash game_hash;            ///< of all ticks so far

  // Input and output of the last tick.
  std::vector<devices::Sample> samples;
  std::vector<Event> events;

  /// That of the version that is played.
  const Scenario& scenario() const { return stage->scenario; }
  /// That of the whole trial, which its versions are made of.
  const Scenario& trial_scenario() const { return (unbegun ? unbegun : stage)->scenario; }
  Time now() const { return tick_time(tick, scenario().rates.physics_hz); }
  Time next_tick() const { return tick_time(tick + 1, scenario().rates.physics_hz); }
};

/// Makes a session at the start of its stage. Copies the stage's world without computing it again.
Session make_session(std::shared_ptr<const Stage> stage);
Session make_session(const Scenario& scenario);

/// Gives the session a law of response of one's own, in every version of its game. Its trial replays
/// only with the same law, so the session makes no hashes.
///
/// @param response  must outlive the session
void set_response(Session& session, const engine::Response& response);

/// Makes one tick: takes all samples that the source has by then, steps the world, finds bodies
/// that fly at the player, and applies the rules of the game.
///
/// A button that the hand touches starts its version: another stage with its world; tick, clock and
/// ledger of the session continue. Without buttons the game starts at once, with buttons at the
/// first touch.
///
/// The session keeps the samples, each with the tick's time, and the events until the next tick.
/// @throws std::runtime_error  naming tick and body when the state becomes non-finite
void advance(Session& session, devices::Source& source);

/// The event that only the end of a trial brings, if it ended now: the way of a ball that is still on
/// it.
std::optional<Event> last_ball_path(const Session& session);

/// The world after the last tick, for the log.
void tick_state(const Session& session, TickState& out);

/// Current poses of head and hand: interpolated at `rig.delay_s` before now; after the last sample,
/// that sample's pose.
std::optional<Pose> head_pose(const Session& session);  ///< X_WD
std::optional<Pose> hand_pose(const Session& session);  ///< X_WH; nothing while it is away
/// The head's pose at a time after the previous tick, from the samples that are known now.
std::optional<Pose> head_pose(const Session& session, Time at);

}  // namespace headpin::scene
