#pragma once

#include <vector>

#include "render/data/mesh.h"
#include "render/draw_list.h"
#include "scene/stage/room.h"

/// Meshes of the room, from its measures. Their light is computed once for every vertex.
namespace headpin::scene {

struct RoomMeshes {
  render::Mesh lane;      ///< polished
  render::Mesh oil;       ///< the parts of the lane with oil, more polished; empty without oil
  render::Mesh approach;  ///< where the player walks
  render::Mesh beside;    ///< gutters, carpet, and the floor behind the lane
  render::Mesh walls;     ///< with the ceiling and its lamps
  render::Mesh front;     ///< parts around the skittles, which the lane reflects
};

/// The lamps of the room: on the ceiling one for about three metres of its length, seven at most,
/// and one above the skittles, behind the masking panel if there is one.
std::vector<render::Lamp> room_lamps(const RoomMeasures& room);

/// Ambient light from above and below.
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
