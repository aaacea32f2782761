#include "engine/world.h"

#include <array>
#include <cstring>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/save.h"
#include "tests/support/bowling.h"
#include "tests/support/random_shapes.h"

namespace headpin::engine {
namespace {

using testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

template <typename F>
std::string refusal(F&& f) {
  try {
    f();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

std::string refusal_of(const Body& body, const State& state = {}) {
  World world = make_world({});
  return refusal([&] { add_body(world, body, state); });
}

TEST(AddBody, RefusesWhatCannotBeAndSaysWhatAndWhere) {
  const Body good = ball_body({0.7, 0.7});
  EXPECT_EQ(refusal_of(good), "accepted");
  Body b = good;
  b.mass = 0.0;
  EXPECT_EQ(refusal_of(b), "body 0 'ball': mass [kg]: expected 1e-06 to 1e+06, found 0");
  b.mass = kNan;
  EXPECT_THAT(refusal_of(b), HasSubstr("mass"));
  b.mass = 1e12;
  EXPECT_THAT(refusal_of(b), HasSubstr("mass"));
  b = good;
  b.inertia = Mat3::Zero();
  EXPECT_THAT(refusal_of(b), HasSubstr("body 0 'ball': inertia"));
  b = good;
  b.material.elasticity = 1.01;
  EXPECT_EQ(refusal_of(b), "body 0 'ball': elasticity: expected 0 to 1, found 1.01");
  b = good;
  b.material.friction = -0.1;
  EXPECT_THAT(refusal_of(b), HasSubstr("friction"));
  b = good;
  b.shape = floor_shape();
  EXPECT_THAT(refusal_of(b), HasSubstr("half-space"));
  State s = at(Vec3(kNan, 0.0, 0.0));
  EXPECT_THAT(refusal_of(good, s), HasSubstr("finite"));
  s = {};
  s.w_WB.z() = std::numeric_limits<double>::infinity();
  EXPECT_THAT(refusal_of(good, s), HasSubstr("finite"));
  b = good;
  b.kind = Kind::fixed;
  s = {};
  s.v_WB.x() = 1.0;
  EXPECT_EQ(refusal_of(b, s), "body 0 'ball': is fixed, expected no velocity");
  s = {};
  s.X_WB.q = Quat(0.0, 0.0, 0.0, 0.0);
  EXPECT_THAT(refusal_of(good, s), HasSubstr("quaternion"));
}

TEST(AddBody, RefusesABodyDeepInsideAnother) {
  World world = make_world({});
  add_body(world, floor_body({}));
  State s;
  s.X_WB.p.z() = 0.0;  // half of the ball below the lane
  EXPECT_THAT(refusal([&] { add_body(world, ball_body({}), s); }),
              HasSubstr("body 1 'ball': overlap with body 0 'lane'"));
  s.X_WB.p.z() = kBallRadius;
  add_body(world, ball_body({}), s);
  EXPECT_THAT(refusal([&] { add_body(world, ball_body({}), s); }), HasSubstr("overlap"));
}

TEST(MakeWorld, RefusesParametersOutOfRange) {
  EXPECT_EQ(refusal([] { make_world({.rate_hz = 0}); }), "rate_hz: expected 1 to 1e+06, found 0");
  EXPECT_THAT(refusal([] { make_world({.gravity_W = Vec3(0, 0, kNan)}); }), HasSubstr("gravity"));
  EXPECT_THAT(refusal([] { make_world({.response = "magic"}); }), HasSubstr("paper, coulomb"));
  EXPECT_THAT(refusal([] { make_world({.friction_tau = 0.0}); }), HasSubstr("friction_tau"));
}

TEST(Step, StopsAndNamesTickAndBodyWhenAStateIsNoLongerFinite) {
  World world = make_world({});
  add_body(world, ball_body({}));
  run(world, 0.1);
  world.states[0].v_WB.x() = kNan;
  try {
    step(world);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "tick 24: body 0 'ball' is no longer at a finite place or speed");
  }
}

TEST(StateHash, ChangesWithEveryPartOfTheState) {
  const Bowling b = bowling({});
  const std::uint64_t hash = state_hash(b.world);
  EXPECT_EQ(state_hash(World(b.world)), hash);
  const auto changed = [&](auto&& change) {
    World w = b.world;
    change(w);
    return state_hash(w);
  };
  EXPECT_NE(changed([](World& w) { ++w.tick; }), hash);
  EXPECT_NE(changed([](World& w) { w.states[3].X_WB.p.x() += 1e-16; }), hash);
  EXPECT_NE(changed([](World& w) { w.states[3].X_WB.q.x() += 1e-300; }), hash);
  EXPECT_NE(changed([](World& w) { w.states[5].v_WB.y() = -0.0; }), hash);
  EXPECT_NE(changed([](World& w) { w.states[5].w_WB.z() = 1e-9; }), hash);
  EXPECT_NE(changed([](World& w) { w.asleep[7] = 1; }), hash);
}

// FNV-1a over tick, poses, velocities and sleep of each body, lowest byte first, as
// docs/hash-and-ledger.md says.
TEST(StateHash, IsFnv1aOfTheBytesOfTheState) {
  World world = make_world({});
  add_body(world, ball_body({}),
           at(Pose{Quat(0.5, 0.5, -0.5, 0.5), Vec3(1.0, -2.0, 3.5)}, Vec3(0.25, -0.0, 7.0),
              Vec3(1e-9, 2.0, -3.0)));
  world.tick = 77;
  std::uint64_t hash = 0xcbf29ce484222325;
  const auto add = [&](const void* number) {
    std::array<unsigned char, 8> bytes{};
    std::memcpy(bytes.data(), number, bytes.size());
    for (const unsigned char byte : bytes) hash = (hash ^ byte) * 0x100000001b3;
  };
  const std::int64_t tick = 77, asleep = 0;
  add(&tick);
  for (const double x : {1.0, -2.0, 3.5, 0.5, -0.5, 0.5, 0.5, 0.25, -0.0, 7.0, 1e-9, 2.0, -3.0}) {
    add(&x);
  }
  add(&asleep);
  EXPECT_EQ(state_hash(world), hash);
}

// Also where two balls touch in one point at the ends of their bounds.
TEST(Sleeper, FallsWhenTheBallBelowItIsTakenAway) {
  World world = make_world({});
  Body lower = ball_body({});
  lower.kind = Kind::driven;
  State s;
  const BodyId below = add_body(world, lower, s);
  s.X_WB.p.z() = 2.0 * kBallRadius;
  const BodyId above = add_body(world, ball_body({}), s);
  run(world, 2.0);
  ASSERT_TRUE(is_asleep(world, above));
  s.X_WB.p = Vec3(1.0, 0.0, 0.0);
  set_state(world, below, s);
  EXPECT_FALSE(is_asleep(world, above));
}

TEST(Sleeper, StandsOnAnythingUntilItIsReallyTouched) {
  // An ellipsoid on its tip: it cannot stand awake.
  RackOptions o;
  o.ball = false;
  World world = make_world({});
  add_body(world, floor_body({}));
  Body egg = skittle_body({});
  egg.shape = make_compound({{Ellipsoid{{0.0605, 0.0605, 0.19}}, Pose{}}});
  const State placed = at(Vec3(0, 0, 0.19));
  const BodyId sleeper = add_body(world, egg, placed);
  put_to_sleep(world, sleeper);
  // One ball passes at 1 mm, the next one hits.
  world.parameters.gravity_W = Vec3::Zero();
  State passing = at(Vec3(0.0605 + kBallRadius + 0.001, -1.0, 0.19), Vec3(0, 6, 0));
  const BodyId ball = add_body(world, ball_body({}), passing);
  run(world, 0.5);
  EXPECT_GT(world.states[ball].X_WB.p.y(), 1.0);
  EXPECT_TRUE(is_asleep(world, sleeper));
  EXPECT_EQ(world.states[sleeper].X_WB.p, placed.X_WB.p);
  passing.X_WB.p.x() -= 0.003;
  set_state(world, ball, passing);
  run(world, 0.5);
  EXPECT_GT(world.states[sleeper].v_WB.norm(), 0.1);
}

TEST(Sleeper, IsWokenByADrivenBody) {
  World world = make_world({});
  add_body(world, floor_body({}));
  const BodyId skittle = add_body(world, skittle_body({}), at(Vec3(0, 0, kSkittleHeight)));
  run(world, 1.0);
  ASSERT_TRUE(is_asleep(world, skittle));
  Body hand = ball_body({}, 0.05, 1.0);
  hand.kind = Kind::driven;
  const BodyId palm = add_body(world, hand, at(Vec3(-0.2, 0, 0.15), Vec3(0.5, 0, 0)));
  run(world, 0.1);
  EXPECT_TRUE(is_asleep(world, skittle));
  run(world, 0.9);
  EXPECT_LT(upright(world.states[skittle]), 0.9);
  EXPECT_NEAR(world.states[palm].X_WB.p.x(), 0.3, 1e-12);  // nothing stops a hand
}

TEST(SetKind, CarriesABallAndLetsItGoWithTheGivenVelocity) {
  World world = make_world({});
  add_body(world, floor_body({}));
  State s = at(Vec3(0, 0, 1.0));
  const BodyId ball = add_body(world, ball_body({}), s);
  set_kind(world, ball, Kind::driven);
  for (int i = 0; i < 24; ++i) {
    s.X_WB.p = Vec3(0, 0.01 * i, 1.0);
    s.v_WB = Vec3(0, 2.4, 0);
    set_state(world, ball, s);
    step(world);
  }
  EXPECT_NEAR(world.states[ball].X_WB.p.z(), 1.0, 1e-15);
  set_kind(world, ball, Kind::free);
  s = world.states[ball];
  s.v_WB = Vec3(0, 3.0, 1.0);
  set_state(world, ball, s);
  run(world, 0.25);
  EXPECT_NEAR(world.states[ball].X_WB.p.y(), s.X_WB.p.y() + 0.75, 1e-12);
  EXPECT_NEAR(world.states[ball].X_WB.p.z(), 1.0 + 0.25 - 0.5 * 9.81 * 0.0625, 1e-12);
}

/// A box on a driven box, on a slope. The lower one becomes free, or both change their kind.
///
/// @return  velocity of the upper or the lower box after one more step, which ends before it is solved
Vec3 let_go(bool lower_first, bool both) {
  World world = make_world({.gravity_W = Vec3(2.0, 0.0, -9.0), .response = "coulomb"});
  const Body box = solid(test::box({0.1, 0.1, 0.1}), Material{0.0, 0.9});
  const BodyId first = add_body(world, box, at(Vec3(0.0, 0.0, lower_first ? 0.1 : 0.3)));
  const BodyId second = add_body(world, box, at(Vec3(0.0, 0.0, lower_first ? 0.3 : 0.1)));
  const BodyId floor = add_body(world, floor_body(Material{0.0, 0.9}));
  const auto [lower, upper] = lower_first ? std::pair(first, second) : std::pair(second, first);
  EXPECT_GT(floor, upper);
  set_kind(world, lower, Kind::driven);
  run(world, 0.1);
  world.parameters.solver_iterations = 1;
  if (both) set_kind(world, upper, Kind::driven);
  set_kind(world, lower, Kind::free);
  step(world);
  return world.states[both ? lower : upper].v_WB;
}

// The step starts from the friction of the last step, whichever of the two bodies has the smaller number.
TEST(SetKind, KeepsTheDirectionOfFriction) {
  for (const bool both : {false, true}) {
    const Vec3 v = let_go(true, both), same = let_go(false, both);
    EXPECT_LT((v - same).norm(), 1e-9) << v.transpose() << " / " << same.transpose();
  }
}

/// A driven plate with a sleeper on it.
struct Plate {
  World world = make_world({});
  BodyId plate = 0, sleeper = 0;
};

Plate plate_with_a_sleeper() {
  Plate p;
  Body plate = ball_body({});
  plate.shape = make_compound({{Cylinder{0.2, 0.01}, Pose{}}});
  plate.kind = Kind::driven;
  State s = at(Vec3(0.0, 0.0, 1.0));
  p.plate = add_body(p.world, plate, s);
  s.X_WB.p.z() = 1.01 + kSkittleHeight;
  p.sleeper = add_body(p.world, skittle_body({}), s);
  run(p.world, 1.0);
  return p;
}

TEST(SleeperOnADrivenSupport, WakesWhenThatIsLetGoMovedOrPutElsewhere) {
  Plate p = plate_with_a_sleeper();
  ASSERT_TRUE(is_asleep(p.world, p.sleeper));
  const auto falls_after = [&](auto&& change) {
    Plate copy = p;
    change(copy);
    run(copy.world, 1.0);
    return copy.world.states[copy.sleeper].X_WB.p.z() < 1.0;
  };
  EXPECT_FALSE(falls_after([](Plate&) {}));
  EXPECT_TRUE(falls_after([](Plate& c) { set_kind(c.world, c.plate, Kind::free); }));
  EXPECT_TRUE(falls_after([](Plate& c) {  // in one move, without a speed
    State s = c.world.states[c.plate];
    s.X_WB.p.z() -= 0.3;
    set_state(c.world, c.plate, s);
  }));
  EXPECT_TRUE(falls_after([](Plate& c) {  // sinks by itself, slower than what counts as still
    State s = c.world.states[c.plate];
    s.v_WB.z() = -0.2;
    set_state(c.world, c.plate, s);
  }));
  // Slides: friction takes the skittle along.
  State s = p.world.states[p.plate];
  s.v_WB.x() = 0.05;
  set_state(p.world, p.plate, s);
  run(p.world, 1.0);
  EXPECT_NEAR(p.world.states[p.sleeper].X_WB.p.x(), 0.05, 0.01);
}

TEST(OutsideFixed, StopsACarriedBallAtTheLaneAndTakesItsSpeedIntoIt) {
  World world = make_world({});
  add_body(world, floor_body({}));
  Body wall = floor_body({});  // two millimetres, a metre ahead
  wall.shape = make_compound({{test::box(Vec3(1.0, 0.001, 1.0)), Pose{}}});
  State s = at(Vec3(0.0, 1.0, 1.0));
  add_body(world, wall, s);
  s.X_WB.p = Vec3(0.0, 0.0, 0.5);
  const BodyId ball = add_body(world, ball_body({}), s);
  set_kind(world, ball, Kind::driven);
  State wanted;
  wanted.X_WB.p = Vec3(0.1, 0.2, -0.2);  // the hand is under the lane
  wanted.v_WB = Vec3(1.0, 2.0, -3.0);
  const State held = outside_fixed(world, ball, wanted);
  EXPECT_NEAR((held.X_WB.p - Vec3(0.1, 0.2, kBallRadius)).norm(), 0.0, 1e-6);
  EXPECT_NEAR((held.v_WB - Vec3(1.0, 2.0, 0.0)).norm(), 0.0, 1e-9);
  wanted.X_WB.p = Vec3(0.0, 1.5, 0.5);  // beyond the wall, in one tick
  const State stopped = outside_fixed(world, ball, wanted);
  EXPECT_NEAR(stopped.X_WB.p.y(), 1.0 - 0.001 - kBallRadius, 1e-6);
  EXPECT_NEAR(stopped.v_WB.y(), 0.0, 1e-9);
  wanted.X_WB.p = Vec3(0.3, 0.1, 0.8);  // nothing in the way
  EXPECT_EQ(outside_fixed(world, ball, wanted).X_WB.p, wanted.X_WB.p);
  EXPECT_EQ(outside_fixed(world, ball, wanted).v_WB, wanted.v_WB);
}

TEST(Events, TellTheFirstMeetingOfTwoBodiesOnce) {
  Bowling b = bowling({});
  int firsts = 0;
  std::int64_t tick = 0;
  for (int i = 0; i < 2 * 240; ++i) {
    step(b.world);
    for (const ContactEvent& e : b.world.events) {
      EXPECT_NE(e.a, e.b);
      EXPECT_NEAR(e.n_AB_W.norm(), 1.0, 1e-12);
      const bool head_pin = (e.a == b.skittles[0] && e.b == b.balls[0]) ||
                            (e.b == b.skittles[0] && e.a == b.balls[0]);
      if (!head_pin || !e.first) continue;
      ++firsts;
      tick = b.world.tick;
      EXPECT_GT(e.approach_speed, 4.0);
      EXPECT_GT(e.impulse_W.norm(), 5.0);
    }
  }
  EXPECT_EQ(firsts, 1);
  // The ball's surface has 1.5 m less both radii to go at 6 m/s.
  EXPECT_NEAR(static_cast<double>(tick) / 240, (1.5 - kBallRadius - 0.05) / 6.0, 0.02);
}

TEST(Events, TellAMeetingAgainOfABodyThatForgets) {
  World world = make_world({});
  const BodyId floor = add_body(world, floor_body({}));
  const BodyId ball = add_body(world, ball_body({}, kBallRadius, 7.0),
                               {{Quat::Identity(), Vec3(0.0, 0.0, kBallRadius)}});
  const auto firsts = [&] {
    step(world);
    return std::ranges::count_if(world.events, &ContactEvent::first);
  };
  EXPECT_EQ(firsts(), 1);
  EXPECT_EQ(firsts(), 0);
  forget_meetings(world, ball);
  EXPECT_EQ(firsts(), 1);
  EXPECT_EQ(firsts(), 0);
  forget_meetings(world, floor);
  EXPECT_EQ(firsts(), 1);
  EXPECT_THROW(forget_meetings(world, 2), std::invalid_argument);
}

TEST(SetResponse, OfCoulombsFunctionsGivesCoulombsBitsUnderItsOwnName) {
  const Response own{"mine", coulomb_impulse, coulomb_sliding, "what Coulomb's keeps"};
  RackOptions coulomb;
  coulomb.parameters.response = "coulomb";
  Bowling expected = bowling(coulomb), paper = bowling({}), given = bowling({});
  set_response(given.world, own);
  EXPECT_EQ(given.world.parameters.response, "mine");
  for (Bowling* b : {&expected, &paper, &given}) run(b->world, 2.0);
  EXPECT_EQ(state_hash(given.world), state_hash(expected.world));
  EXPECT_NE(state_hash(given.world), state_hash(paper.world));
  // A world under another law does not go on from its state.
  const std::vector<std::uint8_t> saved = save(given.world);
  EXPECT_THAT(refusal([&] { restore(expected.world, saved); }),
              HasSubstr("other bodies or parameters"));
  EXPECT_EQ(state_hash(restore(given.world, saved)), state_hash(given.world));
}

/// The first impulse on the floor of a tilted rod that falls from rest, of a world that is turned by `turn`, turned
/// back.
Vec3 landing(int rules, const Quat& turn) {
  World world = make_world(
      {.gravity_W = turn * Vec3(0.0, 0.0, -9.81), .response = "coulomb", .rules = rules});
  add_body(world,
           {.name = "floor",
            .shape = make_compound({{HalfSpace{}, {}}}),
            .material = {0.7, 0.5},
            .kind = Kind::fixed},
           {.X_WB = {turn, Vec3::Zero()}});
  Body rod{.name = "rod",
           .shape = make_compound({{Cylinder{0.03, 0.2}, {}}}),
           .mass = 1.5,
           .material = {0.7, 0.3}};
  rod.inertia = 1.5 * Vec3(0.0137, 0.0137, 0.00045).asDiagonal();
  const BodyId falling = add_body(
      world, rod, {.X_WB = {turn * rotation({0.0, 0.6, 0.0}), turn * Vec3(0.0, 0.0, 0.5)}});
  while (world.events.empty() && world.tick < 240) step(world);
  if (world.events.empty()) return Vec3::Zero();
  const ContactEvent& first = world.events.front();
  return turn.inverse() * Vec3((first.a == falling ? 1.0 : -1.0) * first.impulse_W);
}

// A rod that lands off-centre begins to slip as it is struck; since rules 8 friction opposes that.
TEST(Coulomb, StrikesABodyThatFallsFromRestAlikeInEveryFrame) {
  const Quat turned = rotation({0.5, 0.0, 0.0}), other = rotation({1.2, 0.4, 0.8});
  const Vec3 F = landing(8, Quat::Identity());
  ASSERT_GT(F.z(), 0.1);
  EXPECT_NEAR(F.head<2>().norm() / F.z(), 0.15, 1e-6);  // 0.5 times 0.3
  EXPECT_LT((landing(8, turned) - F).norm(), 1e-6 * F.norm());
  EXPECT_LT((landing(8, other) - F).norm(), 1e-6 * F.norm());
  EXPECT_LT(landing(7, Quat::Identity()).head<2>().norm(), 1e-9);
}

TEST(TakeOver, IsOfAWorldWithTheSameNumberOfBodies) {
  World one = make_world({}), two = make_world({});
  add_body(one, ball_body({}));
  EXPECT_EQ(refusal([&] { take_over(two, one); }),
            "take_over: expected a world with 0 bodies, found 1");
}

TEST(SetFriction, TakesNoTableWithoutColumns) {
  World world = make_world({});
  const BodyId lane = add_body(
      world, {.name = "lane", .shape = make_compound({{HalfSpace{}, {}}}), .kind = Kind::fixed});
  const auto said = [&](const FrictionTable& table) {
    return refusal(
        [&] { set_friction(world, lane, std::make_shared<const FrictionTable>(table)); });
  };
  EXPECT_THAT(said({.columns = 0, .edges = {}, .friction = {}}),
              HasSubstr("columns of the table of friction"));
  EXPECT_THAT(said({.low_x = kNan, .edges = {}, .friction = {}}),
              HasSubstr("begin of the table of friction"));
}

// A ball that spins falls on a floor; the law is changed while it is so near that the step looks for a touch.
TEST(SetResponse, IsTheLawOfBodiesThatAreAboutToTouch) {
  const auto landed = [](bool late) {
    World world = make_world({.response = late ? "paper" : "coulomb"});
    add_body(world, floor_body({0.2, 0.5}));
    add_body(world, ball_body({0.0, 0.5}),
             at(Vec3(0.0, 0.0, 0.3), Vec3::Zero(), Vec3(0.0, 80.0, 0.0)));
    int near = 0;  // steps
    while (world.statistics.contacts == 0 && world.statistics.impacts == 0) {
      step(world);
      if (late && !world.memory.touches.empty() && near++ == 0)
        set_response(world, response_named("coulomb"));
    }
    EXPECT_EQ(near > 0, late);
    for (int i = 0; i < 100; ++i) step(world);
    return state_hash(world);
  };
  EXPECT_EQ(landed(true), landed(false));
}

TEST(Statistics, CountWhatHappened) {
  Bowling b = bowling({});
  Statistics sum;
  for (int i = 0; i < 480; ++i) {
    step(b.world);
    sum += b.world.statistics;
  }
  EXPECT_EQ(sum.steps, 480);
  EXPECT_GT(sum.contacts, 480);
  EXPECT_GT(sum.impacts, 5);
  EXPECT_GE(sum.queries.queries, sum.pairs);
  EXPECT_EQ(sum.unfinished_impacts, 0);
}

}  // namespace
}  // namespace headpin::engine
