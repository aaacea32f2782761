// The bytes of a small world made by hand, in which every number is another.

#include <functional>

#include <gtest/gtest.h>

#include "base/hash.h"
#include "engine/save.h"
#include "engine/touching.h"
#include "tests/support/bowling.h"
#include "tests/support/random_shapes.h"

namespace headpin::engine {
namespace {

using SavedBytes = std::vector<std::uint8_t>;

constexpr BodyId kGround = 0, kBox = 1, kPusher = 2, kLoose = 3, kSleeper = 4, kLast = 5;
constexpr std::size_t kCountAt = 7 + 1 + 8 + 8, kFirstBodyAt = kCountAt + 4;  // bytes

/// Bodies of every shape and kind.
World bodies_by_hand() {
  World world = make_world({.response = "coulomb"});
  Body ground{.name = "ground", .shape = floor_shape(), .kind = Kind::fixed};
  ground.areas = {{{-1.0, 0.5}, {1.5, 2.0}, 0.25}, {{-3.0, 0.75}, {2.5, 4.0}, 0.125}};
  add_body(world, ground);
  add_body(world, {.name = "box",
                   .shape = make_compound({{test::box({0.25, 0.5, 0.125}), {}}}),
                   .kind = Kind::fixed});
  add_body(world,
           {.name = "pusher",
            .shape = make_compound({{Cylinder{0.25, 0.75}, {}}}),
            .kind = Kind::driven},
           at(Vec3(0.0, 0.0, 5.0)));
  Body free{.name = "free", .mass = 1.5, .material = {0.5, 0.25, 0.0625}, .exact = true};
  free.shape = make_compound({{Ellipsoid{{0.25, 0.5, 0.75}}, {}},
                              {Cone{0.125, 0.5}, {Quat(0.0, 1.0, 0.0, 0.0), {0.5, 0.25, 0.125}}}});
  add_body(world, free, at(Vec3(1.0, 2.0, 3.0), Vec3(4.0, 5.0, 6.0), Vec3(7.0, 8.0, 9.0)));
  world.bodies[kLoose].inertia << 1.0, 0.25, 0.5, 0.125, 2.0, 0.75, 0.375, 0.625, 3.0;
  add_body(world, free, at(Vec3(11.5, 2.5, 3.5)));
  add_body(world, free, at(Vec3(21.5, 2.5, 9.5)));
  return world;
}

Balance balance_from(double first) {
  return {first, {first + 1.0, first + 2.0, first + 3.0}, {first + 4.0, first + 5.0, first + 6.0}};
}

/// Gives a world all that changes during a simulation.
World with_a_past(World world) {
  world.tick = 1234;
  put_to_sleep(world, kSleeper);
  world.states[kLoose].X_WB.q = Quat(0.5, -0.5, 0.5, 0.5);
  world.ledger = {balance_from(10), balance_from(20), balance_from(30), balance_from(40),
                  balance_from(50)};
  Memory& memory = world.memory;
  memory.balance = balance_from(60);
  memory.bodies[kLoose] = {true, 7, kLast};
  memory.bodies[kLast] = {false, 9, kLoose};
  memory.loads = {{1.25, 3}, {2.5, 0x10002}, {3.75, 4}};
  const auto touch = [](std::uint64_t key, std::uint32_t part, double first) {
    PastTouch t;
    t.key = key;
    t.part = part;
    t.met = part == 1;
    t.struck = part == 2;
    t.friction_W = {first, first + 1.0, first + 2.0};
    t.roll_W = {first + 3.0, first + 4.0, first + 5.0};
    t.twist = first + 6.0;
    return t;
  };
  const std::uint64_t key = key_of(true, kLoose, kBox);
  memory.touches = {touch(key_of(false, kLoose, kGround), 0, 100.0), touch(key, 1, 200.0),
                    touch(key, 2, 300.0)};
  memory.touches[0].friction = 0.75;
  memory.touches[1].loads = 2;
  memory.touches[1].friction = 1.0;
  memory.touches[2].first_load = 2;
  memory.touches[2].loads = 1;
  memory.normals = {{Vec3::Zero(), KeptNormal::none},
                    {Vec3::UnitY(), KeptNormal::apart},
                    {-Vec3::UnitX(), KeptNormal::met}};
  memory.candidates = {{key_of(false, kLoose, kGround), kLoose, kGround, 0, 0},
                       {key, kLoose, kBox, 1, 2}};
  memory.met = {5, 5, 6};
  return world;
}

std::string refusal_of(const World& made, std::span<const std::uint8_t> bytes) {
  try {
    restore(made, bytes);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

/// How a world is refused whose past is changed.
std::string refusal_after(const std::function<void(World&)>& change) {
  const World made = bodies_by_hand();
  World world = with_a_past(made);
  change(world);
  return refusal_of(made, save(world));
}

/// How bytes are refused of which one is changed, with the checksum that belongs to them.
std::string refusal_with(std::size_t place, std::uint8_t byte) {
  const World made = bodies_by_hand();
  SavedBytes bytes = save(with_a_past(made));
  bytes[place] = byte;
  Fnv hash;
  for (std::size_t k = 0; k + 8 < bytes.size(); ++k) hash.add(bytes[k]);
  for (std::size_t k = 0; k < 8; ++k) {
    bytes[bytes.size() - 8 + k] = static_cast<std::uint8_t>(hash.value() >> 8 * k);
  }
  return refusal_of(made, bytes);
}

std::uint64_t hash_of(const SavedBytes& bytes) {
  Fnv hash;
  for (const std::uint8_t byte : bytes) hash.add(byte);
  return hash.value();
}

// Older programs have saved worlds with these bytes: another layout needs another version.
TEST(SavedBytes, AreThoseOfVersions2And3) {
  World world = with_a_past(bodies_by_hand());
  world.parameters.rules = 14;
  const SavedBytes bytes = save(world);
  EXPECT_EQ(std::string(bytes.begin(), bytes.begin() + 7), "HPWORLD");
  EXPECT_EQ(bytes[7], 3);
  const std::size_t head = 24, bodies = 4 + 6 * 115, balances = 6 * 7 * 8, loads = 4 + 3 * 12,
                    touches = 4 + 3 * 86, normals = 4 + 1 + 2 * 25, candidates = 4 + 2 * 24;
  EXPECT_EQ(bytes.size(),
            head + bodies + balances + loads + touches + normals + candidates + (4 + 3 * 8) + 8);
  EXPECT_EQ(hash_of(bytes), 6764017490896387802u);
  world.parameters.rules = 9;
  const SavedBytes older = save(world);
  EXPECT_EQ(older[7], 2);
  EXPECT_EQ(older.size(), bytes.size() - 3 * 4) << "touches have no parts";
  EXPECT_EQ(hash_of(older), 12264701218835186467u);
}

TEST(SavedBytes, GiveBackAllThatChangesAndNoEvents) {
  World made = bodies_by_hand();
  const World world = with_a_past(made);
  set_kind(made, kLoose, Kind::driven);  // in any state
  set_kind(made, kPusher, Kind::free);
  made.events.resize(2);
  made.statistics.impacts = 5;
  const World is = restore(made, save(world));
  EXPECT_EQ(save(is), save(world));
  EXPECT_TRUE(is.events.empty());
  EXPECT_EQ(is.statistics.impacts, 0);
  EXPECT_EQ(is.tick, 1234);
  EXPECT_EQ(is.bodies[kLoose].kind, Kind::free);
  EXPECT_EQ(is.bodies[kPusher].kind, Kind::driven);
  EXPECT_TRUE(is_asleep(is, kSleeper));
  ASSERT_EQ(is.memory.touches.size(), 3u);
  for (const PastTouch& touch : is.memory.touches) {
    EXPECT_EQ(touch.sliding.kept, detail::sliding_of(world, touch.friction).kept);
    EXPECT_EQ(touch.sliding.limit, touch.friction) << "Coulomb's law";
  }
}

TEST(SavedBytes, AreRefusedWhereBodiesAreNotThoseOfTheWorld) {
  EXPECT_EQ(refusal_after([](World&) {}), "accepted");
  EXPECT_EQ(refusal_with(kCountAt, 5), "saved world: has 5 bodies, the world 6");
  EXPECT_EQ(refusal_with(kFirstBodyAt, 3), "saved world: body 0 is of another kind");
  EXPECT_EQ(refusal_with(kFirstBodyAt, 2), "saved world: body 0 is of another kind");
  EXPECT_EQ(refusal_after([](World& w) { w.bodies[kLoose].kind = Kind::fixed; }),
            "saved world: was made of other bodies or parameters");
  const std::size_t a_body = 1 + 1 + 13 * 8 + 1 + 4 + 4;
  EXPECT_EQ(refusal_with(kFirstBodyAt + kLoose * a_body, 0),
            "saved world: body 3 is of another kind");
  EXPECT_EQ(refusal_with(kFirstBodyAt + kLast * a_body, 3),
            "saved world: body 5 is of another kind");
  EXPECT_EQ(refusal_after([](World& w) { w.asleep[kPusher] = 1; }),
            "saved world: body 2 sleeps and is not free");
  EXPECT_EQ(refusal_after([](World& w) { w.asleep[kBox] = 1; }),
            "saved world: body 1 sleeps and is not free");
  EXPECT_EQ(refusal_after([](World& w) { w.tick = -1; }), "saved world: its tick is negative");
  EXPECT_EQ(refusal_after([](World& w) { w.tick = 0; }), "accepted");
  for (const double norm : {1.0 - 1.1e-6, 1.0 - 0.9e-6, 1.0 + 0.9e-6, 1.0 + 1.1e-6}) {
    EXPECT_EQ(refusal_after([&](World& w) { w.states[kLoose].X_WB.q.coeffs() *= norm; }),
              std::abs(norm - 1.0) < 1e-6 ? "accepted"
                                          : "saved world: body 3: norm of its quaternion is not 1");
  }
  const char* const no_ring = "saved world: bodies that sleep together are no ring";
  EXPECT_EQ(refusal_after([](World& w) { w.memory.bodies[kLoose].sleeps_with = 6; }), no_ring);
  EXPECT_EQ(refusal_after([](World& w) { w.memory.bodies[kLoose].sleeps_with = kSleeper; }),
            no_ring);
}

TEST(SavedBytes, AreRefusedWithTouchesThatCannotBe) {
  using Change = std::function<void(Memory&)>;
  const auto refused = [](const Change& change) {
    return refusal_after([&](World& w) { change(w.memory); });
  };
  const char* const no_order = "saved world: touches are in no order";
  EXPECT_EQ(refused([](Memory& m) { m.touches[2].part = 1; }), no_order);
  EXPECT_EQ(refused([](Memory& m) { m.touches[2].part = 0; }), no_order);
  EXPECT_EQ(refused([](Memory& m) { std::swap(m.touches[0], m.touches[1]); }), no_order);
  const char* const no_load = "saved world: a touch has loads that are not there";
  EXPECT_EQ(refused([](Memory& m) { m.touches[2].loads = 2; }), no_load);
  EXPECT_EQ(refused([](Memory& m) { m.touches[2].first_load = 3; }), no_load);
  EXPECT_EQ(refused([](Memory& m) { m.touches[2].first_load = m.touches[2].loads = ~0u; }),
            no_load);
  const char* const friction = "saved world: friction is not in 0 to 1";
  EXPECT_EQ(refused([](Memory& m) { m.touches[1].friction = 1.0 + 1e-15; }), friction);
  EXPECT_EQ(refused([](Memory& m) { m.touches[1].friction = -1e-300; }), friction);
  EXPECT_EQ(refused([](Memory& m) { std::swap(m.met[1], m.met[2]); }),
            "saved world: pairs that have met are in no order");
  const World made = bodies_by_hand();
  SavedBytes bytes = save(with_a_past(made));
  bytes.resize(bytes.size() - 7);  // a byte in place of the checksum
  Fnv hash;
  for (const std::uint8_t byte : bytes) hash.add(byte);
  for (int k = 0; k < 8; ++k) bytes.push_back(static_cast<std::uint8_t>(hash.value() >> 8 * k));
  EXPECT_EQ(refusal_of(made, bytes), "saved world: goes on behind its end");
}

TEST(SavedBytes, AreRefusedWithCandidatesThatCannotBe) {
  using Change = std::function<void(Memory&)>;
  const auto refused = [](const Change& change) {
    return refusal_after([&](World& w) { change(w.memory); });
  };
  EXPECT_EQ(refused([](Memory& m) { m.normals[1].of = static_cast<KeptNormal::Of>(3); }),
            "saved world: a kept normal is of no kind");
  for (const double norm : {1.0 - 1.1e-6, 1.0 - 0.9e-6, 1.0 + 0.9e-6, 1.0 + 1.1e-6}) {
    EXPECT_EQ(refused([&](Memory& m) { m.normals[2].n_AB *= norm; }),
              std::abs(norm - 1.0) < 1e-6 ? "accepted" : "saved world: a kept normal is not unit");
  }
  const char* const no_order = "saved world: candidates are in no order";
  EXPECT_EQ(refused([](Memory& m) { m.candidates[0] = m.candidates[1]; }), no_order);
  EXPECT_EQ(refused([](Memory& m) { std::swap(m.candidates[0], m.candidates[1]); }), no_order);
  const char* const no_body = "saved world: a candidate is of bodies that are not there";
  const auto with_pair = [&](bool both, BodyId a, BodyId b) {
    return refused([&](Memory& m) {
      Candidate& c = m.candidates[1];
      c = {key_of(both, a, b), a, b, c.first_normal, c.normals};
    });
  };
  EXPECT_EQ(with_pair(true, 3, 1), "accepted");
  EXPECT_EQ(with_pair(true, 3, 2), "accepted");
  EXPECT_EQ(with_pair(true, 6, 1), no_body);
  EXPECT_EQ(with_pair(true, 3, 6), no_body);
  EXPECT_EQ(refused([](Memory& m) { m.candidates[1].a = kLast; }), no_body);
  EXPECT_EQ(refused([](Memory& m) { m.candidates[1].key += 1; }), no_body);
  const char* const no_normal = "saved world: a candidate has normals that are not there";
  EXPECT_EQ(refused([](Memory& m) { m.candidates[1].first_normal = 2; }), no_normal);
  EXPECT_EQ(refused([](Memory& m) { m.candidates[1].normals = 1; }), no_normal);
  EXPECT_EQ(refused([](Memory& m) { m.candidates[0].normals = 1; }), no_normal);
}

TEST(SavedBytes, AreRefusedByAWorldOfAnyOtherParameter) {
  const World made = bodies_by_hand();
  const SavedBytes bytes = save(made);
  ASSERT_EQ(refusal_of(made, bytes), "accepted");
  const std::function<void(Parameters&)> changes[] = {
      [](Parameters& p) { p.rate_hz = 241; },
      [](Parameters& p) { p.gravity_W.x() = 1e-9; },
      [](Parameters& p) { p.response = "paper"; },
      [](Parameters& p) { p.query.mode = Query::paper; },
      [](Parameters& p) { p.query.cap = 19; },
      [](Parameters& p) { p.query.warm = true; },
      [](Parameters& p) { p.query.last = true; },
      [](Parameters& p) { p.query.margin = 1e-9; },
      [](Parameters& p) { p.friction_tau *= 2.0; },
      [](Parameters& p) { p.impact_speed *= 2.0; },
      [](Parameters& p) { p.solver_residual *= 2.0; },
      [](Parameters& p) { p.slop *= 2.0; },
      [](Parameters& p) { p.push *= 2.0; },
      [](Parameters& p) { p.sleep_speed *= 2.0; },
      [](Parameters& p) { p.sleep_spin *= 2.0; },
      [](Parameters& p) { p.sleep_after *= 2.0; },
      [](Parameters& p) { p.impacts += 1; },
      [](Parameters& p) { p.solver_iterations += 1; },
      [](Parameters& p) { p.rules = 13; },
      [](Parameters& p) { p.sleep = false; },
      [](Parameters& p) { p.keep_ledger = true; }};
  int number = 0;
  for (const auto& change : changes) {
    World other = made;
    change(other.parameters);
    EXPECT_EQ(refusal_of(other, bytes), "saved world: was made of other bodies or parameters")
        << number;
    ++number;
  }
  World shared = made;
  shared.parameters.threads = 2;
  EXPECT_EQ(refusal_of(shared, bytes), "accepted") << "the bits are the same";
}

}  // namespace
}  // namespace headpin::engine
