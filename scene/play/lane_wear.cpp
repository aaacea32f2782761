#include "scene/play/lane_wear.h"

#include <algorithm>

namespace headpin::scene {

namespace {

constexpr double kTrack = 0.006;     // width of the contact of ball and lane: ours [m]
constexpr double kComesOff = 1.524;  // 5 ft: a ball loses its oil as if within this: ours [m]

/// The part of the way from `from` to `to` that lies between two edges, as a range of x.
std::pair<double, double> across(const Vec2& from, const Vec2& to, double low, double high) {
  const double length = to.y() - from.y();
  double a = from.x(), b = to.x();
  if (length > 0.0) {
    const double slope = (to.x() - from.x()) / length;
    a = from.x() + slope * (std::max(low, from.y()) - from.y());
    b = from.x() + slope * (std::min(high, to.y()) - from.y());
  }
  return std::minmax(a, b);
}

/// Cells of one row that a ball touched together.
struct TouchedRow {
  std::span<const std::uint32_t> cells;
  double length;  ///< of the row [m]
};

/// Thins the oil of the cells. @return  what the ball takes: friction that the oil took away, times
/// length, of a board in the mean [m]
double take_oil(engine::FrictionTable& lane, const TouchedRow& row, const Oil& oil) {
  double taken = 0.0;
  for (const std::uint32_t cell : row.cells) {
    double& friction = lane.friction[cell];
    const double thinned = oil.dry + (friction - oil.dry) * (1.0 - oil.wear);
    taken += std::max(0.0, thinned - friction) * row.length;
    friction = thinned;
  }
  return taken / static_cast<double>(row.cells.size());
}

/// Lays oil down on cells that are dry on a fresh lane. @return  how much, as above
double lay_oil(engine::FrictionTable& lane, const engine::FrictionTable& fresh,
               const TouchedRow& row, double on_ball, const Oil& oil) {
  const double least = *std::min_element(fresh.friction.begin(), fresh.friction.end());
  const double share = std::min(1.0, row.length / kComesOff);
  double laid = 0.0;
  for (const std::uint32_t cell : row.cells) {
    double& friction = lane.friction[cell];
    if (fresh.friction[cell] < oil.dry) continue;
    const double oiled = std::max(least, friction - on_ball * share / row.length);
    laid += std::max(0.0, friction - oiled) * row.length;
    friction = std::min(friction, oiled);
  }
  return laid / static_cast<double>(row.cells.size());
}

}  // namespace

void add_way(TouchedCells& touched, const engine::FrictionTable& lane, const Vec2& from,
             const Vec2& to) {
  if (to.y() < from.y()) return add_way(touched, lane, to, from);
  const double first = std::max(from.y(), lane.edges.front());
  for (auto row = engine::row_at(lane, first);
       row && *row + 1 < lane.edges.size() && lane.edges[*row] <= to.y(); ++*row) {
    const auto [low, high] = across(from, to, lane.edges[*row], lane.edges[*row + 1]);
    const double left = (low - 0.5 * kTrack - lane.low_x) / lane.width;
    const double right = (high + 0.5 * kTrack - lane.low_x) / lane.width;
    const double columns = static_cast<double>(lane.columns);
    if (!(right >= 0.0 && left < columns)) continue;
    const auto begin = static_cast<std::size_t>(std::max(0.0, left));
    const auto end = static_cast<std::size_t>(std::min(columns - 1.0, right)) + 1;
    for (std::size_t column = begin; column < end; ++column) {
      const auto cell = static_cast<std::uint32_t>(*row * lane.columns + column);
      if (std::ranges::find(touched, cell) == touched.end()) touched.push_back(cell);
    }
  }
}

engine::FrictionTable worn(engine::FrictionTable lane, const engine::FrictionTable& fresh,
                           const TouchedCells& touched, const Oil& oil) {
  double on_ball = 0.0;
  for (std::size_t i = 0; i < touched.size();) {
    const std::size_t row = touched[i] / lane.columns;
    std::size_t end = i;
    while (end < touched.size() && touched[end] / lane.columns == row) ++end;
    const TouchedRow part{std::span(touched).subspan(i, end - i),
                          lane.edges[row + 1] - lane.edges[row]};
    on_ball += oil.carry_down * take_oil(lane, part, oil);
    on_ball -= lay_oil(lane, fresh, part, on_ball, oil);
    i = end;
  }
  return lane;
}

const engine::FrictionTable& lane_of(const engine::World& world, const Stage& stage) {
  const auto& table = world.bodies[stage.lane].table;
  return table ? *table : *stage.fresh_lane;
}

void wear_lane(engine::World& world, const Stage& stage, const TouchedCells& touched) {
  if (!stage.fresh_lane || touched.empty()) return;
  engine::set_friction(
      world, stage.lane,
      std::make_shared<const engine::FrictionTable>(
          worn(lane_of(world, stage), *stage.fresh_lane, touched, stage.scenario.lane.oil)));
}

void take_over_wear(engine::World& world, const Stage& stage, const engine::World& from,
                    const Stage& before) {
  if (!stage.fresh_lane || !before.fresh_lane || *stage.fresh_lane != *before.fresh_lane) return;
  engine::set_friction(world, stage.lane, from.bodies[before.lane].table);
}

}  // namespace headpin::scene
