#pragma once

#include <vector>

#include "scene/scenario/scenario.h"

/// Measures of the room and its fixed parts, for looks and bodies.
namespace headpin::scene {

/// A rectangle of the lane with oil, by its corners (x, y) in the world [m].
struct OiledArea {
  Vec2 low, high;
  double friction;  ///< between the lane there and what touches it
};

/// The room [m], in the world: the lane's middle at x = 0, foul line at y = 0, lane and approach at
/// z = 0.
struct RoomMeasures {
  double width = 4.5;
  double height = 2.8;
  double behind = 3.0;  ///< from the foul line back to the wall behind the player
  double ahead = 7.6;   ///< from the foul line to the wall behind the skittles
  double lane_width = 1.0541;
  double head_pin = 6.0;      ///< from the foul line to the head pin's spot
  double deck_end = 7.05;     ///< where the lane ends, behind the last row
  double gutter_width = 0.0;  ///< 0 for none
  double gutter_depth = 0.0;  ///< 0: the floor is one plane, with gutters drawn on it
  bool kick_backs = false;
  bool masking_panel = false;
  double masking_low = 0.85;   ///< lower edge of the panel that hangs before the skittles
  std::vector<Vec2> spots;     ///< of the skittles, from the head pin's: x right, y away
  std::vector<OiledArea> oil;  ///< none where the lane has no oil
  double dry = 0.0;            ///< friction of the lane beside the oil

  /// Outer edge of the right gutter; of the lane, where there is none.
  double gutter_edge() const { return 0.5 * lane_width + gutter_width; }
  /// How far each side of a gutter slopes in, down to its flat bottom.
  double gutter_slope() const { return 0.25 * gutter_width; }
  /// The kick-backs' sides that face the skittles.
  double kick_back_side() const { return gutter_edge() + 0.06; }
  /// Where the masking panel hangs and the kick-backs begin.
  double portal() const;
  /// Where the skittles' part of the lane begins, which no oil pattern covers.
  double deck_begin() const { return head_pin - 0.1; }
};

RoomMeasures room_measures(const Scenario& scenario);

/// A convex prism along y.
struct Slab {
  double begin, end;          ///< of it, along y
  std::vector<Vec2> section;  ///< (x, z), counterclockwise seen along +y
};

/// A floor at z = 0 beside gutters that have depth: one object of one or two slabs.
struct Floor {
  const char* name;
  std::vector<Slab> slabs;
};

/// The lane, and the approach and floor left and right of it beyond the gutters. The lane is one
/// slab from wall to wall, so a rolling body meets no seam.
std::vector<Floor> floors(const RoomMeasures& room);

/// A solid with its sides along the world's axes, by two opposite corners.
struct Block {
  const char* name;
  Vec3 low_W, high_W;
};

/// The parts around the skittles that the lane has: the left and the right kick-back, and the
/// masking panel between them. They are drawn as they collide.
std::vector<Block> front_blocks(const RoomMeasures& room);

}  // namespace headpin::scene
