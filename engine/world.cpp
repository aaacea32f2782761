#include "engine/world.h"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/hash.h"
#include "engine/bodies.h"
#include "engine/rules.h"
#include "engine/seams.h"
#include "engine/touching.h"

namespace headpin::engine {
namespace {

std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", x);
  return text;
}

void expect(bool good, const std::string& what, const std::string& range, double found) {
  if (!good) {
    throw std::invalid_argument(what + ": expected " + range + ", found " + number(found));
  }
}

void expect_between(double x, double low, double high, const std::string& what) {
  expect(x >= low && x <= high, what, number(low) + " to " + number(high), x);
}

void check_parameters(const Parameters& p) {
  expect_between(p.rate_hz, 1, 1'000'000, "rate_hz");
  expect(p.gravity_W.norm() <= 1000.0, "gravity_W [m/s^2]", "at most 1000", p.gravity_W.norm());
  expect_between(p.query.cap, 1, 1000, "query.cap");
  expect_between(p.friction_tau, 1e-6, 1e6, "friction_tau [s]");
  expect_between(p.impact_speed, 0.0, 100.0, "impact_speed [m/s]");
  expect_between(p.impacts, 1, 1000, "impacts");
  expect_between(p.solver_iterations, 1, 100'000, "solver_iterations");
  expect_between(p.solver_residual, 0.0, 1.0, "solver_residual [m/s]");
  expect_between(p.slop, 0.0, 0.1, "slop [m]");
  expect_between(p.push, 0.0, 1.0, "push");
  expect_between(p.rules, 1, 17, "rules");
  expect_between(p.sleep_speed, 0.0, 10.0, "sleep_speed [m/s]");
  expect_between(p.sleep_spin, 0.0, 100.0, "sleep_spin [rad/s]");
  expect_between(p.sleep_after, 0.0, 1e4, "sleep_after [s]");
  expect_between(p.threads, 1, kMostThreads, "threads");
}

bool is_bounded(const Body& body) {
  return std::isfinite(body.shape->bounding_radius);
}

/// Checks the areas of a body that have a friction of their own.
void check_areas(const Body& body, const std::string& who) {
  if (!body.areas.empty() && body.kind != Kind::fixed) {
    throw std::invalid_argument(who + ": areas of friction: expected a fixed body");
  }
  for (const FrictionArea& area : body.areas) {
    expect_between(area.friction, 0.0, 1.0, who + ": friction of an area");
    for (int k = 0; k < 2; ++k) {
      expect(area.low[k] < area.high[k], who + ": high corner of an area of friction [m]",
             "above " + number(area.low[k]), area.high[k]);
    }
  }
}

/// Checks the table of friction of a body.
void check_table(const Body& body, const std::string& who) {
  if (!body.table) return;
  const FrictionTable& table = *body.table;
  if (body.kind != Kind::fixed) {
    throw std::invalid_argument(who + ": table of friction: expected a fixed body");
  }
  expect(std::isfinite(table.low_x), who + ": begin of the table of friction [m]",
         "a finite number", table.low_x);
  expect(table.columns > 0, who + ": columns of the table of friction", "1 or more", 0.0);
  expect(table.width > 0.0, who + ": width of a column of friction [m]", "above 0", table.width);
  for (std::size_t i = 1; i < table.edges.size(); ++i) {
    expect(table.edges[i - 1] < table.edges[i], who + ": edge of a row of friction [m]",
           "above " + number(table.edges[i - 1]), table.edges[i]);
  }
  const std::size_t rows = table.edges.empty() ? 0 : table.edges.size() - 1;
  expect(table.friction.size() == rows * table.columns, who + ": cells of friction",
         std::to_string(rows * table.columns), static_cast<double>(table.friction.size()));
  for (const double friction : table.friction) {
    expect_between(friction, 0.0, 1.0, who + ": friction of a cell");
  }
}

void check_body(const Body& body, const std::string& who) {
  const Material& m = body.material;
  expect_between(m.elasticity, 0.0, 1.0, who + ": elasticity");
  expect_between(m.friction, 0.0, 1.0, who + ": friction");
  expect_between(m.rolling_arm, 0.0, 1.0, who + ": rolling_arm [m]");
  if (body.shape->parts.empty()) throw std::invalid_argument(who + ": expected a shape with parts");
  check_areas(body, who);
  check_table(body, who);
  if (body.kind == Kind::fixed) return;
  if (!is_bounded(body)) {
    throw std::invalid_argument(who + ": a half-space must be fixed");
  }
  expect_between(body.mass, 1e-6, 1e6, who + ": mass [kg]");
  try {
    principal_inertia(body.inertia);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(who + ": " + error.what());
  }
}

bool is_good(const State& s) {
  return s.X_WB.p.allFinite() && s.v_WB.allFinite() && s.w_WB.allFinite() &&
         std::abs(s.X_WB.q.norm() - 1.0) < 1e-6;
}

[[noreturn]] void refuse(const State& s, const std::string& who) {
  const bool finite = s.X_WB.p.allFinite() && s.X_WB.q.coeffs().allFinite() && s.v_WB.allFinite() &&
                      s.w_WB.allFinite();
  throw std::invalid_argument(
      who + (finite ? ": norm of its quaternion: expected 1, found " + number(s.X_WB.q.norm())
                    : ": expected a finite pose and velocity"));
}

void check_number(const World& world, BodyId body) {
  if (body < world.bodies.size()) return;
  throw std::invalid_argument("body " + std::to_string(body) + ": there are " +
                              std::to_string(world.bodies.size()));
}

/// Calls f(k, point) for the contact points of a body at pose X_WB with each body k for which
/// `concerns` is true.
template <typename Concerns, typename F>
void each_contact(const World& world, const Body& body, const Pose& X_WB, double margin,
                  Concerns&& concerns, F&& f) {
  std::vector<ContactPoint> points;
  std::vector<KeptNormal> normals;
  QueryCounts counts;
  for (BodyId k = 0; k < world.bodies.size(); ++k) {
    if (!concerns(k)) continue;
    const Body& other = world.bodies[k];
    const double near = body.shape->bounding_radius + other.shape->bounding_radius + margin;
    if ((X_WB.p - world.states[k].X_WB.p).squaredNorm() > near * near) continue;
    points.clear();
    normals.assign(kept_normals(*body.shape, *other.shape), {});
    find_contacts(*body.shape, X_WB, *other.shape, world.states[k].X_WB, margin, normals, Query{},
                  counts, points);
    for (const ContactPoint& p : points) f(k, p);
  }
}

/// Throws if one body is deep inside another.
void check_overlap(const World& world, const Body& body, const State& state,
                   const std::string& who) {
  each_contact(
      world, body, state.X_WB, 0.0,
      [&](BodyId k) { return body.kind == Kind::free || world.bodies[k].kind == Kind::free; },
      [&](BodyId k, const ContactPoint& p) {
        const double most =
            0.25 * std::min(body.shape->bounding_radius, world.bodies[k].shape->bounding_radius);
        expect(p.depth <= most, who + ": overlap with " + detail::title(world, k) + " [m]",
               "at most " + number(most), p.depth);
      });
}

/// Wakes a body and the bodies that rest on it, so that nothing floats when it moves away.
void wake_with_what_rests_on(World& world, BodyId body) {
  wake(world, body);
  world.memory.bodies[body].supported = false;
  each_contact(
      world, world.bodies[body], world.states[body].X_WB, detail::kRests,
      [&](BodyId k) { return world.asleep[k] != 0; },
      [&](BodyId k, const ContactPoint&) { wake(world, k); });
}

/// Adds numbers to the hash, lowest byte first.
class StateHash {
 public:
  void add(std::uint64_t bits) {
    for (int k = 0; k < 8; ++k, bits >>= 8) bytes_.add(static_cast<std::uint8_t>(bits));
  }
  void add(double x) {
    std::uint64_t bits;  // std::bit_cast is not in every C++20 library yet
    std::memcpy(&bits, &x, sizeof bits);
    add(bits);
  }
  void add(const Vec3& v) {
    for (int k = 0; k < 3; ++k) add(v[k]);
  }
  std::uint64_t value() const { return bytes_.value(); }

 private:
  Fnv bytes_;
};

}  // namespace

World make_world(const Parameters& parameters, SameLayout) {
  check_parameters(parameters);
  World world;
  world.parameters = parameters;
  world.parameters.query = detail::query_under(parameters);
  world.response = &response_under(parameters.response, parameters.rules);
  return world;
}

BodyId add_body(World& world, Body body, const State& state) {
  const auto i = static_cast<BodyId>(world.bodies.size());
  const std::string who =
      "body " + std::to_string(i) + (body.name.empty() ? "" : " '" + body.name + "'");
  check_body(body, who);
  if (!is_good(state)) refuse(state, who);
  if (body.kind == Kind::fixed && !(state.v_WB.isZero(0.0) && state.w_WB.isZero(0.0))) {
    throw std::invalid_argument(who + ": is fixed, expected no velocity");
  }
  check_overlap(world, body, state, who);
  world.inertias.push_back(body.kind == Kind::fixed ? Inertia{} : principal_inertia(body.inertia));
  world.memory.bodies.push_back({.sleeps_with = i});
  world.bodies.push_back(std::move(body));
  world.states.push_back(state);
  world.states.back().X_WB.q.normalize();
  world.asleep.push_back(0);
  detail::become(world, i, world.bodies[i].kind, false);
  world.seams.made = false;
  return i;
}

void set_state(World& world, BodyId body, const State& state) {
  check_number(world, body);
  if (!is_good(state)) refuse(state, detail::title(world, body));
  if (world.bodies[body].kind == Kind::fixed) {
    throw std::invalid_argument(detail::title(world, body) + ": is fixed and cannot be moved");
  }
  wake_with_what_rests_on(world, body);
  world.states[body] = state;
  world.states[body].X_WB.q.normalize();
}

void set_kind(World& world, BodyId body, Kind kind) {
  check_number(world, body);
  const Kind now = world.bodies[body].kind;
  if (now == kind) return;
  if (now == Kind::fixed || kind == Kind::fixed) {
    throw std::invalid_argument(detail::title(world, body) + ": only free and driven can change");
  }
  wake_with_what_rests_on(world, body);
  detail::become(world, body, kind, false);
}

void wake(World& world, BodyId body) {
  check_number(world, body);
  std::vector<BodyMemory>& memory = world.memory.bodies;
  memory[body].still = 0;
  if (!world.asleep[body]) return;
  BodyId i = body;
  do {
    const BodyId next = memory[i].sleeps_with;
    detail::become(world, i, world.bodies[i].kind, false);
    memory[i] = {.supported = true, .still = 0, .sleeps_with = i};  // it lay on something
    i = next;
  } while (i != body);
}

void put_to_sleep(World& world, BodyId body) {
  check_number(world, body);
  if (world.bodies[body].kind != Kind::free) {
    throw std::invalid_argument(detail::title(world, body) + ": only a free body can sleep");
  }
  world.states[body].v_WB = world.states[body].w_WB = Vec3::Zero();
  detail::become(world, body, Kind::free, true);
}

void set_response(World& world, const Response& response) {
  world.response = &response;
  world.parameters.response = response.name;
  for (PastTouch& touch : world.memory.touches)
    touch.sliding = detail::sliding_of(world, touch.friction);
}

State outside_fixed(const World& world, BodyId body, const State& wanted) {
  check_number(world, body);
  if (!is_good(wanted)) refuse(wanted, detail::title(world, body));
  const Body& mine = world.bodies[body];
  const auto is_fixed = [&](BodyId k) { return world.bodies[k].kind == Kind::fixed; };
  State state = wanted;
  Vec3& p = state.X_WB.p;
  // The body moves in strides shorter than its thinnest part, so that it cannot pass through
  // anything. Each stride ends outside of fixed bodies.
  const Vec3 start = world.states[body].X_WB.p;
  const double stride =
      0.25 * *std::min_element(mine.shape->part_radius.begin(), mine.shape->part_radius.end());
  const int strides =
      static_cast<int>(std::clamp(std::ceil((p - start).norm() / stride), 1.0, 10'000.0));
  Vec3 pushed = Vec3::Zero();
  for (int n = 1; n <= strides; ++n) {
    const double rest = static_cast<double>(strides - n) / strides;
    p = wanted.X_WB.p + rest * (start - wanted.X_WB.p) + pushed;
    for (int pass = 0; pass < 16; ++pass) {
      ContactPoint deepest;
      each_contact(world, mine, state.X_WB, 0.0, is_fixed, [&](BodyId, const ContactPoint& c) {
        if (c.depth > deepest.depth) deepest = c;
      });
      if (deepest.depth <= 0.0) break;
      pushed -= deepest.depth * deepest.n_AB_W;
      p -= deepest.depth * deepest.n_AB_W;
    }
  }
  each_contact(world, mine, state.X_WB, detail::kRests, is_fixed,
               [&](BodyId, const ContactPoint& c) {
                 const Vec3 v = velocity_at(state, c.p_W - p);
                 state.v_WB -= std::max(0.0, v.dot(c.n_AB_W)) * c.n_AB_W;
               });
  return state;
}

Balance balance_of(const World& world, BodyId body) {
  const State& s = world.states[body];
  const double mass = world.bodies[body].mass;
  const Inertia& inertia = world.inertias[body];
  const Vec3 mv = mass * s.v_WB;
  return {0.5 * mv.dot(s.v_WB) + turning_energy(inertia, s.X_WB.q, s.w_WB) -
              mass * world.parameters.gravity_W.dot(s.X_WB.p),
          mv, s.X_WB.p.cross(mv) + angular_momentum(inertia, s.X_WB.q, s.w_WB)};
}

Balance balance(const World& world) {
  Balance sum;
  for (BodyId i = 0; i < world.bodies.size(); ++i) {
    if (world.bodies[i].kind == Kind::free) sum += balance_of(world, i);
  }
  return sum;
}

std::uint64_t state_hash(const World& world) {
  StateHash hash;
  hash.add(static_cast<std::uint64_t>(world.tick));
  for (BodyId i = 0; i < world.states.size(); ++i) {
    const State& s = world.states[i];
    hash.add(s.X_WB.p);
    for (int k = 0; k < 4; ++k) hash.add(s.X_WB.q.coeffs()[k]);
    hash.add(s.v_WB);
    hash.add(s.w_WB);
    hash.add(std::uint64_t{world.asleep[i]});
  }
  return hash.value();
}

void forget_meetings(World& world, BodyId body) {
  check_number(world, body);
  std::erase_if(world.memory.met, [&](std::uint64_t pair) { return concerns(pair, body); });
  for (PastTouch& touch : world.memory.touches) {
    if (concerns(touch.key, body)) touch.met = false;
  }
}

void set_friction(World& world, BodyId body, std::shared_ptr<const FrictionTable> table) {
  check_number(world, body);
  Body& changed = world.bodies[body];
  const std::shared_ptr<const FrictionTable> before =
      std::exchange(changed.table, std::move(table));
  try {
    check_table(changed, detail::title(world, body));
  } catch (...) {
    changed.table = before;
    throw;
  }
}

void take_over(World& world, const World& from) {
  if (from.bodies.size() != world.bodies.size()) {
    throw std::invalid_argument("take_over: expected a world with " +
                                std::to_string(world.bodies.size()) + " bodies, found " +
                                std::to_string(from.bodies.size()));
  }
  world.tick = from.tick;
  world.ledger = from.ledger;
  world.states = from.states;
  world.memory = {};
  world.memory.bodies = from.memory.bodies;
  world.memory.met = from.memory.met;
  world.memory.balance = from.memory.balance;
  for (BodyId i = 0; i < world.bodies.size(); ++i) {
    world.memory.bodies[i].supported = false;
    detail::become(world, i, from.bodies[i].kind, from.asleep[i] != 0);
  }
}

void contacts_now(World& world, BodyId a, BodyId b, double margin, std::vector<ContactPoint>& out) {
  check_number(world, a);
  check_number(world, b);
  detail::know_seams(world);
  const std::size_t count = kept_normals(*world.bodies[a].shape, *world.bodies[b].shape);
  std::vector<KeptNormal> none(count);
  QueryCounts counts;
  detail::contacts_of(world, {.a = a, .b = b}, none, world.states[a].X_WB, world.states[b].X_WB,
                      margin, counts, out);
}

namespace detail {

void become(World& world, BodyId i, Kind kind, bool asleep) {
  world.bodies[i].kind = kind;
  world.asleep[i] = asleep ? 1 : 0;
  world.roll.made = false;
}

std::string title(const World& world, BodyId i) {
  const std::string& name = world.bodies[i].name;
  return "body " + std::to_string(i) + (name.empty() ? "" : " '" + name + "'");
}

}  // namespace detail
}  // namespace headpin::engine
