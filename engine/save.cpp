#include "engine/save.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>

#include "engine/bodies.h"
#include "engine/hash.h"

namespace headpin::engine {
namespace {

constexpr std::string_view kMagic = "HPWORLD";
constexpr std::uint8_t kVersion = 1;
constexpr std::size_t kChecksum = 8;  // bytes of it, at the end

[[noreturn]] void refuse(const std::string& why) {
  throw std::invalid_argument("saved world: " + why);
}

std::uint64_t hash_of(std::span<const std::uint8_t> bytes) {
  Fnv hash;
  for (const std::uint8_t byte : bytes) hash.add(byte);
  return hash.value();
}

/// Writes numbers as bytes, lowest byte first.
class Writer {
 public:
  void add(std::uint8_t x) { bytes.push_back(x); }
  void add(std::uint32_t x) { put(x, 4); }
  void add(std::uint64_t x) { put(x, 8); }
  void add(std::int32_t x) { put(static_cast<std::uint32_t>(x), 4); }
  void add(std::int64_t x) { put(static_cast<std::uint64_t>(x), 8); }
  void add(double x) {
    std::uint64_t bits;
    std::memcpy(&bits, &x, sizeof bits);
    put(bits, 8);
  }
  void add(bool x) { add(static_cast<std::uint8_t>(x ? 1 : 0)); }
  void add(const Vec3& v) {
    for (int k = 0; k < 3; ++k) add(v[k]);
  }
  void add(const Quat& q) {
    for (int k = 0; k < 4; ++k) add(q.coeffs()[k]);
  }
  void add(std::string_view text) {
    add(static_cast<std::uint32_t>(text.size()));
    bytes.insert(bytes.end(), text.begin(), text.end());
  }

  std::vector<std::uint8_t> bytes;

 private:
  void put(std::uint64_t x, int count) {
    for (int k = 0; k < count; ++k, x >>= 8) bytes.push_back(static_cast<std::uint8_t>(x));
  }
};

class Reader {
 public:
  explicit Reader(std::span<const std::uint8_t> bytes) : left_(bytes) {}

  void get(std::uint8_t& x) { x = static_cast<std::uint8_t>(take(1)); }
  void get(std::uint32_t& x) { x = static_cast<std::uint32_t>(take(4)); }
  void get(std::uint64_t& x) { x = take(8); }
  void get(std::int32_t& x) { x = static_cast<std::int32_t>(take(4)); }
  void get(std::int64_t& x) { x = static_cast<std::int64_t>(take(8)); }
  void get(double& x) {
    const std::uint64_t bits = take(8);
    std::memcpy(&x, &bits, sizeof x);
    if (!std::isfinite(x)) refuse("expected finite numbers");
  }
  void get(bool& x) {
    const std::uint64_t byte = take(1);
    if (byte > 1) refuse("expected 0 or 1, found " + std::to_string(byte));
    x = byte == 1;
  }
  void get(Vec3& v) {
    for (int k = 0; k < 3; ++k) get(v[k]);
  }
  void get(Quat& q) {
    for (int k = 0; k < 4; ++k) get(q.coeffs()[k]);
  }
  /// Reads the number of items that follow. @param least  minimum number of bytes of an item
  std::size_t count(std::size_t least) {
    std::uint32_t n = 0;
    get(n);
    if (n > left_.size() / least) refuse("ends early");
    return n;
  }
  bool empty() const { return left_.empty(); }

 private:
  std::uint64_t take(std::size_t count) {
    if (left_.size() < count) refuse("ends early");
    std::uint64_t x = 0;
    for (std::size_t k = count; k-- > 0;) x = x << 8 | left_[k];
    left_ = left_.subspan(count);
    return x;
  }

  std::span<const std::uint8_t> left_;
};

void add_shape(Writer& w, const Shape& shape) {
  struct Add {
    Writer& w;
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
    }
    void operator()(const HalfSpace&) const {}
  };
  w.add(static_cast<std::uint8_t>(shape.index()));
  std::visit(Add{w}, shape);
}

/// Hash of all that does not change: parameters, and bodies without the difference of free and
/// driven.
std::uint64_t made_of(const World& world) {
  Writer w;
  const Parameters& p = world.parameters;
  w.add(p.rate_hz);
  w.add(p.gravity_W);
  w.add(p.response);
  w.add(static_cast<std::uint8_t>(p.query.mode));
  w.add(p.query.cap);
  w.add(p.query.warm);
  w.add(p.query.last);
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
    for (const Part& part : body.shape->parts) {
      add_shape(w, part.shape);
      w.add(part.X_BG.p);
      w.add(part.X_BG.q);
    }
  }
  return hash_of(w.bytes);
}

// The saved values, in their order; a Writer adds them, a Reader gets them.

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
void each_number_of_touch(T& t, auto&& f) {
  f(t.key);
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

void get_bodies(Reader& r, World& world) {
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

void get_touches(Reader& r, const World& world, Memory& memory) {
  memory.loads.resize(r.count(kLoadBytes));
  for (Load& load : memory.loads) {
    r.get(load.impulse);
    r.get(load.feature);
  }
  memory.touches.resize(r.count(kTouchBytes));
  const PastTouch* last = nullptr;
  for (PastTouch& touch : memory.touches) {
    each_number_of_touch(touch, [&](auto& x) { r.get(x); });
    if (last != nullptr && last->key >= touch.key) refuse("touches are in no order");
    const std::uint64_t end = std::uint64_t{touch.first_load} + touch.loads;
    if (end > memory.loads.size()) refuse("a touch has loads that are not there");
    if (!(touch.friction >= 0.0 && touch.friction <= 1.0)) refuse("friction is not in 0 to 1");
    touch.sliding =
        world.response->sliding(touch.friction, step_seconds(world), world.parameters.friction_tau);
    last = &touch;
  }
}

KeptNormal get_normal(Reader& r) {
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

void get_candidates(Reader& r, const World& world, Memory& memory) {
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
  Writer w;
  w.bytes.assign(kMagic.begin(), kMagic.end());
  w.add(kVersion);
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
  for (const PastTouch& touch : memory.touches) each_number_of_touch(touch, add);
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
  w.add(hash_of(w.bytes));
  return std::move(w.bytes);
}

World restore(World world, std::span<const std::uint8_t> bytes) {
  const std::size_t head = kMagic.size() + 1;
  if (bytes.size() < head + kChecksum || !std::equal(kMagic.begin(), kMagic.end(), bytes.begin())) {
    refuse("expected the bytes of a saved world, found others");
  }
  const std::uint8_t version = bytes[kMagic.size()];
  if (version != kVersion) {
    refuse("version " + std::to_string(version) + ", expected " + std::to_string(kVersion));
  }
  const std::span<const std::uint8_t> content = bytes.first(bytes.size() - kChecksum);
  std::uint64_t checksum = 0;
  Reader(bytes.last(kChecksum)).get(checksum);
  if (checksum != hash_of(content)) refuse("cut off or changed: its checksum is another");
  Reader r(content.subspan(head));
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
