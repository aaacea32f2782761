#include "engine/save.h"

#include <algorithm>
#include <cstdlib>
#include <iterator>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/hash.h"
#include "engine/workspace.h"
#include "tests/support/bowling.h"
#include "tests/support/folder.h"
#include "tests/support/random_shapes.h"
#include "tests/support/scale.h"

namespace headpin::engine {
namespace {

using testing::HasSubstr;
using Bytes = std::vector<std::uint8_t>;

constexpr int kTicks = 1920;  // 8 s
constexpr int kOn = 60;       // ticks that a restored world is followed

/// Racks with a ball each, and a hand that carries another ball, throws it, waits and sets up the
/// skittles again: all that a session does to a world.
struct Scene {
  Bowling bowling;
  BodyId hand = 0, carried = 0;
  std::vector<State> placed;
};

Scene make_scene(int racks, bool keep_ledger = true) {
  RackOptions o;
  o.racks = racks;
  o.parameters.keep_ledger = keep_ledger;
  Scene s{engine::bowling(o), 0, 0, {}};
  World& world = s.bowling.world;
  Body hand = ball_body({0.7, 0.7}, 0.05);
  hand.kind = Kind::driven;
  const auto at = [](double y, double z) {
    return State{.X_WB = {Quat::Identity(), {0.02, y, z}}};
  };
  s.hand = add_body(world, hand, at(-4.0, 1.0));
  s.carried = add_body(world, ball_body({0.7, 0.7}), at(-4.5, kBallRadius));
  s.placed = world.states;
  return s;
}

/// What is done to the world before its step of this tick, and the step.
void advance(const Scene& scene, World& world, Workspace& w) {
  const std::int64_t tick = world.tick, t = tick % 960;
  const auto carry = [&](BodyId i, double y) {
    State s = world.states[i];
    s.v_WB = Vec3(0.0, 5.0, 0.0);
    s.X_WB.p.y() = y;
    s.X_WB.p.z() = i == scene.hand ? 0.6 : kBallRadius + 0.01;
    set_state(world, i, s);
  };
  if (t == 200) set_kind(world, scene.carried, Kind::driven);
  if (t >= 200 && t < 280) carry(scene.carried, -4.5 + 0.02 * static_cast<double>(t - 200));
  if (t == 280) set_kind(world, scene.carried, Kind::free);
  if (t >= 300 && t < 320) carry(scene.hand, -3.0 + 0.02 * static_cast<double>(t - 300));
  if (t == 320) set_state(world, scene.hand, scene.placed[scene.hand]);
  if (t == 900) {
    for (const BodyId i : scene.bowling.skittles) {
      set_state(world, i, scene.placed[i]);
      put_to_sleep(world, i);
      forget_meetings(world, i);
    }
    set_state(world, scene.carried, scene.placed[scene.carried]);
    for (const BodyId i : scene.bowling.balls) set_state(world, i, scene.placed[i]);
  }
  step(world, w);
}

std::uint64_t hash_with_events(const World& world) {
  std::uint64_t hash = state_hash(world);
  for (const ContactEvent& e : world.events) {
    hash = hash * 31 + e.a * 7 + e.b * 3 + (e.first ? 1 : 0);
  }
  return hash;
}

void goes_on_from_random_ticks(int racks, int ticks) {
  const Scene scene = make_scene(racks);
  World world = scene.bowling.world;
  Workspace w, other;
  Random random(71);
  std::vector<int> chosen(kTicks);
  for (int k = 0; k < ticks; ++k)
    ++chosen[static_cast<std::size_t>(index_below(random, kTicks - kOn))];
  std::vector<Bytes> saved;
  std::vector<std::uint64_t> hashes;
  std::vector<Ledger> ledgers;
  std::vector<std::size_t> from;
  for (std::size_t k = 0; k < kTicks; ++k) {
    if (chosen[k] > 0) {
      saved.push_back(save(world));
      from.push_back(k);
    }
    advance(scene, world, w);
    hashes.push_back(hash_with_events(world));
    ledgers.push_back(world.ledger);
  }
  for (std::size_t n = 0; n < saved.size(); ++n) {
    World later = restore(scene.bowling.world, saved[n]);
    ASSERT_EQ(save(later), saved[n]) << from[n];
    for (std::size_t k = from[n]; k < from[n] + kOn; ++k) {
      advance(scene, later, other);
      ASSERT_EQ(hash_with_events(later), hashes[k]) << "from " << from[n] << " at " << k;
    }
    const Balance a = later.ledger.sum(), b = ledgers[from[n] + kOn - 1].sum();
    EXPECT_EQ(a.energy, b.energy) << from[n];
    EXPECT_EQ(a.momentum, b.momentum) << from[n];
  }
}

TEST(SavedWorld, GoesOnToTheBitFromAnyOf500TicksOfASession) {
  goes_on_from_random_ticks(1, 500);
}

TEST(SavedWorld, GoesOnToTheBitFromAnyOf500TicksOfACrowd) {
  goes_on_from_random_ticks(kThorough ? 9 : 4, cases(500));
}

// Run once more as a process of its own, which is told where the bytes are.
constexpr const char* kTold = "HEADPIN_SAVED_WORLD";

TEST(SavedWorld, GoesOnToTheBitInAnotherProcess) {
  const Scene scene = make_scene(1);
  Workspace w;
  const auto hash_after = [&](World world) {
    for (int k = 0; k < 300; ++k) advance(scene, world, w);
    return std::to_string(state_hash(world));
  };
  if (const char* const file = std::getenv(kTold)) {
    std::ifstream in(file, std::ios::binary);
    const Bytes bytes{std::istreambuf_iterator<char>(in), {}};
    std::ofstream(std::string(file) + ".hash") << hash_after(restore(scene.bowling.world, bytes));
    return;
  }
  World world = scene.bowling.world;
  for (int k = 0; k < 150; ++k) advance(scene, world, w);
  const auto file = fresh_folder("saved") / "world";
  const Bytes bytes = save(world);
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
  const std::string me = std::filesystem::read_symlink("/proc/self/exe").string();
  const std::string alone = "env -u GTEST_TOTAL_SHARDS -u GTEST_SHARD_INDEX ";
  ASSERT_EQ(std::system((alone + kTold + "='" + file.string() + "' '" + me +
                         "' --gtest_filter=SavedWorld.GoesOnToTheBitInAnotherProcess >'" +
                         file.string() + ".out'")
                            .c_str()),
            0);
  std::ifstream in(file.string() + ".hash");
  std::string found;
  in >> found;
  EXPECT_EQ(found, hash_after(world));
}

std::string refusal(const World& made, std::span<const std::uint8_t> bytes) {
  try {
    restore(made, bytes);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

/// The bytes with the checksum that belongs to them.
Bytes signed_anew(Bytes bytes) {
  Fnv hash;
  for (std::size_t k = 0; k + 8 < bytes.size(); ++k) hash.add(bytes[k]);
  for (std::size_t k = 0; k < 8; ++k) {
    bytes[bytes.size() - 8 + k] = static_cast<std::uint8_t>(hash.value() >> 8 * k);
  }
  return bytes;
}

struct AmongCollisions {
  Scene scene = make_scene(1);
  World world = scene.bowling.world;
  Workspace w;
  Bytes bytes;
  AmongCollisions() {
    for (int k = 0; k < 80; ++k) advance(scene, world, w);
    bytes = save(world);
  }
};

TEST(SavedWorld, IsRefusedWhenCutOffOrChangedAnywhere) {
  const AmongCollisions at;
  const World& made = at.scene.bowling.world;
  EXPECT_EQ(refusal(made, at.bytes), "accepted");
  for (std::size_t size = 0; size < at.bytes.size(); ++size) {
    ASSERT_THAT(refusal(made, std::span(at.bytes).first(size)), HasSubstr("saved world: ")) << size;
  }
  for (std::size_t k = 0; k < at.bytes.size(); ++k) {
    Bytes changed = at.bytes;
    changed[k] ^= static_cast<std::uint8_t>(1u << k % 8);
    ASSERT_THAT(refusal(made, changed), HasSubstr("saved world: ")) << k;
  }
  EXPECT_EQ(refusal(made, Bytes(20, 0)),
            "saved world: expected the bytes of a saved world, found others");
}

/// Whether a step of it takes no longer than others.
bool is_in_reason(const World& world) {
  return std::all_of(world.states.begin(), world.states.end(), [](const State& s) {
    return s.X_WB.p.norm() < 1e3 && s.v_WB.norm() < 1e2 && s.w_WB.norm() < 1e2;
  });
}

// Who changes bytes and signs them gets a clear refusal, or a world that can be stepped.
TEST(SavedWorld, IsHarmlessWhateverItsBytes) {
  const AmongCollisions at;
  const World& made = at.scene.bowling.world;
  Random random(72);
  int refused = 0, stepped = 0;
  for (int k = 0; k < cases(4000); ++k) {
    Bytes bytes = at.bytes;
    for (int n = 1 + index_below(random, 3); n > 0; --n) {
      bytes[static_cast<std::size_t>(index_below(random, static_cast<int>(bytes.size())))] =
          static_cast<std::uint8_t>(random.next());
    }
    if (index_below(random, 4) == 0)
      bytes.resize(static_cast<std::size_t>(index_below(random, 8000)), 0);
    if (bytes.size() < 8) continue;
    bytes = signed_anew(std::move(bytes));
    try {
      World world = restore(made, bytes);
      Workspace w;
      if (is_in_reason(world)) step(world, w);
      for (BodyId i = 0; i < world.bodies.size(); ++i) wake(world, i);
      ++stepped;
    } catch (const std::invalid_argument& error) {
      ASSERT_THAT(error.what(), HasSubstr("saved world: "));
      ++refused;
    } catch (const std::runtime_error& error) {
      ASSERT_THAT(error.what(), HasSubstr("no longer at a finite place"));
    }
  }
  EXPECT_GT(refused, 100);
  EXPECT_GT(stepped, 100);
}

TEST(SavedWorld, IsRefusedByAWorldOfOtherBodiesOrParameters) {
  const AmongCollisions at;
  const char* const other = "saved world: was made of other bodies or parameters";
  EXPECT_EQ(refusal(make_scene(2).bowling.world, at.bytes), other);
  EXPECT_EQ(refusal(make_scene(1, false).bowling.world, at.bytes), other);
  World heavier = at.scene.bowling.world;
  heavier.bodies[3].mass *= 1.0 + 1e-15;
  EXPECT_EQ(refusal(heavier, at.bytes), other);
  World rougher = at.scene.bowling.world;
  rougher.bodies[at.scene.bowling.lane].material.friction = 0.1;
  EXPECT_EQ(refusal(rougher, at.bytes), other);
  World coulombs = at.scene.bowling.world;
  coulombs.parameters.response = "coulomb";
  EXPECT_EQ(refusal(coulombs, at.bytes), other);
}

TEST(SavedWorld, IsRefusedByAWorldOfOtherFrictionFacesOrDetection) {
  const AmongCollisions at;
  const char* const other = "saved world: was made of other bodies or parameters";
  World world = at.scene.bowling.world;
  Body& lane = world.bodies[at.scene.bowling.lane];
  lane.areas = {{{-1.0, 0.0}, {1.0, 2.0}, 0.05}};
  EXPECT_EQ(refusal(world, at.bytes), other);
  const Bytes oiled = save(world);
  EXPECT_EQ(refusal(world, oiled), "accepted");
  lane.areas[0].high.y() = 2.5;
  EXPECT_EQ(refusal(world, oiled), other);
  world = at.scene.bowling.world;
  world.bodies[at.scene.bowling.lane].exact = !world.bodies[at.scene.bowling.lane].exact;
  EXPECT_EQ(refusal(world, at.bytes), other);
  for (bool Query::*flag : {&Query::steady, &Query::faces, &Query::boxes}) {
    world = at.scene.bowling.world;
    world.parameters.query.*flag = !(world.parameters.query.*flag);
    EXPECT_EQ(refusal(world, at.bytes), other);
  }
  const auto box_with = [](const std::vector<std::vector<std::uint32_t>>& faces) {
    std::vector<Vec3> corners;
    for (int k = 0; k < 8; ++k) {
      corners.emplace_back(0.1 * ((k & 1) != 0 ? 1.0 : -1.0), 0.1 * ((k & 2) != 0 ? 1.0 : -1.0),
                           0.1 * ((k & 4) != 0 ? 1.0 : -1.0));
    }
    World made = make_world({});
    add_body(
        made,
        {.name = "box", .shape = make_compound({{Polyhedron(corners, faces), {}}}), .mass = 1.0});
    return made;
  };
  const std::vector<std::vector<std::uint32_t>> rest = {
      {0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {4, 5, 7, 6}};
  std::vector<std::vector<std::uint32_t>> whole = rest, halves = rest;
  whole.push_back({0, 2, 3, 1});
  halves.push_back({0, 2, 3});
  halves.push_back({0, 3, 1});
  EXPECT_EQ(refusal(box_with(whole), save(box_with(whole))), "accepted");
  EXPECT_EQ(refusal(box_with(halves), save(box_with(whole))), other);
}

TEST(SavedWorld, IsRefusedByAWorldOfOtherShapes) {
  const auto world_of = [](const Part& part) {
    World world = make_world({});
    Body body = ball_body({});
    body.shape = make_compound({{Ellipsoid{Vec3::Constant(0.05)}, {}}, part});
    add_body(world, body);
    return world;
  };
  const Quat turned(std::sqrt(0.5), 0.0, std::sqrt(0.5), 0.0);
  const Part cone{Cone{0.1, 0.2}, {}};
  const std::vector<std::uint8_t> bytes = save(world_of(cone));
  EXPECT_EQ(refusal(world_of(cone), bytes), "accepted");
  for (const Part& other :
       {Part{Cone{0.1, 0.21}, {}}, Part{Cone{0.11, 0.2}, {}}, Part{Cylinder{0.1, 0.2}, {}},
        Part{Cone{0.1, 0.2}, {turned, Vec3::Zero()}},
        Part{Cone{0.1, 0.2}, {Quat::Identity(), {0.0, 0.0, 0.01}}}}) {
    EXPECT_NE(refusal(world_of(other), bytes), "accepted");
  }
}

TEST(SavedWorld, HasTheTouchesOfTheStepBefore) {
  const Bowling made = bowling({});
  Bowling b = made;
  int met = 0;
  for (int tick = 0; tick < 480; ++tick) {
    run(b.world, 1.0 / 240.0);
    const World restored = restore(made.world, save(b.world));
    const std::vector<PastTouch>& was = b.world.memory.touches;
    ASSERT_EQ(restored.memory.touches.size(), was.size());
    for (std::size_t i = 0; i < was.size(); ++i) {
      const PastTouch& is = restored.memory.touches[i];
      met += was[i].met;
      ASSERT_EQ(is.key, was[i].key) << tick;
      ASSERT_EQ(is.met, was[i].met) << tick;
      ASSERT_EQ(is.struck, was[i].struck) << tick;
    }
  }
  EXPECT_GT(met, 10);
}

// Under rules 10 the parts of a fixed body have touches of their own.
TEST(SavedWorld, GoesOnToTheBitWhereSeveralPartsOfABodyAreTouched) {
  World made = make_world({.response = "coulomb"});
  std::vector<Part> parts;
  for (int k = 0; k < 4; ++k) {  // a trough of two sides, each of two boards
    const double side = k % 2 == 0 ? -1.0 : 1.0;
    parts.push_back({test::box({0.05, 1.0, 0.3}),
                     {rotation(Vec3(0.0, side * 0.7, 0.0)), Vec3(0.12 * side, k / 2 * 2.0, 0.0)}});
  }
  add_body(made, {.name = "trough",
                  .shape = make_compound(parts),
                  .material = {0.5, 0.9},
                  .kind = Kind::fixed});
  add_body(made, ball_body({0.5, 0.9}), at(Vec3(0.0, 0.5, 0.4), Vec3(0.0, 2.0, 0.0)));
  World world = made;
  for (int k = 0; k < 120; ++k) step(world);
  ASSERT_GT(world.memory.touches.size(), 1u) << "the test asks nothing";
  World restored = restore(made, save(world));
  for (int k = 0; k < 60; ++k) {
    step(world);
    step(restored);
    ASSERT_EQ(hash_with_events(restored), hash_with_events(world)) << k;
  }
}

}  // namespace
}  // namespace headpin::engine
