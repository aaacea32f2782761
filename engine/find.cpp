#include <algorithm>
#include <utility>

#include "engine/inlining.h"
#include "engine/meeting.h"
#include "engine/stages.h"

namespace headpin::engine::detail {
namespace {

constexpr double kWakeSpeed = 1e-3;  // approach that counts as moving [m/s]
constexpr double kWakeDepth = 1e-3;  // overlap that wakes a body at any speed [m]

/// Adds a candidate, with the normals that the same pair had after the last step, if any.
/// @param last  the first candidate of the last step that may be the same pair; moves forward
HEADPIN_INLINE inline void add_known(const World& world, std::uint64_t key, BodyId a, BodyId b,
                                     std::size_t& last, Touches& touches) {
  const Memory& m = world.memory;
  while (last < m.candidates.size() && m.candidates[last].key < key) ++last;
  if (last == m.candidates.size() || m.candidates[last].key != key) {
    add_candidate(world, key, a, b, touches);
    return;
  }
  const std::uint32_t count = m.candidates[last].normals;
  const auto from = m.normals.begin() + m.candidates[last].first_normal;
  touches.candidates.push_back(
      {key, a, b, static_cast<std::uint32_t>(touches.normals.size()), count});
  if (count > 0) touches.normals.insert(touches.normals.end(), from, from + count);
}

/// Whether the two really meet within the step, and do not merely pass each other.
bool really_touch(World& world, const Flight& flight, Touches& touches, Touch touch) {
  for (const ContactPoint& p : points_of(touches, touch)) {
    if (p.depth > kWakeDepth) return true;
  }
  const std::size_t count = touches.points.size();
  const bool meet = find_meeting(world, flight, touches, touch, kWakeSpeed).has_value();
  touches.points.resize(count);
  return meet;
}

/// Whether the body that a sleeping body touches moves, in any direction: its support may go away.
bool is_being_left(const World& world, const Flight& flight, const Touches& touches,
                   const Touch& touch, BodyId sleeper) {
  const BodyId other = sleeper == touch.a ? touch.b : touch.a;
  const State& state = world.states[other];
  const bool driven = world.bodies[other].kind == Kind::driven;
  const double still = driven ? 0.0 : world.parameters.sleep_speed;
  if (flight.bodies[other].top_speed <= still) return false;
  for (const ContactPoint& p : points_of(touches, touch)) {
    if (p.depth < -kRests) continue;
    if (velocity_at(state, p.p_W - state.X_WB.p).norm() > still) return true;
  }
  return false;
}

/// Whether a body cannot meet a half-space within the step, with some room for rounding.
bool is_above(const Capsule& bounds_W, const Plane& plane) {
  const double low = std::min(plane.up.dot(bounds_W.a), plane.up.dot(bounds_W.b));
  return low - plane.height > bounds_W.radius + 2.0 * kMargin;
}

/// Finds candidates: pairs whose bounds meet. The bounds are widened by the distance that a body
/// can move within the step.
void find_pairs(World& world, const Flight& flight, Workspace& w) {
  const double dt = step_seconds(world);
  Roll& roll = world.roll;
  for (std::size_t k = 0; k < roll.bounded.size(); ++k) {
    if (!roll.moving[k]) continue;
    const BodyId i = roll.bounded[k];
    roll.bounds_W[k] = world.states[i].X_WB * world.bodies[i].shape->bounds;
    roll.bounds_W[k].radius += flight.bodies[i].top_speed * dt + flight.fall;
  }
  Touches& touches = w.touches;
  touches.candidates.clear();
  touches.normals.clear();
  world.statistics.pairs = 0;  // they are found again where a body wakes
  std::size_t last = 0;
  for (std::size_t k = 0; k < roll.bounded.size(); ++k) {
    const BodyId i = roll.bounded[k];
    if (!is_mover(world, i)) continue;
    for (std::size_t n = 0; n < roll.unbounded.size(); ++n) {
      if (is_above(roll.bounds_W[k], roll.planes_W[n])) continue;
      const BodyId wall = roll.unbounded[n];
      add_known(world, key_of(false, i, wall), i, wall, last, touches);
    }
  }
  for (const Pair& pair :
       w.broad_phase.find_pairs(roll.bounds_W, roll.moving, kMargin, roll.limits_W)) {
    const BodyId a = roll.bounded[pair.first], b = roll.bounded[pair.second];
    if (world.bodies[a].kind != Kind::free && world.bodies[b].kind != Kind::free) continue;
    add_known(world, key_of(true, a, b), a, b, last, touches);
    ++world.statistics.pairs;
  }
  touches.early_candidates = touches.candidates.size();
}

/// Takes over the data of the same touch in the last step, if there was one.
/// @param last  the first touch of the last step that may be the same pair; moves forward
void recall(const World& world, Touch& touch, std::size_t& last) {
  const Memory& m = world.memory;
  const auto order = [](const auto& t) { return std::pair(t.key, t.part); };
  while (last < m.touches.size() && order(m.touches[last]) < order(touch)) ++last;
  touch.fresh = last == m.touches.size() || order(m.touches[last]) != order(touch);
  touch.last = static_cast<std::uint32_t>(last);
  touch.met = !touch.fresh && m.touches[last].met;
  if (!touch.fresh && touch.b_driven) {
    touch.pressed = m.touches[last].struck || was_loaded(m, touch);
  }
  if (!touch.fresh && m.touches[last].friction == touch.pair.friction) {
    touch.sliding = m.touches[last].sliding;
  } else {
    touch.sliding = sliding_of(world, touch);
  }
}

/// Finds the touches of the candidates. @return whether a body woke up: then all must be found
/// again
bool test_candidates(World& world, const Flight& flight, Touches& touches) {
  bool woken = false;
  touches.all.clear();
  touches.points.clear();
  std::size_t last = 0;
  for (std::uint32_t k = 0; k < touches.candidates.size(); ++k) {
    const std::size_t had = touches.all.size(), points = touches.points.size();
    std::size_t count = add_touches(world, flight, k, 0.0, touches);
    count += look_ahead(world, flight, k, 0.0, had, touches);
    if (count == 0) continue;
    for (std::size_t n = had; n < had + count; ++n) {
      const Touch touch = touches.all[n];
      for (const BodyId sleeper : {touch.a, touch.b}) {
        if (world.asleep[sleeper] && (is_being_left(world, flight, touches, touch, sleeper) ||
                                      really_touch(world, flight, touches, touch))) {
          wake(world, sleeper);
          woken = true;
        }
      }
    }
    if (!is_mover(world, touches.all[had].a) || woken) {
      touches.points.resize(points);
      touches.all.resize(had);
      continue;
    }
    for (std::size_t n = had; n < had + count; ++n) recall(world, touches.all[n], last);
  }
  touches.early = touches.all.size();
  return woken;
}

}  // namespace

Touches& find_touches(World& world, Workspace& w) {
  do {
    depart(world, w.flight);
    find_pairs(world, w.flight, w);
  } while (test_candidates(world, w.flight, w.touches));
  return w.touches;
}

}  // namespace headpin::engine::detail
