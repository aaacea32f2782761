#include <algorithm>
#include <utility>

#include "engine/next_impact.h"
#include "engine/stages.h"

namespace headpin::engine::detail {
namespace {

constexpr double kWakeSpeed = 1e-3;  // approach that counts as moving [m/s]
constexpr double kWakeDepth = 1e-3;  // overlap that wakes a body at any speed [m]

using Range = std::pair<std::size_t, std::size_t>;  ///< of candidates

/// Index of the first candidate or touch of the last step whose key is this one or a later one.
template <typename T>
std::size_t place_of(std::uint64_t key, const std::vector<T>& sorted) {
  const auto place =
      std::lower_bound(sorted.begin(), sorted.end(), key,
                       [](const T& t, std::uint64_t value) { return t.key < value; });
  return static_cast<std::size_t>(place - sorted.begin());
}

/// Gives candidates the normals that the same pairs had after the last step; to others, new ones.
void recall_normals(const World& world, const Range& range, Pairs& pairs) {
  const Memory& m = world.memory;
  auto last = m.candidates.begin() + static_cast<std::ptrdiff_t>(
                                         place_of(pairs.candidates[range.first].key, m.candidates));
  for (std::size_t k = range.first; k < range.second; ++k) {
    const Candidate& c = pairs.candidates[k];
    const std::span<KeptNormal> normals = normals_of(pairs, c);
    while (last != m.candidates.end() && last->key < c.key) ++last;
    if (last != m.candidates.end() && last->key == c.key) {
      std::copy_n(m.normals.begin() + last->first_normal, c.normals, normals.begin());
    } else {
      std::fill(normals.begin(), normals.end(), KeptNormal{});
    }
  }
}

/// Whether the two really meet within the step, and do not merely pass each other.
bool really_touch(const World& world, const Flight& flight, Touches& touches, Touch touch) {
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

/// Finds candidates: pairs whose bounds meet. The bounds are widened by the distance that a body
/// can move within the step.
void find_pairs(World& world, const Flight& flight, Workspace& w) {
  const double dt = step_seconds(world);
  Roll& roll = world.roll;
  w.crew.share_range(roll.bounded.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      if (!roll.moving[k]) continue;
      const BodyId i = roll.bounded[k];
      roll.bounds_W[k] = world.states[i].X_WB * world.bodies[i].shape->bounds;
      roll.bounds_W[k].radius += flight.bodies[i].top_speed * dt + flight.fall;
    }
  });
  Pairs& pairs = w.pairs;
  pairs.candidates.clear();
  for (std::size_t k = 0; k < roll.bounded.size(); ++k) {
    const BodyId i = roll.bounded[k];
    if (!is_mover(world, i)) continue;
    for (std::size_t n = 0; n < roll.unbounded.size(); ++n) {
      if (is_above(roll.bounds_W[k], roll.planes_W[n])) continue;
      const BodyId wall = roll.unbounded[n];
      add_candidate(world, key_of(false, i, wall), i, wall, pairs);
    }
  }
  const std::size_t walls = pairs.candidates.size();
  for (const Pair& pair :
       w.broad_phase.find_pairs(roll.bounds_W, roll.moving, kMargin, roll.limits_W, &w.crew)) {
    const BodyId a = roll.bounded[pair.first], b = roll.bounded[pair.second];
    if (world.bodies[a].kind != Kind::free && world.bodies[b].kind != Kind::free) continue;
    add_candidate(world, key_of(true, a, b), a, b, pairs);
  }
  pairs.early = pairs.candidates.size();
  world.statistics.pairs = static_cast<std::int64_t>(pairs.early - walls);
  pairs.normals.resize(end_of_normals(pairs));
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
    touch.sliding = sliding_of(world, touch.pair.friction);
  }
}

/// Finds the touches of the candidates.
void test_candidates(const World& world, const Flight& flight, const Range& range,
                     Touches& touches) {
  std::size_t last = place_of(touches.pairs->candidates[range.first].key, world.memory.touches);
  for (auto k = static_cast<std::uint32_t>(range.first); k < range.second; ++k) {
    const std::size_t had = touches.all.size(), points = touches.points.size();
    std::size_t count = add_touches(world, flight, k, 0.0, touches);
    count += look_ahead(world, flight, k, 0.0, had, touches);
    if (count == 0) continue;
    const Touch& first = touches.all[had];
    const bool sleeps = world.asleep[first.a] || world.asleep[first.b];
    if (sleeps) {
      touches.sleeping.insert(touches.sleeping.end(),
                              touches.all.begin() + static_cast<std::ptrdiff_t>(had),
                              touches.all.end());
    }
    if (!is_mover(world, first.a)) {
      if (!sleeps) touches.points.resize(points);
      touches.all.resize(had);
      continue;
    }
    for (std::size_t n = had; n < had + count; ++n) recall(world, touches.all[n], last);
  }
}

/// The range of the k-th part of the candidates.
Range range_of(const Workspace& w, std::size_t k) {
  return {k * w.pairs.early / w.parts, (k + 1) * w.pairs.early / w.parts};
}

void test_part(const World& world, Workspace& w, std::size_t k) {
  Touches& touches = w.part_of(k);
  touches.pairs = &w.pairs;
  touches.all.clear();
  touches.points.clear();
  touches.sleeping.clear();
  const Range range = range_of(w, k);
  if (range.first == range.second) return;
  recall_normals(world, range, w.pairs);
  test_candidates(world, w.flight, range, touches);
}

/// Where a part begins in the whole.
struct Offset {
  std::size_t all = 0, points = 0;
};

void copy_part(const Touches& part, const Offset& to, Touches& whole) {
  const auto points = static_cast<std::uint32_t>(to.points);
  for (std::size_t k = 0; k < part.all.size(); ++k) {
    Touch& touch = whole.all[to.all + k] = part.all[k];
    touch.first_point += points;
  }
  std::copy(part.points.begin(), part.points.end(), whole.points.data() + to.points);
  std::copy(part.due.begin(), part.due.end(), whole.due.data() + to.all);
}

/// Makes one list of the parts, each in its place.
void join(Workspace& w) {
  Touches& whole = w.touches;
  whole.pairs = &w.pairs;
  if (w.parts > 1) {
    std::vector<Offset> offsets(w.parts + 1);
    for (std::size_t k = 0; k < w.parts; ++k) {
      Touches& part = w.part_of(k);
      offsets[k + 1] = {offsets[k].all + part.all.size(), offsets[k].points + part.points.size()};
      whole.queries += std::exchange(part.queries, {});
    }
    whole.all.resize(offsets.back().all);
    whole.points.resize(offsets.back().points);
    whole.due.resize(offsets.back().all);
    w.crew.share(w.parts,
                 [&](std::size_t k, std::size_t) { copy_part(w.part_of(k), offsets[k], whole); });
  }
  whole.early = whole.all.size();
}

/// Wakes the sleeping bodies that are really touched, or whose support moves.
///
/// @return  whether there were any: then all must be found again
bool wake_sleepers(World& world, const Flight& flight, Touches& touches) {
  bool woken = false;
  for (const Touch& touch : touches.sleeping) {
    for (const BodyId i : {touch.a, touch.b}) {
      if (world.asleep[i] && (is_being_left(world, flight, touches, touch, i) ||
                              really_touch(world, flight, touches, touch))) {
        wake(world, i);
        woken = true;
      }
    }
  }
  return woken;
}

}  // namespace

Touches& find_touches(World& world, Workspace& w) {
  for (bool woken = true; woken;) {
    depart(world, w);
    find_pairs(world, w.flight, w);
    w.parts = w.crew.threads() < 2 ? 1 : std::max<std::size_t>(1, w.pairs.early / Crew::kRange);
    if (w.parts > w.touch_parts.size()) w.touch_parts.resize(w.parts);
    w.crew.share(w.parts, [&](std::size_t k, std::size_t) { test_part(world, w, k); });
    woken = false;
    for (std::size_t k = 0; k < w.parts; ++k) woken |= wake_sleepers(world, w.flight, w.part_of(k));
  }
  w.crew.share(w.parts, [&](std::size_t k, std::size_t) {
    note_next_impacts(world, w.flight, w.part_of(k));
  });
  join(w);
  return w.touches;
}

}  // namespace headpin::engine::detail
