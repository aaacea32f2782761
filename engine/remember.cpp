#include <algorithm>

#include "engine/stages.h"
#include "engine/touching.h"

namespace headpin::engine::detail {
namespace {

void note_meetings(World& world) {
  std::vector<std::uint64_t>& met = world.memory.met;
  std::erase_if(world.events, [&](ContactEvent& e) {
    const std::uint64_t key = key_of(false, std::min(e.a, e.b), std::max(e.a, e.b));
    const auto place = std::lower_bound(met.begin(), met.end(), key);
    e.first = place == met.end() || *place != key;
    if (e.first) met.insert(place, key);
    return !e.first && e.approach_speed == 0.0;
  });
}

}  // namespace

void remember(World& world, Touches& touches, const Flight& flight, Solved& solved, Workspace& w) {
  note_meetings(world);
  Pairs& pairs = *touches.pairs;
  pairs.candidates.resize(pairs.early);  // those found late are not sorted
  Memory& memory = world.memory;
  std::swap(pairs.candidates, memory.candidates);
  std::swap(pairs.normals, memory.normals);
  std::swap(solved.loads, memory.loads);
  memory.touches.resize(touches.early);
  const auto keep = [&](std::size_t k) {
    const Touch& t = touches.all[k];
    const SolvedTouch& s = solved.touches[k];
    const double side = side_of(world.parameters, t);
    memory.touches[k] = {
        t.key,  t.part,          s.met,     flight.touches[k].struck, s.first_load,
        s.rows, t.pair.friction, t.sliding, side * s.friction_W,      side * s.roll,
        s.twist};
  };
  w.crew.share_range(touches.early, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) keep(k);
  });
  world.statistics.contacts = static_cast<std::int64_t>(memory.loads.size());
  world.statistics.awake = static_cast<std::int64_t>(world.roll.movers.size());
}

}  // namespace headpin::engine::detail
