#include <algorithm>

#include "engine/stages.h"

namespace headpin::engine::detail {
namespace {

constexpr double kMargin = 1e-3;     // gap at which resting bodies still have contact points [m]
constexpr double kWakeSpeed = 1e-3;  // approach that counts as moving [m/s]
constexpr double kWakeDepth = 1e-3;  // overlap that wakes whatever the speed [m]

void add_candidate(World& world, std::uint64_t key, BodyId a, BodyId b, std::size_t& last) {
  Scratch& s = world.scratch;
  const std::size_t count = cache_size(*world.bodies[a].shape, *world.bodies[b].shape);
  s.candidates.push_back(
      {key, a, b, static_cast<std::uint32_t>(s.normals.size()), static_cast<std::uint32_t>(count)});
  while (last < s.last_candidates.size() && s.last_candidates[last].key < key) ++last;
  if (last < s.last_candidates.size() && s.last_candidates[last].key == key) {
    const auto from = s.last_normals.begin() + s.last_candidates[last].first_normal;
    s.normals.insert(s.normals.end(), from, from + static_cast<std::ptrdiff_t>(count));
  } else {
    s.normals.resize(s.normals.size() + count, Vec3::Zero());
  }
}

/// Whether the two really meet within the step, and do not merely pass each other.
bool really_touch(World& world, Touch touch) {
  Scratch& s = world.scratch;
  for (std::uint32_t k = 0; k < touch.points; ++k) {
    if (s.points[touch.first_point + k].depth > kWakeDepth) return true;
  }
  const std::size_t count = s.points.size();
  const bool meet = find_meeting(world, touch, kWakeSpeed).has_value();
  s.points.resize(count);
  return meet;
}

/// Whether what a sleeper touches is moving, be it sideways or away: its support may be leaving.
bool is_being_left(const World& world, const Touch& touch, BodyId sleeper) {
  const BodyId other = sleeper == touch.a ? touch.b : touch.a;
  const State& state = world.states[other];
  const bool driven = world.bodies[other].kind == Kind::driven;
  const double still = driven ? 0.0 : world.parameters.sleep_speed;
  if (world.scratch.top_speed[other] <= still) return false;
  for (std::uint32_t k = 0; k < touch.points; ++k) {
    const ContactPoint& p = world.scratch.points[touch.first_point + k];
    if (p.depth < -kRests) continue;
    if (velocity_at(state, p.p_W - state.X_WB.p).norm() > still) return true;
  }
  return false;
}

}  // namespace

double reach(const World& world, BodyId a, BodyId b) {
  const Scratch& s = world.scratch;
  const double drift = (world.states[a].v_WB - world.states[b].v_WB).norm();
  return kMargin + (drift + s.swing[a] + s.swing[b]) * step_seconds(world) + s.fall;
}

int contacts_of(World& world, const Candidate& c, const Pose& X_WA, const Pose& X_WB,
                double margin) {
  Scratch& s = world.scratch;
  return find_contacts(*world.bodies[c.a].shape, X_WA, *world.bodies[c.b].shape, X_WB, margin,
                       std::span(s.normals).subspan(c.first_normal, c.normals),
                       world.parameters.query, world.statistics.queries, s.points);
}

void find_pairs(World& world) {
  Scratch& s = world.scratch;
  const double dt = step_seconds(world);
  s.fall = world.parameters.gravity_W.norm() * dt * dt;
  for (std::size_t k = 0; k < s.bounded.size(); ++k) {
    if (!s.moving[k]) continue;
    const BodyId i = s.bounded[k];
    s.bounds_W[k] = world.states[i].X_WB * world.bodies[i].shape->bounds;
    s.bounds_W[k].radius += s.top_speed[i] * dt + s.fall;
  }
  s.candidates.clear();
  s.normals.clear();
  std::size_t last = 0;
  for (const BodyId i : s.movers) {
    for (const BodyId wall : s.unbounded) {
      add_candidate(world, key_of(false, i, wall), i, wall, last);
    }
  }
  for (const Pair& pair : s.broad_phase.find_pairs(s.bounds_W, s.moving, kMargin)) {
    const BodyId a = s.bounded[pair.first], b = s.bounded[pair.second];
    if (world.bodies[a].kind != Kind::free && world.bodies[b].kind != Kind::free) continue;
    add_candidate(world, key_of(true, a, b), a, b, last);
    ++world.statistics.pairs;
  }
}

bool was_loaded(const Scratch& s, const Touch& touch) {
  if (touch.fresh) return false;
  const PastTouch& last = s.last_touches[touch.last];
  for (std::uint32_t n = 0; n < last.loads; ++n) {
    if (s.last_loads[last.first_load + n].impulse > 0.0) return true;
  }
  return false;
}

bool add_touch(World& world, std::uint32_t candidate, double t) {
  Scratch& s = world.scratch;
  const Candidate& c = s.candidates[candidate];
  const std::size_t first = s.points.size();
  const double margin = reach(world, c.a, c.b);
  Vec3 w_WA = world.states[c.a].w_WB, w_WB = world.states[c.b].w_WB;
  if (t == 0.0) {
    contacts_of(world, c, world.states[c.a].X_WB, world.states[c.b].X_WB, margin);
  } else {
    const State a = state_at(world, c.a, t), b = state_at(world, c.b, t);
    contacts_of(world, c, a.X_WB, b.X_WB, margin);
    w_WA = a.w_WB;
    w_WB = b.w_WB;
  }
  if (s.points.size() == first) return false;
  const bool a_moves = is_mover(world, c.a), b_moves = is_mover(world, c.b);
  const bool swapped = world.bodies[c.a].kind == Kind::fixed || (!a_moves && b_moves);
  Touch& touch = s.touches.emplace_back();
  touch.key = c.key;
  touch.a = swapped ? c.b : c.a;
  touch.b = swapped ? c.a : c.b;
  touch.b_moves = a_moves && b_moves;
  touch.candidate = candidate;
  touch.first_point = static_cast<std::uint32_t>(first);
  touch.points = static_cast<std::uint32_t>(s.points.size() - first);
  touch.time = t;
  touch.w_WA = swapped ? w_WB : w_WA;
  touch.w_WB = swapped ? w_WA : w_WB;
  touch.fresh = true;
  if (swapped) turn_normals(s, touch);
  const Material& ma = world.bodies[touch.a].material;
  const Material& mb = world.bodies[touch.b].material;
  touch.pair = {ma.elasticity * mb.elasticity, ma.friction * mb.friction};
  return true;
}

bool find_contacts(World& world) {
  Scratch& s = world.scratch;
  bool woken = false;
  s.touches.clear();
  s.points.clear();
  std::size_t last = 0;
  for (std::uint32_t k = 0; k < s.candidates.size(); ++k) {
    if (!add_touch(world, k, 0.0)) continue;
    Touch& touch = s.touches.back();
    for (const BodyId sleeper : {touch.a, touch.b}) {
      if (world.asleep[sleeper] &&
          (is_being_left(world, touch, sleeper) || really_touch(world, touch))) {
        wake(world, sleeper);
        woken = true;
      }
    }
    if (!is_mover(world, touch.a) || woken) {
      s.points.resize(touch.first_point);
      s.touches.pop_back();
      continue;
    }
    while (last < s.last_touches.size() && s.last_touches[last].key < touch.key) ++last;
    touch.fresh = last == s.last_touches.size() || s.last_touches[last].key != touch.key;
    touch.last = static_cast<std::uint32_t>(last);
    touch.met = !touch.fresh && s.last_touches[last].met;
    if (!touch.fresh && world.bodies[touch.b].kind == Kind::driven) {
      touch.pressed = s.last_touches[last].struck || was_loaded(s, touch);
    }
    if (!touch.fresh && s.last_touches[last].friction == touch.pair.friction) {
      touch.sliding = s.last_touches[last].sliding;
    } else {
      touch.sliding = world.response->sliding(touch.pair.friction, step_seconds(world),
                                              world.parameters.friction_tau);
    }
  }
  s.early_candidates = s.candidates.size();
  s.early_touches = s.touches.size();
  return woken;
}

}  // namespace headpin::engine::detail
