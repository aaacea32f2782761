#pragma once

#include "engine/world.h"
#include "scene/record/details.h"
#include "scene/stage/room.h"

/// Finds the way of a thrown ball, in the words of coaches, from its states.
namespace headpin::scene {

/// The board at a place across the lane: 20 in the middle, a half between two boards.
double board_at(const RoomMeasures& room, double x);

/// Whether a ball touches the lane, or is no more than a millimetre above it.
///
/// @param radius  of the ball [m]
inline bool is_on_lane(double radius, const engine::State& s) {
  return s.X_WB.p.z() < radius + 1e-3;
}

/// How a ball moves.
Delivered delivered(const RoomMeasures& room, const engine::State& s);

/// What was found of a ball's way, and what finding the rest needs.
struct BallWatch {
  BallPath path;
  engine::State last;       ///< of the ball
  double landed_deg = 0.0;  ///< its direction when it first touched the lane
  bool over = false;        ///< it left the lane: nothing more is found
};

/// Begins at the release of a ball.
BallWatch watch_ball(const RoomMeasures& room, const engine::State& release);

/// Adds the state of the ball after a step.
///
/// @param radius        of the ball [m]
/// @param world         its state belongs to, for gravity and the time of the step
/// @param strikes       it met a skittle in this step, the first one of its way
/// @param was_released  in this step, so that it fell for a part of it
void see(BallWatch& watch, const RoomMeasures& room, double radius, const engine::World& world,
         const engine::State& now, bool strikes, bool was_released = false);

}  // namespace headpin::scene
