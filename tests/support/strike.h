#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/random.h"
#include "engine/workspace.h"
#include "scene/play/ball_path.h"
#include "scene/play/game.h"
#include "scene/scenario/scenario.h"
#include "scene/stage/stage.h"

/// A ball that rolls into a rack of ten, for what is published about pins and balls. Boards count from
/// the right gutter, 20 is the middle; angles are to the left, as a right-hander's ball comes in.
namespace headpin::scene {

struct Rolling {
  double board = 17.5;  ///< where its way crosses the row of the head pin
  double angle_deg = 6.0;
  double speed = 7.6;        ///< [m/s]
  double spot_off = 0.0008;  ///< deviation of each pin from its spot, along x and y [m]
};

constexpr double kBefore = 0.6;  ///< from where it rolls to the row of the head pin [m]

struct Fallen {
  std::vector<int> standing;  ///< numbers of the pins, 1 to 10
  std::vector<int> touched;   ///< by the ball, in the order of first touch
  double exit_board = 0.0;    ///< where the ball left the deck; 0 if it did not
  bool strike() const { return standing.empty(); }
};

/// Where the middle of a board is across the lane [m].
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
  const double r = s.ball.radius;
  const Vec3 crossing(middle_of_board(s.lane, rolling.board), s.lane.head_pin, r);
  const SinCos turn = sin_cos(rolling.angle_deg * std::numbers::pi / 180.0);
  const Vec3 ahead(-turn.sin, turn.cos, 0.0);
  engine::State state;
  state.X_WB.p = crossing - kBefore * ahead;
  state.v_WB = rolling.speed * ahead;
  state.w_WB = Vec3::UnitZ().cross(state.v_WB) / r;
  engine::set_kind(world, stage.balls.front(), engine::Kind::free);
  engine::set_state(world, stage.balls.front(), state);
}

/// What leaves the deck behind falls into the pit: it is put far away from all others, asleep, so that it
/// costs no more.
inline void take_away(const Stage& stage, engine::World& world, engine::BodyId body) {
  engine::State state;
  state.X_WB.p = Vec3(static_cast<double>(body), stage.scenario.room.ahead + 10.0, 1.0);
  engine::set_state(world, body, state);
  engine::put_to_sleep(world, body);
}

/// The numbers of the pins that stand near their spots.
inline std::vector<int> standing(const Stage& stage, const engine::World& world) {
  std::vector<int> pins;
  for (std::size_t k = 0; k < stage.skittles.size(); ++k) {
    const Pose& X_WB = world.states[stage.skittles[k]].X_WB;
    const Vec3& spot = stage.world.states[stage.skittles[k]].X_WB.p;
    const bool moved = (X_WB.p - spot).head<2>().norm() > stage.scenario.game.off_spot;
    if (!moved && !has_fallen(X_WB)) pins.push_back(static_cast<int>(k) + 1);
  }
  return pins;
}

/// Notes the pins that the ball touched in a step.
inline void note_touched(const Stage& stage, const engine::World& world,
                         std::vector<int>& touched) {
  const engine::BodyId ball = stage.balls.front();
  for (const engine::ContactEvent& event : world.events) {
    if (!event.first || (event.a != ball && event.b != ball)) continue;
    const engine::BodyId other = event.a == ball ? event.b : event.a;
    const auto pin = std::find(stage.skittles.begin(), stage.skittles.end(), other);
    if (pin == stage.skittles.end()) continue;
    touched.push_back(static_cast<int>(pin - stage.skittles.begin()) + 1);
  }
}

/// The sweep of a pinsetter comes down [s] after the ball has reached the head pin. Of 8800 throws of
/// docs/pins.md no pin fell later than 3 s.
constexpr double kSweep = 3.5;

/// Rolls the ball until it is a strike, or all that is left on the lane rests, or the sweep comes.
inline Fallen roll(const Stage& stage, const Rolling& rolling, Random random) {
  engine::World world = stage.world;
  world.parameters.keep_ledger = false;
  engine::Workspace workspace;
  set_pins(stage, world, rolling.spot_off, random);
  set_rolling(stage, world, rolling);
  const engine::BodyId ball = stage.balls.front();
  const double end = kBefore / rolling.speed + kSweep;
  Fallen fallen;
  do {
    engine::step(world, workspace);
    note_touched(stage, world, fallen.touched);
    for (engine::BodyId body = 0; body < world.bodies.size(); ++body) {
      const Vec3 p = world.states[body].X_WB.p;
      if (world.bodies[body].kind != engine::Kind::free || p.y() < stage.room.deck_end) continue;
      if (engine::is_asleep(world, body)) continue;
      if (body == ball) fallen.exit_board = board_at(stage.room, p.x());
      take_away(stage, world, body);
    }
    fallen.standing = standing(stage, world);
    if (fallen.strike() && fallen.exit_board != 0.0) break;
  } while (engine::step_seconds(world) * static_cast<double>(world.tick) < end &&
           world.statistics.awake > 0);
  return fallen;
}

}  // namespace headpin::scene
