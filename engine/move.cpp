#include <algorithm>
#include <cmath>

#include "engine/stages.h"

namespace headpin::engine::detail {
namespace {

/// The part of n across gravity.
Vec3 level(const Vec3& n, const Vec3& gravity) {
  const double g2 = gravity.squaredNorm();
  return g2 > 0.0 ? Vec3(n - n.dot(gravity) / g2 * gravity) : n;
}

}  // namespace

void move(World& world) {
  Scratch& s = world.scratch;
  const double dt = step_seconds(world);
  for (const BodyId i : s.movers) {
    State& state = world.states[i];
    const double left = dt - s.clock[i];
    // Velocities are those at the end. A free body fell with their mean; one that is carried moves
    // with the end velocity, as its contacts were solved for; one that is held in part goes between,
    // which is where its energy stays what it was.
    const double falls = 1.0 - s.carried[i];
    state.X_WB.p += left * state.v_WB;
    if (falls > 0.0) state.X_WB.p -= (0.5 * falls * left * left) * world.parameters.gravity_W;
    turn_freely(state.X_WB.q, state.w_WB, world.inertias[i], left);
  }
  for (const BodyId i : s.driven) {
    State& state = world.states[i];
    state.X_WB.p += dt * state.v_WB;
    state.X_WB.q = (rotation(dt * state.w_WB) * state.X_WB.q).normalized();
  }
}

void push_apart(World& world) {
  Scratch& s = world.scratch;
  const Parameters& p = world.parameters;
  double part = 0.0;  // of an overlap that is taken back: as much in a given time at every rate
  s.nudged.clear();
  const auto note = [&](BodyId i) {
    if (s.nudge_p[i].isZero(0.0) && s.nudge_w[i].isZero(0.0)) s.nudged.push_back(i);
  };
  for (const Touch& touch : s.touches) {
    for (std::uint32_t k = 0; k < touch.rows; ++k) {
      const ContactPoint& point = s.points[touch.first_point + k];
      world.statistics.deepest_overlap = std::max(world.statistics.deepest_overlap, point.depth);
      if (point.depth <= p.slop) continue;
      if (part == 0.0) part = 1.0 - power(1.0 - p.push, 240.0 / p.rate_hz);
      const NormalRow& row = s.rows[touch.first_row + k];
      const Mobility &ma = s.mobility[touch.a], &mb = s.mobility[touch.b];
      // What the nudges before have already taken back counts.
      double apart = -row.n.dot(s.nudge_p[touch.a]) - row.ra_n.dot(s.nudge_w[touch.a]);
      if (touch.b_moves) {
        apart += row.n.dot(s.nudge_p[touch.b]) + row.rb_n.dot(s.nudge_w[touch.b]);
      }
      const double more = row.mass * (part * (point.depth - p.slop) - apart);
      if (more <= 0.0) continue;
      // A guessed depth pushes level and turns nothing: so it cannot add energy.
      const Vec3 n = point.guessed ? level(row.n, p.gravity_W) : row.n;
      const double turn = point.guessed ? 0.0 : more;
      note(touch.a);
      s.nudge_p[touch.a] -= more * ma.inv_mass * n;
      s.nudge_w[touch.a] -= turn * row.ia;
      if (!touch.b_moves) continue;
      note(touch.b);
      s.nudge_p[touch.b] += more * mb.inv_mass * n;
      s.nudge_w[touch.b] += turn * row.ib;
    }
  }
  for (const BodyId i : s.nudged) {
    Pose& X_WB = world.states[i].X_WB;
    X_WB.p += s.nudge_p[i];
    X_WB.q = (rotation(s.nudge_w[i]) * X_WB.q).normalized();
    s.nudge_p[i] = s.nudge_w[i] = Vec3::Zero();
  }
}

void fall_asleep(World& world) {
  Scratch& s = world.scratch;
  const Parameters& p = world.parameters;
  if (!p.sleep) return;
  const auto enough = static_cast<std::int32_t>(std::ceil(p.sleep_after * p.rate_hz));
  const double speed2 = p.sleep_speed * p.sleep_speed, spin2 = p.sleep_spin * p.sleep_spin;
  bool any = false;
  for (const BodyId i : s.movers) {
    const State& state = world.states[i];
    const bool still = state.v_WB.squaredNorm() < speed2 && state.w_WB.squaredNorm() < spin2;
    world.still[i] = still ? world.still[i] + 1 : 0;
    any |= world.still[i] >= enough;
  }
  if (!any) return;
  // An island sleeps when its liveliest body has been still for long enough.
  std::vector<std::int32_t>& calm = s.island_calm;
  for (const BodyId i : s.movers) calm[i] = enough;
  for (const BodyId i : s.movers) {
    std::int32_t& c = calm[island_root(s.parent, i)];
    c = std::min(c, world.still[i]);
  }
  for (const BodyId i : s.movers) {
    const BodyId root = island_root(s.parent, i);
    if (calm[root] < enough) continue;
    world.states[i].v_WB = world.states[i].w_WB = Vec3::Zero();
    world.asleep[i] = 1;
    if (i != root) std::swap(world.sleeps_with[i], world.sleeps_with[root]);  // joins the ring
    s.stale = true;
  }
}

}  // namespace headpin::engine::detail
