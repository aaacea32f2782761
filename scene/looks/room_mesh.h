#pragma once

#include <vector>

#include "render/data/mesh.h"
#include "render/draw_list.h"
#include "scene/stage/room.h"

/// What the room looks like, from its measures. Light is worked out once, for every vertex.
namespace headpin::scene {

struct RoomMeshes {
  render::Mesh lane;      ///< polished
  render::Mesh approach;  ///< where the player walks
  render::Mesh beside;    ///< gutters, carpet, and the floor behind the lane
  render::Mesh walls;     ///< with the ceiling and its lamps
  render::Mesh front;     ///< what stands around the skittles: the lane mirrors it
};

/// The lamps of the room: on the ceiling one to about three metres of its length, seven at most, and
/// one over the skittles, behind the masking panel where there is one.
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
