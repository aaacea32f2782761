#pragma once

#include <vector>

#include "render/draw_list.h"
#include "render/mesh.h"

/// What the room looks like, from its measures. Light is worked out once, for every vertex.
namespace headpin::scene {

/// The room as the eyes see it [m], in the world: the lane's middle at x = 0, foul line at y = 0,
/// lane and approach at z = 0.
struct RoomMeasures {
  double width = 4.5;
  double height = 2.8;
  double behind = 3.0;  ///< from the foul line back to the wall behind the player
  double ahead = 7.6;   ///< from the foul line to the wall behind the skittles
  double lane_width = 1.0541;
  double head_pin = 6.0;   ///< from the foul line to the head pin's spot
  double deck_end = 7.05;  ///< where the lane ends, behind the last row
  double gutter_width = 0.235;
  double gutter_depth = 0.0;  ///< the floor is one plane to whatever rolls: gutters are drawn on it
  double masking_low = 0.85;  ///< lower edge of the panel that hangs before the skittles
  std::vector<Vec2> spots;    ///< of the skittles, from the head pin's: x right, y away
};

/// A solid with its sides along the world's axes, by two opposite corners.
struct Block {
  Vec3 low_W, high_W;
};

/// What stands around the skittles: the kick-backs to the left and right, and the masking panel
/// that hangs between them. What is seen is what is hit.
std::vector<Block> front_blocks(const RoomMeasures& room);

struct RoomMeshes {
  render::Mesh lane;      ///< polished
  render::Mesh approach;  ///< where the player walks
  render::Mesh beside;    ///< gutters, carpet, and the floor behind the lane
  render::Mesh walls;     ///< with the ceiling and its lamps
  render::Mesh front;     ///< what stands around the skittles: the lane mirrors it
};

/// The lamps of the room: three on the ceiling, and one behind the masking panel.
std::vector<render::Lamp> room_lamps(const RoomMeasures& room);

/// Light from all around, above and below.
struct Ambient {
  Vec3 sky, ground;
};
Ambient room_ambient();

RoomMeshes room_meshes(const RoomMeasures& room);

/// The flat parts of the floor, for contact shadows.
std::vector<render::Patch> floor_patches(const RoomMeasures& room);

/// A stand that holds a ball, its foot on the floor at the origin.
///
/// @param height  of its rim: the ball rests a little lower [m]
render::Mesh stand_mesh(double height, double ball_radius);

}  // namespace headpin::scene
