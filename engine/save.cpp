#include "engine/save.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "engine/bodies.h"
#include "engine/rules.h"
#include "engine/saved_bytes.h"
#include "engine/touching.h"

namespace headpin::engine {
namespace {

constexpr std::string_view kMagic = "HPWORLD";
/// Version of the bytes: 3 with the parts that are touched, under the rules that have them.
std::uint8_t version_of(const World& world) {
  return detail::touches_each_part(world.parameters) ? 3 : 2;
}

[[noreturn]] void refuse(const std::string& why) {
  throw std::invalid_argument("saved world: " + why);
}

void add_shape(SavedWriter& w, const Shape& shape) {
  struct Add {
    SavedWriter& w;
    void operator()(const Ellipsoid& s) const { w.add(s.radii); }
    void operator()(const Cylinder& s) const {
      w.add(s.radius);
      w.add(s.half_height);
    }
    void operator()(const Cone& s) const {
      w.add(s.radius);
      w.add(s.height);
    }
    void operator()(const Polyhedron& s) const {
      for (const Vec3& v : s.vertices()) w.add(v);
      for (const Polyhedron::Face& face : s.faces()) {  // the same corners may have other faces
        const auto corners = s.corners(face);
        w.add(static_cast<std::uint32_t>(corners.size()));
        for (const std::uint32_t corner : corners) w.add(corner);
      }
    }
    void operator()(const HalfSpace&) const {}
  };
  w.add(static_cast<std::uint8_t>(shape.index()));
  std::visit(Add{w}, shape);
}

/// Hash of all that does not change: parameters, and bodies without the difference of free and
/// driven, and without tables of friction.
std::uint64_t made_of(const World& world) {
  SavedWriter w;
  const Parameters& p = world.parameters;
  w.add(p.rate_hz);
  w.add(p.gravity_W);
  w.add(p.response);
  w.add(static_cast<std::uint8_t>(p.query.mode));
  w.add(p.query.cap);
  w.add(p.query.warm);
  w.add(p.query.last);
  for (const bool flag : {p.query.steady, p.query.faces, p.query.boxes}) w.add(flag);
  w.add(p.query.margin);
  for (const double x : {p.friction_tau, p.impact_speed, p.solver_residual, p.slop, p.push,
                         p.sleep_speed, p.sleep_spin, p.sleep_after}) {
    w.add(x);
  }
  for (const std::int32_t x : {p.impacts, p.solver_iterations, p.rules}) w.add(x);
  w.add(p.sleep);
  w.add(p.keep_ledger);
  for (const Body& body : world.bodies) {
    w.add(body.kind == Kind::fixed);
    w.add(body.mass);
    for (int k = 0; k < 9; ++k) w.add(body.inertia(k / 3, k % 3));
    for (const double x :
         {body.material.elasticity, body.material.friction, body.material.rolling_arm}) {
      w.add(x);
    }
    w.add(body.exact);
    w.add(static_cast<std::uint32_t>(body.areas.size()));
    for (const FrictionArea& area : body.areas) {
      for (const double x :
           {area.low.x(), area.low.y(), area.high.x(), area.high.y(), area.friction}) {
        w.add(x);
      }
    }
    w.add(static_cast<std::uint32_t>(body.shape->parts.size()));
    for (const Part& part : body.shape->parts) {
      add_shape(w, part.shape);
      w.add(part.X_BG.p);
      w.add(part.X_BG.q);
    }
  }
  return fnv(w.bytes);
}

// The saved values, in their order; a SavedWriter adds them, a SavedReader gets them.

template <typename B>
void each_number(B& b, auto&& f) {
  f(b.energy);
  f(b.momentum);
  f(b.angular_momentum);
}

template <typename S>
void each_number_of_state(S& s, auto&& f) {
  f(s.X_WB.p);
  f(s.X_WB.q);
  f(s.v_WB);
  f(s.w_WB);
}

template <typename L, typename M>
void each_balance(L& ledger, M& memory, auto&& f) {
  for (auto* b : {&ledger.gravity, &ledger.hand, &ledger.impact, &ledger.sustained,
                  &ledger.correction, &memory.balance}) {
    each_number(*b, f);
  }
}

template <typename T>
void each_number_of_touch(T& t, bool has_part, auto&& f) {
  f(t.key);
  if (has_part) f(t.part);
  f(t.met);
  f(t.struck);
  f(t.first_load);
  f(t.loads);
  f(t.friction);
  f(t.friction_W);
  f(t.roll_W);
  f(t.twist);
}

constexpr std::size_t kTouchBytes = 8 + 1 + 1 + 4 + 4 + 8 * 8, kLoadBytes = 12,
                      kCandidateBytes = 24, kBodyBytes = 1 + 1 + 13 * 8 + 1 + 4 + 4;

void get_bodies(SavedReader& r, World& world) {
  const std::size_t count = r.count(kBodyBytes);
  if (count != world.bodies.size()) {
    refuse("has " + std::to_string(count) + " bodies, the world " +
           std::to_string(world.bodies.size()));
  }
  for (BodyId i = 0; i < count; ++i) {
    std::uint8_t kind = 0;
    bool asleep = false;
    r.get(kind);
    r.get(asleep);
    State& state = world.states[i];
    each_number_of_state(state, [&](auto& x) { r.get(x); });
    BodyMemory& memory = world.memory.bodies[i];
    r.get(memory.supported);
    r.get(memory.still);
    r.get(memory.sleeps_with);
    const bool fixed = world.bodies[i].kind == Kind::fixed;
    const bool known = kind <= static_cast<std::uint8_t>(Kind::free);
    if (!known || fixed != (static_cast<Kind>(kind) == Kind::fixed)) {
      refuse("body " + std::to_string(i) + " is of another kind");
    }
    if (asleep && static_cast<Kind>(kind) != Kind::free) {
      refuse("body " + std::to_string(i) + " sleeps and is not free");
    }
    if (std::abs(state.X_WB.q.norm() - 1.0) > 1e-6) {
      refuse("body " + std::to_string(i) + ": norm of its quaternion is not 1");
    }
    detail::become(world, i, static_cast<Kind>(kind), asleep);
  }
  std::vector<bool> entered(count);  // rings: each is entered once
  for (const BodyMemory& memory : world.memory.bodies) {
    if (memory.sleeps_with >= count || entered[memory.sleeps_with]) {
      refuse("bodies that sleep together are no ring");
    }
    entered[memory.sleeps_with] = true;
  }
}

void get_touches(SavedReader& r, const World& world, Memory& memory) {
  memory.loads.resize(r.count(kLoadBytes));
  for (Load& load : memory.loads) {
    r.get(load.impulse);
    r.get(load.feature);
  }
  const bool has_parts = detail::touches_each_part(world.parameters);
  memory.touches.resize(r.count(kTouchBytes));
  const PastTouch* last = nullptr;
  for (PastTouch& touch : memory.touches) {
    each_number_of_touch(touch, has_parts, [&](auto& x) { r.get(x); });
    if (last != nullptr && std::pair(last->key, last->part) >= std::pair(touch.key, touch.part)) {
      refuse("touches are in no order");
    }
    const std::uint64_t end = std::uint64_t{touch.first_load} + touch.loads;
    if (end > memory.loads.size()) refuse("a touch has loads that are not there");
    if (!(touch.friction >= 0.0 && touch.friction <= 1.0)) refuse("friction is not in 0 to 1");
    touch.sliding = detail::sliding_of(world, touch.friction);
    last = &touch;
  }
}

KeptNormal get_normal(SavedReader& r) {
  KeptNormal normal;
  std::uint8_t of = 0;
  r.get(of);
  if (of > KeptNormal::met) refuse("a kept normal is of no kind");
  normal.of = static_cast<KeptNormal::Of>(of);
  if (normal.of == KeptNormal::none) return normal;
  r.get(normal.n_AB);
  if (std::abs(normal.n_AB.norm() - 1.0) > 1e-6) refuse("a kept normal is not unit");
  return normal;
}

void get_candidates(SavedReader& r, const World& world, Memory& memory) {
  memory.normals.resize(r.count(1));
  for (KeptNormal& normal : memory.normals) normal = get_normal(r);
  memory.candidates.resize(r.count(kCandidateBytes));
  const Candidate* last = nullptr;
  for (Candidate& c : memory.candidates) {
    r.get(c.key);
    r.get(c.a);
    r.get(c.b);
    r.get(c.first_normal);
    r.get(c.normals);
    if (last != nullptr && last->key >= c.key) refuse("candidates are in no order");
    const bool both = (c.key >> 63) != 0;
    if (std::max(c.a, c.b) >= world.bodies.size() || c.key != key_of(both, c.a, c.b)) {
      refuse("a candidate is of bodies that are not there");
    }
    const std::uint64_t end = std::uint64_t{c.first_normal} + c.normals;
    const std::size_t parts = kept_normals(*world.bodies[c.a].shape, *world.bodies[c.b].shape);
    if (end > memory.normals.size() || c.normals != parts) {
      refuse("a candidate has normals that are not there");
    }
    last = &c;
  }
}

}  // namespace

std::vector<std::uint8_t> save(const World& world) {
  SavedWriter w(kMagic, version_of(world));
  w.add(made_of(world));
  w.add(world.tick);
  const auto add = [&](const auto& x) { w.add(x); };
  const auto add_count = [&](const auto& list) { w.add(static_cast<std::uint32_t>(list.size())); };
  const Memory& memory = world.memory;
  add_count(world.bodies);
  for (BodyId i = 0; i < world.bodies.size(); ++i) {
    w.add(static_cast<std::uint8_t>(world.bodies[i].kind));
    w.add(world.asleep[i] != 0);
    each_number_of_state(world.states[i], add);
    w.add(memory.bodies[i].supported);
    w.add(memory.bodies[i].still);
    w.add(memory.bodies[i].sleeps_with);
  }
  each_balance(world.ledger, memory, add);
  add_count(memory.loads);
  for (const Load& load : memory.loads) {
    w.add(load.impulse);
    w.add(load.feature);
  }
  add_count(memory.touches);
  for (const PastTouch& touch : memory.touches) {
    each_number_of_touch(touch, detail::touches_each_part(world.parameters), add);
  }
  add_count(memory.normals);
  for (const KeptNormal& normal : memory.normals) {
    w.add(static_cast<std::uint8_t>(normal.of));
    if (normal.of != KeptNormal::none) w.add(normal.n_AB);
  }
  add_count(memory.candidates);
  for (const Candidate& c : memory.candidates) {
    w.add(c.key);
    for (const std::uint32_t x : {c.a, c.b, c.first_normal, c.normals}) w.add(x);
  }
  add_count(memory.met);
  for (const std::uint64_t pair : memory.met) w.add(pair);
  return w.sealed();
}

World restore(World world, std::span<const std::uint8_t> bytes) {
  SavedReader r(bytes, kMagic, version_of(world), "saved world");
  std::uint64_t made = 0;
  r.get(made);
  if (made != made_of(world)) refuse("was made of other bodies or parameters");
  r.get(world.tick);
  if (world.tick < 0) refuse("its tick is negative");
  get_bodies(r, world);
  each_balance(world.ledger, world.memory, [&](auto& x) { r.get(x); });
  get_touches(r, world, world.memory);
  get_candidates(r, world, world.memory);
  world.memory.met.resize(r.count(8));
  for (std::uint64_t& pair : world.memory.met) r.get(pair);
  if (!std::is_sorted(world.memory.met.begin(), world.memory.met.end())) {
    refuse("pairs that have met are in no order");
  }
  if (!r.empty()) refuse("goes on behind its end");
  world.events.clear();
  world.statistics = {};
  return world;
}

}  // namespace headpin::engine
