#include "scene/stage/oil_table.h"

#include <algorithm>

namespace headpin::scene {

namespace {

constexpr double kFoot = 0.3048;

std::vector<double> edges_of_rows(const RoomMeasures& room) {
  std::vector<double> edges{0.0, room.deck_begin()};
  for (int foot = 1; foot * kFoot < room.deck_begin(); ++foot) edges.push_back(foot * kFoot);
  for (const OiledArea& area : room.oil) {
    edges.insert(edges.end(), {area.low.y(), area.high.y()});
  }
  std::ranges::sort(edges);
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

double friction_of(const RoomMeasures& room, const Vec2& p) {
  for (const OiledArea& area : room.oil) {
    const bool inside = p.x() >= area.low.x() && p.x() < area.high.x() && p.y() >= area.low.y() &&
                        p.y() < area.high.y();
    if (inside) return area.friction;
  }
  return room.dry;
}

}  // namespace

engine::FrictionTable oil_table(const RoomMeasures& room) {
  engine::FrictionTable table;
  table.low_x = -0.5 * room.lane_width;
  table.width = room.lane_width / kBoards;
  table.columns = kBoards;
  table.edges = edges_of_rows(room);
  for (std::size_t row = 0; row + 1 < table.edges.size(); ++row) {
    const double y = 0.5 * (table.edges[row] + table.edges[row + 1]);
    for (int column = 0; column < kBoards; ++column) {
      table.friction.push_back(friction_of(room, {table.low_x + (column + 0.5) * table.width, y}));
    }
  }
  return table;
}

}  // namespace headpin::scene
