#include <algorithm>

#include "engine/at_end.h"
#include "engine/islands.h"
#include "engine/rules.h"
#include "engine/stages.h"

namespace headpin::engine::detail {
namespace {

constexpr int kRounds = 16;  // most points that are stopped in a touch

double time_left(const World& world, const Flight& flight, const Touch& touch) {
  return step_seconds(world) - std::max(flight.bodies[touch.a].clock, flight.bodies[touch.b].clock);
}

/// Whether the present points of a touch may be wrong at the end of the step: the bodies turn far,
/// or overlap deeply.
bool swings(const World& world, const Flight& flight, const Touch& touch, double depth) {
  const Vec3 spin = world.states[touch.a].w_WB - world.states[touch.b].w_WB;
  const double left = time_left(world, flight, touch);
  const bool may = spin.squaredNorm() * left * left > 0.99 * kFarTurn * kFarTurn;  // for rounding
  if (may && spin.norm() * left > kFarTurn) return true;
  return depth > deep_for(world, touch.a, touch.b);
}

/// Reduces the approach at a point of the end of the step until the bodies do not overlap there, by
/// at most the whole approach, so that energy is only removed. A driven body counts as standing
/// still: if it pushed a body that cannot give way in every step, that body would get faster and
/// faster.
/// @return whether the bodies approached
bool stop_at(World& world, const Flight& flight, Balance& pushed, const Touch& touch,
             const ContactPoint& point, const NormalRow& row) {
  const State &sa = world.states[touch.a], &sb = world.states[touch.b];
  const bool b_stands = !touch.b_moves && bounds_squeezes(world.parameters);
  const double b_nears = b_stands ? 0.0 : row.n.dot(sb.v_WB) + row.rb_n.dot(sb.w_WB);
  const double approach = row.n.dot(sa.v_WB) + row.ra_n.dot(sa.w_WB) - b_nears;
  if (approach <= 0.0) return false;
  const Pushed bodies{world.states.data(), flight.mobility.data()};
  const double j = row.mass * std::min(approach, point.depth / time_left(world, flight, touch));
  if (touch.b_moves) {
    push_by<Other::moving>(bodies, touch, row, j);
    return true;
  }
  push_by<Other::still>(bodies, touch, row, j);
  if (!touch.b_driven) return true;
  pushed.energy -= j * b_nears;
  pushed.momentum -= j * row.n;
  pushed.angular_momentum -= j * point.p_W.cross(row.n);
  return true;
}

void stop_swing(World& world, const Touches& touches, const Flight& flight, Solved& solved,
                std::uint32_t k, AtEnd& at_end, Balance& pushed) {
  const Touch& touch = touches.all[k];
  if (touch.points == 0) return;
  SolvedTouch& s = solved.touches[k];
  s.swings = swings(world, flight, touch, s.depth);
  for (int round = 0; s.swings && round < kRounds; ++round) {
    const Pose X_WA = pose_at_end(world, flight, solved, touch.a);
    const Pose X_WB = pose_at_end(world, flight, solved, touch.b);
    const ContactPoint* worst = nullptr;
    for (const ContactPoint& p : points_at_end(world, touches, touch, X_WA, X_WB, at_end)) {
      const double least = worst ? worst->depth : s.depth + world.parameters.slop;
      if (!p.guessed && p.depth > least) worst = &p;
    }
    if (!worst) break;
    const NormalRow row = row_at(flight, touch, *worst, X_WA.p, X_WB.p);
    if (!stop_at(world, flight, pushed, touch, *worst, row)) break;
  }
}

}  // namespace

void stop_swings(World& world, const Touches& touches, const Flight& flight, Solved& solved,
                 Workspace& w) {
  const auto stop = [&](std::uint32_t touch, std::size_t who) {
    stop_swing(world, touches, flight, solved, touch, w.each_thread[who].at_end, w.by_driven);
  };
  if (w.island_parts.size() == 1) {  // in the order in which the ledger has always had them
    for (std::uint32_t k = 0; k < touches.all.size(); ++k) stop(k, 0);
    return;
  }
  w.crew.share(w.island_parts.size(), [&](std::size_t k, std::size_t who) {
    for (const std::uint32_t touch : touches_of(solved.islands, w.island_parts[k]))
      stop(touch, who);
  });
}

}  // namespace headpin::engine::detail
