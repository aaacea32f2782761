#include <algorithm>
#include <stdexcept>
#include <string>

#include "engine/books.h"
#include "engine/stages.h"

namespace headpin::engine {
namespace {

void apply_gravity(World& world, const detail::Flight& flight, Workspace& w) {
  const Vec3& g = world.parameters.gravity_W;
  const Vec3 dv = step_seconds(world) * g;
  detail::each_mover(world, w, [&](BodyId i) { world.states[i].v_WB += dv; });
  for (const auto& [i, state] : flight.struck) {  // they have already fallen until their impact
    world.states[i].v_WB -= flight.bodies[i].clock * g;
  }
}

/// A step of a world in which nothing moves: it has no contacts.
void let_rest(Memory& memory) {
  memory.candidates.clear();
  memory.normals.clear();
  memory.touches.clear();
  memory.loads.clear();
}

struct Met {
  detail::Touches& touches;
  const detail::Flight& flight;
};

/// Touches and impacts; found again while an impact wakes a body.
Met meet(World& world, Workspace& w) {
  w.touches.queries = {};
  w.crew.use(std::clamp(world.parameters.threads, 1, kMostThreads));
  w.each_thread.resize(w.crew.threads());
  for (detail::Touches& part : w.touch_parts) part.queries = {};
  for (detail::ThreadBuffers& t : w.each_thread) t.at_end.queries = {};
  for (;;) {
    detail::Touches& touches = detail::find_touches(world, w);
    const detail::Flight* flight = detail::resolve_impacts(world, touches, w);
    if (!flight) continue;
    world.statistics.queries = touches.queries;
    return {touches, *flight};
  }
}

void stop_if_not_finite(const World& world) {
  for (const BodyId i : world.roll.movers) {
    const State& s = world.states[i];
    const double sum = s.X_WB.p.sum() + s.X_WB.q.coeffs().sum() + s.v_WB.sum() + s.w_WB.sum();
    if (std::isfinite(sum)) continue;
    throw std::runtime_error("tick " + std::to_string(world.tick) + ": " + detail::title(world, i) +
                             " is no longer at a finite place or speed");
  }
}

}  // namespace

Statistics& Statistics::operator+=(const Statistics& other) {
  steps += other.steps;
  pairs += other.pairs;
  contacts += other.contacts;
  queries += other.queries;
  impacts += other.impacts;
  unfinished_impacts += other.unfinished_impacts;
  pulls += other.pulls;
  islands += other.islands;
  solver_iterations += other.solver_iterations;
  unsolved += other.unsolved;
  residual = std::max(residual, other.residual);
  deepest_overlap = std::max(deepest_overlap, other.deepest_overlap);
  awake += other.awake;
  return *this;
}

void step(World& world, Workspace& w) {
  using namespace detail;
  world.events.clear();
  world.statistics = {};
  world.statistics.steps = 1;
  const bool changed = know_roll(world);
  Books books(world, w, changed);
  if (world.roll.movers.empty() && world.roll.driven.empty()) {
    let_rest(world.memory);
    ++world.tick;
    return;
  }
  const auto [touches, flight] = meet(world, w);
  books.book_impacts();
  apply_gravity(world, flight, w);
  books.begin();
  Solved& solved = sustain(world, touches, flight, w);
  stop_swings(world, touches, flight, solved, w);
  books.end(world.ledger.sustained);
  move(world, flight, solved, w);
  stop_if_not_finite(world);
  books.begin();
  push_apart(world, touches, flight, solved, w);
  books.end(world.ledger.correction);
  fall_asleep(world, touches, flight, solved);
  books.end(world.ledger.sustained);
  books.close();
  remember(world, touches, flight, solved, w);
  for (const ThreadBuffers& t : w.each_thread) world.statistics.queries += t.at_end.queries;
  ++world.tick;
}

void step(World& world) {
  Workspace w;
  step(world, w);
}

}  // namespace headpin::engine
