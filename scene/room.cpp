#include "scene/room.h"

#include <algorithm>

namespace headpin::scene {

double RoomMeasures::portal() const {
  return head_pin - 0.35;
}

RoomMeasures room_measures(const Scenario& scenario) {
  RoomMeasures room;
  room.width = scenario.room.width;
  room.height = scenario.room.height;
  room.behind = scenario.room.behind;
  room.ahead = scenario.room.ahead;
  room.lane_width = scenario.lane.width;
  room.head_pin = scenario.lane.head_pin;
  room.spots = scenario.rack.spots;
  double last_row = 0.0;
  for (const Vec2& spot : room.spots) last_row = std::max(last_row, spot.y());
  room.deck_end = std::min(room.head_pin + last_row + 0.25, room.ahead);
  room.masking_low = 2.2 * scenario.skittle.height;
  return room;
}

std::vector<Block> front_blocks(const RoomMeasures& room) {
  const double inner = room.gutter_edge() + 0.06, outer = inner + 0.08;
  const double y = room.portal(), low = room.masking_low;
  return {{"left kick-back", {-outer, y, 0.0}, {-inner, room.ahead, low}},
          {"right kick-back", {inner, y, 0.0}, {outer, room.ahead, low}},
          {"masking panel", {-outer, y, low}, {outer, y + 0.10, low + 0.62}}};
}

}  // namespace headpin::scene
