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

// Velocities are those at the end. A free body fell with their mean; one that is carried moves with
// the end velocity, as its contacts were solved for; one that is held in part goes between, which is
// where its energy stays what it was.
void move_to_end(const World& world, BodyId i, Pose& X_WB, Vec3& w_WB) {
  const Scratch& s = world.scratch;
  const double left = step_seconds(world) - s.clock[i];
  const double falls = 1.0 - s.carried[i];
  X_WB.p += left * world.states[i].v_WB;
  if (falls > 0.0) X_WB.p -= (0.5 * falls * left * left) * world.parameters.gravity_W;
  turn_freely(X_WB.q, w_WB, world.inertias[i], left);
}

void drive_to_end(const World& world, BodyId i, Pose& X_WB) {
  const State& state = world.states[i];
  const double dt = step_seconds(world);
  X_WB.p += dt * state.v_WB;
  X_WB.q = (rotation(dt * state.w_WB) * X_WB.q).normalized();
}

}  // namespace

Pose pose_at_end(const World& world, BodyId i) {
  State s = world.states[i];
  if (is_mover(world, i)) {
    move_to_end(world, i, s.X_WB, s.w_WB);
  } else if (world.bodies[i].kind == Kind::driven) {
    drive_to_end(world, i, s.X_WB);
  }
  return s.X_WB;
}

void move(World& world) {
  for (const BodyId i : world.scratch.movers) {
    move_to_end(world, i, world.states[i].X_WB, world.states[i].w_WB);
  }
  for (const BodyId i : world.scratch.driven) drive_to_end(world, i, world.states[i].X_WB);
}

namespace {

/// Whether the overlap is such that the way out says little: five times what is deep.
bool is_far_in(const World& world, const Touch& touch) {
  return touch.points > 0 && touch.depth > 5.0 * deep_for(world, touch.a, touch.b);
}

/// Notes what something driven holds that is pressed far into that or into anything else.
void find_pinned(World& world) {
  Scratch& s = world.scratch;
  s.pinned.clear();
  if (s.driven.empty() || world.parameters.rules < 2) return;
  for (const Touch& touch : s.touches) {
    if (touch.points == 0 || world.bodies[touch.b].kind != Kind::driven) continue;
    if (touch.depth > world.parameters.slop) s.pinned.push_back(touch.a);
  }
  std::erase_if(s.pinned, [&](BodyId i) {
    return std::none_of(s.touches.begin(), s.touches.end(), [&](const Touch& touch) {
      return (touch.a == i || touch.b == i) && is_far_in(world, touch);
    });
  });
}

bool is_pinned(const Scratch& s, const Touch& touch) {
  return std::any_of(s.pinned.begin(), s.pinned.end(),
                     [&](BodyId i) { return i == touch.a || i == touch.b; });
}

/// Nudges a touch's bodies out of an overlap, by what the nudges before have not yet taken back.
void nudge(World& world, const Touch& touch, const ContactPoint& point, const NormalRow& row,
           double part) {
  Scratch& s = world.scratch;
  const Mobility &ma = s.mobility[touch.a], &mb = s.mobility[touch.b];
  const auto note = [&](BodyId i) {
    if (s.nudge_p[i].isZero(0.0) && s.nudge_w[i].isZero(0.0)) s.nudged.push_back(i);
  };
  double apart = -row.n.dot(s.nudge_p[touch.a]) - row.ra_n.dot(s.nudge_w[touch.a]);
  if (touch.b_moves) {
    apart += row.n.dot(s.nudge_p[touch.b]) + row.rb_n.dot(s.nudge_w[touch.b]);
  }
  const double more = row.mass * (part * (point.depth - world.parameters.slop) - apart);
  if (more <= 0.0) return;
  // A guessed depth pushes level and turns nothing: so it cannot add energy. Nor does what is pinned
  // stand up on an edge, or rise out of what is driven, to fall from there.
  const bool pinned = is_pinned(s, touch);
  const bool flat = point.guessed || (pinned && world.bodies[touch.b].kind == Kind::driven);
  const Vec3 n = flat ? level(row.n, world.parameters.gravity_W) : row.n;
  const double turn = point.guessed || pinned ? 0.0 : more;
  note(touch.a);
  s.nudge_p[touch.a] -= more * ma.inv_mass * n;
  s.nudge_w[touch.a] -= turn * row.ia;
  if (!touch.b_moves) return;
  note(touch.b);
  s.nudge_p[touch.b] += more * mb.inv_mass * n;
  s.nudge_w[touch.b] += turn * row.ib;
}

}  // namespace

void push_apart(World& world) {
  Scratch& s = world.scratch;
  const Parameters& p = world.parameters;
  double part = 0.0;  // of an overlap that is taken back: as much in a given time at every rate
  s.nudged.clear();
  find_pinned(world);
  const auto take_back = [&](const Touch& touch, const ContactPoint& point, const NormalRow& row) {
    if (point.depth <= p.slop) return;
    if (part == 0.0) part = 1.0 - power(1.0 - p.push, 240.0 / p.rate_hz);
    nudge(world, touch, point, row, part);
  };
  for (const Touch& touch : s.touches) {
    if (touch.insists) continue;  // pushing would lift what cannot give way
    if (!touch.swings) {
      for (std::uint32_t k = 0; k < touch.deep; ++k) {
        const DeepRow& deep = s.deep_rows[touch.first_deep + k];
        take_back(touch, s.points[deep.point], deep.row);
      }
      continue;
    }
    const Pose &X_WA = world.states[touch.a].X_WB, &X_WB = world.states[touch.b].X_WB;
    for (const ContactPoint& point : points_at_end(world, touch, X_WA, X_WB)) {
      take_back(touch, point, row_at(world, touch, point, X_WA.p, X_WB.p));
    }
  }
  for (const BodyId i : s.nudged) {
    Pose& X_WB = world.states[i].X_WB;
    X_WB.p += s.nudge_p[i];
    X_WB.q = (rotation(s.nudge_w[i]) * X_WB.q).normalized();
    s.nudge_p[i] = s.nudge_w[i] = Vec3::Zero();
  }
}

namespace {

/// Whether a body may stop for good: it is carried. Without gravity nothing is; then only what does
/// not move at all.
bool may_rest(const World& world, BodyId i) {
  if (world.parameters.rules < 2) return true;
  if (!world.parameters.gravity_W.isZero(0.0)) return world.scratch.carried[i] >= 0.5;
  const State& state = world.states[i];
  return state.v_WB.isZero(0.0) && state.w_WB.isZero(0.0);
}

/// Whether a touch's B moves what lies on it.
bool is_on_the_move(const World& world, const Touch& touch) {
  if (world.bodies[touch.b].kind != Kind::driven || world.parameters.rules < 2) return false;
  return world.scratch.top_speed[touch.b] > 0.0 && touch.points > 0 && touch.depth >= -kRests;
}

}  // namespace

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
    c = may_rest(world, i) ? std::min(c, world.still[i]) : 0;
  }
  for (const Touch& touch : s.touches) {
    if (is_on_the_move(world, touch)) calm[island_root(s.parent, touch.a)] = 0;
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
