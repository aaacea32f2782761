#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "base/random.h"
#include "engine/workspace.h"
#include "scene/play/game.h"
#include "scene/scenario/scenario.h"
#include "scene/stage/room.h"
#include "scene/stage/stage.h"

/// A ball that rolls into a rack of ten, for what is published about pins and balls. Boards count from
/// the right gutter, 20 is the middle; angles are to the left, as a right-hander's ball comes in.
namespace headpin::scene {

struct Rolling {
  double board = 17.5;  ///< of its centre when it touches the head pin
  double angle_deg = 6.0;
  double speed = 7.6;        ///< [m/s]
  double spot_off = 0.0008;  ///< deviation of each pin from its spot, along x and y [m]
};

struct Fallen {
  std::vector<int> standing;  ///< numbers of the pins, 1 to 10
  std::vector<int> touched;   ///< by the ball, in the order of first touch
  double exit_board = 0.0;    ///< where the ball left the deck; 0 if it did not
  bool strike() const { return standing.empty(); }
};

/// "10", "4-7", "strike".
inline std::string name_of_leave(const std::vector<int>& standing) {
  std::string name;
  for (const int pin : standing) name += (name.empty() ? "" : "-") + std::to_string(pin);
  return name.empty() ? "strike" : name;
}

/// The board at a place across the lane, and the place of a board's middle [m].
inline double board_at(const Lane& lane, double x) {
  return (0.5 * lane.width - x) / (lane.width / kBoards) + 0.5;
}
inline double middle_of_board(const Lane& lane, double board) {
  return 0.5 * lane.width - (board - 0.5) * lane.width / kBoards;
}

/// Puts every pin near its spot.
inline void set_pins(const Stage& stage, engine::World& world, double off, Random& random) {
  for (const engine::BodyId pin : stage.skittles) {
    engine::State state = stage.world.states[pin];
    state.X_WB.p += off * Vec3(random.normal(), random.normal(), 0.0);
    engine::set_state(world, pin, state);
    engine::put_to_sleep(world, pin);
  }
}

inline void set_rolling(const Stage& stage, engine::World& world, const Rolling& rolling) {
  const Scenario& s = stage.scenario;
  constexpr double kBefore = 0.4;  // the touch [m]
  const double r = s.ball.radius, reach = r + stage.widest_skittle;
  const double x = middle_of_board(s.lane, rolling.board);
  const double y = s.lane.head_pin - std::sqrt(std::max(0.0, reach * reach - x * x));
  const SinCos turn = sin_cos(rolling.angle_deg * std::numbers::pi / 180.0);
  const Vec3 ahead(-turn.sin, turn.cos, 0.0);
  engine::State state;
  state.X_WB.p = Vec3(x, y, r) - kBefore * ahead;
  state.v_WB = rolling.speed * ahead;
  state.w_WB = Vec3::UnitZ().cross(state.v_WB) / r;
  engine::set_kind(world, stage.balls.front(), engine::Kind::free);
  engine::set_state(world, stage.balls.front(), state);
}

/// Rolls the ball until all rest, 6 s at most. A ball that left the deck falls into the pit: it is
/// taken away.
inline Fallen roll(const Stage& stage, const Rolling& rolling, Random random) {
  engine::World world = stage.world;
  engine::Workspace workspace;
  set_pins(stage, world, rolling.spot_off, random);
  set_rolling(stage, world, rolling);
  const engine::BodyId ball = stage.balls.front();
  const double deck_end = room_measures(stage.scenario).deck_end;
  Fallen fallen;
  const std::int64_t most = 6 * world.parameters.rate_hz;
  while (world.tick < most && (world.statistics.awake > 0 || world.tick == 0)) {
    engine::step(world, workspace);
    for (const engine::ContactEvent& event : world.events) {
      if (!event.first || (event.a != ball && event.b != ball)) continue;
      const engine::BodyId other = event.a == ball ? event.b : event.a;
      const auto pin = std::find(stage.skittles.begin(), stage.skittles.end(), other);
      if (pin == stage.skittles.end()) continue;
      fallen.touched.push_back(static_cast<int>(pin - stage.skittles.begin()) + 1);
    }
    const Vec3& p = world.states[ball].X_WB.p;
    if (fallen.exit_board == 0.0 && p.y() > deck_end) {
      fallen.exit_board = board_at(stage.scenario.lane, p.x());
      engine::set_kind(world, ball, engine::Kind::driven);
      engine::set_state(world, ball, stage.world.states[ball]);
    }
  }
  for (std::size_t k = 0; k < stage.skittles.size(); ++k) {
    const Pose& X_WB = world.states[stage.skittles[k]].X_WB;
    const Vec3& spot = stage.world.states[stage.skittles[k]].X_WB.p;
    if (has_fallen(X_WB) || (X_WB.p - spot).head<2>().norm() > stage.scenario.game.off_spot)
      continue;
    fallen.standing.push_back(static_cast<int>(k) + 1);
  }
  return fallen;
}

}  // namespace headpin::scene
