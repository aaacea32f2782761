#pragma once

#include <optional>
#include <span>
#include <vector>

#include "devices/resample.h"
#include "scene/moment.h"
#include "scene/stage.h"

/// Whoever stands in the room: where head and hand are, and what the hand holds.
namespace headpin::scene {

/// A body in the hand.
struct Held {
  engine::BodyId body = 0;
  Quat q_HB = Quat::Identity();  ///< how it was taken
};

/// Where the player is, as far as the samples tell.
struct Player {
  devices::PoseTrack head;                       ///< X_WD: display, x right, y up, looking along -z
  devices::PoseTrack hand;                       ///< X_WH
  std::optional<Time> head_arrival;              ///< of its newest sample
  std::vector<devices::MouseSample> buttons;     ///< not yet acted upon, oldest first
  bool left_thumb = false, right_thumb = false;  ///< walk forward, walk backward
  bool trigger = false;
  std::optional<Held> held;
};

/// X_WS: where a sensor is in the world.
///
/// @throws std::runtime_error  for a sample in a frame other than T and W, naming it
Pose sensor_in_world(const devices::TrackerSample& sample, const Rig& rig);

/// Moves head and hand by what the devices say, and does what the buttons ask on the way: take,
/// carry, let go.
///
/// Poses are read `rig.delay_s` before the moment; a ball let go between two ticks has flown since.
/// What is carried stays outside of everything fixed: at the lane or wall that the hand goes through.
///
/// @param samples  that became known at this moment
/// @param out      events are appended
/// @throws std::runtime_error  as sensor_in_world
void drive(Player& player, std::span<const devices::Sample> samples, const Stage& stage,
           engine::World& world, const Moment& moment, std::vector<devices::Event>& out);

}  // namespace headpin::scene
