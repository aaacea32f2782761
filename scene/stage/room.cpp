#include "scene/stage/room.h"

#include <algorithm>
#include <utility>

namespace headpin::scene {

namespace {

std::vector<OiledArea> oiled_areas(const Lane& lane) {
  std::vector<OiledArea> areas;
  const double board = lane.width / kBoards;
  for (const OilZone& zone : lane.oil.zones) {
    double low = 0.5 * lane.width - board * static_cast<double>(zone.last_board);
    double high = 0.5 * lane.width - board * static_cast<double>(zone.first_board - 1);
    if (lane.oil.mirrored) {
      low = -low;
      high = -high;
      std::swap(low, high);
    }
    areas.push_back({{low, zone.from}, {high, zone.to}, zone.friction});
  }
  return areas;
}

}  // namespace

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
  room.gutter_width = scenario.lane.gutter_width;
  room.gutter_depth = scenario.lane.gutter_depth;
  room.kick_backs = scenario.lane.kick_backs;
  room.masking_panel = scenario.lane.masking_panel;
  room.spots = scenario.rack.spots;
  room.oil = oiled_areas(scenario.lane);
  room.dry = scenario.lane.oil.dry;
  double last_row = 0.0;
  for (const Vec2& spot : room.spots) last_row = std::max(last_row, spot.y());
  room.deck_end = std::min(room.head_pin + last_row + 0.25, room.ahead);
  room.masking_low = 2.2 * scenario.skittle.height;
  return room;
}

std::vector<Floor> floors(const RoomMeasures& room) {
  constexpr double kBeyond = 0.1;  // into the walls [m]
  const double half = 0.5 * room.lane_width, edge = room.gutter_edge(), slope = room.gutter_slope();
  const double wall = 0.5 * room.width + kBeyond, depth = room.gutter_depth;
  const double under = -depth - 0.3;  // thick enough that nothing comes out below
  const double behind = -room.behind - kBeyond, ahead = room.ahead + kBeyond;
  const Slab lane{behind,
                  ahead,
                  {{-half, 0.0},
                   {-half - slope, -depth},
                   {-half - slope, under},
                   {half + slope, under},
                   {half + slope, -depth},
                   {half, 0.0}}};
  const Slab right_approach{behind, 0.0, {{half, 0.0}, {half, under}, {wall, under}, {wall, 0.0}}};
  const Slab right_side{
      0.0,
      ahead,
      {{edge, 0.0}, {edge - slope, -depth}, {edge - slope, under}, {wall, under}, {wall, 0.0}}};
  const auto mirrored = [](Slab slab) {
    for (Vec2& p : slab.section) p.x() = -p.x();
    std::ranges::reverse(slab.section);
    return slab;
  };
  return {{"lane", {lane}},
          {"left floor", {mirrored(right_approach), mirrored(right_side)}},
          {"right floor", {right_approach, right_side}}};
}

std::vector<Block> front_blocks(const RoomMeasures& room) {
  const double inner = room.kick_back_side(), outer = inner + 0.08;
  const double y = room.portal(), low = room.masking_low;
  std::vector<Block> blocks;
  if (room.kick_backs) {
    blocks.push_back({"left kick-back", {-outer, y, 0.0}, {-inner, room.ahead, low}});
    blocks.push_back({"right kick-back", {inner, y, 0.0}, {outer, room.ahead, low}});
  }
  if (room.masking_panel) {
    blocks.push_back({"masking panel", {-outer, y, low}, {outer, y + 0.10, low + 0.62}});
  }
  return blocks;
}

}  // namespace headpin::scene
