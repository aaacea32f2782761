#include <algorithm>
#include <cmath>

#include "engine/islands.h"
#include "engine/rules.h"
#include "engine/stages.h"

namespace headpin::engine::detail {
namespace {

/// Whether a body may fall asleep: contacts carry at least half of its weight. Without gravity,
/// only a body that does not move at all may.
bool may_rest(const World& world, const Solved& solved, BodyId i) {
  if (!sleepers_are_carried(world.parameters)) return true;
  if (!world.parameters.gravity_W.isZero(0.0)) return solved.carried[i] >= 0.5;
  const State& state = world.states[i];
  return state.v_WB.isZero(0.0) && state.w_WB.isZero(0.0);
}

/// Whether B of a touch is a driven body that moves and touches A.
bool is_on_the_move(const World& world, const Flight& flight, const Touch& touch, double depth) {
  if (!touch.b_driven) return false;
  if (!sleepers_are_carried(world.parameters)) return false;
  return flight.bodies[touch.b].top_speed > 0.0 && touch.points > 0 && depth >= -kRests;
}

}  // namespace

void fall_asleep(World& world, const Touches& touches, const Flight& flight, Solved& solved) {
  const Parameters& p = world.parameters;
  if (!p.sleep) return;
  const auto enough = static_cast<std::int32_t>(std::ceil(p.sleep_after * p.rate_hz));
  const double speed2 = p.sleep_speed * p.sleep_speed, spin2 = p.sleep_spin * p.sleep_spin;
  bool any = false;
  const std::vector<BodyId>& movers = world.roll.movers;
  std::vector<BodyMemory>& memory = world.memory.bodies;
  for (const BodyId i : movers) {
    const State& state = world.states[i];
    const bool still = state.v_WB.squaredNorm() < speed2 && state.w_WB.squaredNorm() < spin2;
    memory[i].still = still ? memory[i].still + 1 : 0;
    any |= memory[i].still >= enough;
  }
  if (!any) return;
  // An island falls asleep when every body in it has been still for long enough.
  std::vector<BodyId>& parent = solved.islands.parent;
  std::vector<std::int32_t>& calm = solved.islands.calm;
  calm.resize(world.bodies.size());
  for (const BodyId i : movers) calm[i] = enough;
  for (const BodyId i : movers) {
    std::int32_t& c = calm[island_root(parent, i)];
    c = may_rest(world, solved, i) ? std::min(c, memory[i].still) : 0;
  }
  for (std::size_t k = 0; k < touches.all.size(); ++k) {
    const Touch& touch = touches.all[k];
    if (!is_on_the_move(world, flight, touch, solved.touches[k].depth)) continue;
    calm[island_root(parent, touch.a)] = 0;
  }
  for (const BodyId i : movers) {
    const BodyId root = island_root(parent, i);
    if (calm[root] < enough) continue;
    world.states[i].v_WB = world.states[i].w_WB = Vec3::Zero();
    become(world, i, Kind::free, true);
    if (i != root) std::swap(memory[i].sleeps_with, memory[root].sleeps_with);  // joins the ring
  }
}

}  // namespace headpin::engine::detail
