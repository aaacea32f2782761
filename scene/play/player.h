#pragma once

#include <optional>
#include <span>
#include <vector>

#include "devices/trial/resample.h"
#include "scene/play/moment.h"
#include "scene/play/walk.h"
#include "scene/stage/stage.h"

/// Whoever stands in the room: where head and hand are, and what the hand holds.
namespace headpin::scene {

/// A body in the hand.
struct Held {
  engine::BodyId body = 0;
  Quat q_HB = Quat::Identity();  ///< how it was taken
};

/// Where the player is, as far as the samples tell.
struct Player {
  Walk walk;                                     ///< X_WP, by the thumbs
  devices::PoseTrack head;                       ///< X_PD: display, x right, y up, looking along -z
  devices::PoseTrack hand;                       ///< X_PH
  std::optional<Time> head_arrival;              ///< of its newest sample
  std::vector<devices::MouseSample> buttons;     ///< not yet acted upon, oldest first
  bool left_thumb = false, right_thumb = false;  ///< walk forward, walk backward
  bool trigger = false;
  std::optional<Held> held;
  std::optional<Time> grip_changed;       ///< tick that took or let go
  std::optional<engine::BodyId> leaving;  ///< let go, and not clear of the hand yet
};

/// X_PS: where a sensor is in the tracked space, which is the world until somebody walks.
///
/// @throws std::runtime_error  for a sample in a frame other than T and P, naming it
Pose sensor_in_space(const devices::TrackerSample& sample, const Rig& rig);

/// Takes in what became known at this moment and walks for a tick, as drive does first; a world is
/// not needed for that. Buttons are left in the player.
///
/// @param now      moment of the poses, `rig.delay_s` before that of the tick
/// @throws std::runtime_error  as sensor_in_space
void follow(Player& player, std::span<const devices::Sample> samples, const Scenario& scenario,
            Time now);

/// Forgets the buttons up to `now`, and poses of long before it.
void forget(Player& player, Time now);

/// Moves head and hand by what the devices say, and does what the buttons ask on the way: walk,
/// take, carry, let go.
///
/// Poses are read `rig.delay_s` before the moment; a ball let go between two ticks has flown since.
/// What is carried stays outside of everything fixed: at the lane or wall that the hand goes through.
/// A solid hand pushes what it touches; while it carries something, and until that is clear of it
/// again, it is away.
///
/// @param samples  that became known at this moment
/// @param out      events are appended
/// @throws std::runtime_error  as sensor_in_space
void drive(Player& player, std::span<const devices::Sample> samples, const Stage& stage,
           engine::World& world, const Moment& moment, std::vector<devices::Event>& out);

}  // namespace headpin::scene
