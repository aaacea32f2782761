#include "engine/stages.h"

#include <cmath>

#include <gtest/gtest.h>

#include "engine/at_end.h"
#include "tests/support/bowling.h"
#include "tests/support/random_shapes.h"

// Each stage of a step alone: two bodies, one call, a look at what it gives.
namespace headpin::engine {
namespace {

using namespace detail;

constexpr int kRate = 240;
constexpr double kStep = 1.0 / kRate, kG = 9.81, kMass = 7.0;

/// A ball over a lane, bodies 0 and 1, with elasticity 1 and no friction.
World ball_over_lane(double gap, double down = 0.0) {
  World world = make_world({.rate_hz = kRate});
  add_body(world, floor_body({1.0, 0.0}));
  add_body(world, ball_body({1.0, 0.0}),
           at(Vec3(0.0, 0.0, kBallRadius + gap), Vec3(0.0, 0.0, -down)));
  return world;
}

/// Two balls in free space, bodies 0 and 1, that come at each other along x.
World two_balls(double gap, double closing) {
  World world = make_world({.rate_hz = kRate, .gravity_W = Vec3::Zero()});
  for (const double side : {-1.0, 1.0}) {
    add_body(world, ball_body({1.0, 0.0}),
             at(Vec3(side * (kBallRadius + 0.5 * gap), 0.0, 0.0),
                Vec3(-side * 0.5 * closing, 0.0, 0.0)));
  }
  return world;
}

/// Time in which a ball falls through a gap: g t^2 / 2 + v t = gap.
double fall_time(double gap, double down) {
  return (std::sqrt(down * down + 2.0 * kG * gap) - down) / kG;
}

// In a step gravity adds g dt to the velocity, and no more than g dt^2 to the way.
TEST(FindTouches, GivesTheBallThatMayReachTheLaneWithinTheStepAndNoOther) {
  const double way = 5.0 * kStep + kG * kStep * kStep;
  Workspace w;
  World far = ball_over_lane(way + 2e-3, 5.0), near = ball_over_lane(0.999 * way, 5.0);
  EXPECT_TRUE(find_touches(far, w).all.empty());
  EXPECT_EQ(find_touches(near, w).all.size(), 1u);  // and its point is left to the next step
  const double gap = 4.0 * kStep;
  World hit = ball_over_lane(gap, 5.0);
  const Touches& touches = find_touches(hit, w);
  ASSERT_EQ(touches.all.size(), 1u);
  const Touch& touch = touches.all[0];
  EXPECT_EQ(touch.a, 1u);  // the free one
  EXPECT_EQ(touch.b, 0u);
  EXPECT_TRUE(touch.fresh);
  EXPECT_FALSE(touch.b_moves);
  ASSERT_EQ(touch.points, 1u);
  const ContactPoint& point = touches.points[touch.first_point];
  EXPECT_NEAR(point.depth, -gap, 1e-12);
  EXPECT_EQ(point.n_AB_W, Vec3(0.0, 0.0, -1.0));
  EXPECT_NEAR(touches.due[0], fall_time(gap, 5.0), 1e-9);
}

TEST(FindTouches, WakesASleeperThatSomethingIsAboutToHit) {
  World world = two_balls(1e-3, 2.0);
  put_to_sleep(world, 0);
  Workspace w;
  EXPECT_EQ(find_touches(world, w).all.size(), 1u);
  EXPECT_FALSE(is_asleep(world, 0));
}

// Equal balls exchange their velocities, when the gap is closed.
TEST(ResolveImpacts, ExchangesTheVelocitiesOfEqualBallsWhereTheyMeet) {
  const double gap = 4e-3, closing = 3.0;
  World world = two_balls(gap, closing);
  Workspace w;
  Touches& touches = find_touches(world, w);
  const Flight* const flight = resolve_impacts(world, touches, w);
  ASSERT_NE(flight, nullptr);
  ASSERT_EQ(flight->struck.size(), 2u);
  for (const BodyId i : {0u, 1u}) {
    EXPECT_NEAR(flight->bodies[i].clock, gap / closing, 1e-6 / closing);
    EXPECT_EQ(flight->bodies[i].impacts, 1);
    EXPECT_NEAR(world.states[i].v_WB.x(), (i == 0 ? -0.5 : 0.5) * closing, 1e-12);
  }
  EXPECT_TRUE(flight->touches[0].struck);
  ASSERT_EQ(world.events.size(), 1u);
  EXPECT_NEAR(world.events[0].approach_speed, closing, 1e-12);
}

TEST(ResolveImpacts, LeavesTheBodiesAloneThatDoNotMeetWithinTheStep) {
  World world = two_balls(13e-3, 3.0);  // a step's way is 12.5 mm
  Workspace w;
  const Flight* const flight = resolve_impacts(world, find_touches(world, w), w);
  ASSERT_NE(flight, nullptr);
  EXPECT_TRUE(flight->struck.empty());
  EXPECT_EQ(flight->bodies[0].clock, 0.0);
}

/// A ball that lies on the lane and has just got the velocity that gravity gives in a step.
struct Lying {
  World world = ball_over_lane(0.0);
  Workspace w;
  Touches& touches = find_touches(world, w);
  const Flight& flight = *resolve_impacts(world, touches, w);
  Lying() { world.states[1].v_WB.z() -= kG * kStep; }
};

TEST(Sustain, CarriesTheWeightOfABallThatLies) {
  Lying at;
  const Solved& solved = sustain(at.world, at.touches, at.flight, at.w);
  ASSERT_EQ(solved.loads.size(), 1u);
  EXPECT_NEAR(solved.loads[0].impulse, kMass * kG * kStep, 1e-9);
  EXPECT_NEAR(solved.carried[1], 1.0, 1e-9);
  EXPECT_NEAR(at.world.states[1].v_WB.z(), 0.0, 1e-12);
  EXPECT_TRUE(at.world.memory.bodies[1].supported);
}

// A rod that turns fast beside the lane would end deep in it, by an end that is not near it now.
TEST(StopSwings, KeepsTheEndOfARodOutOfTheLane) {
  World world = make_world({.rate_hz = 60, .gravity_W = Vec3::Zero()});
  add_body(world, floor_body({0.0, 0.0}));
  Body rod = ball_body({0.0, 0.0});
  const double half = 0.5;
  rod.shape = make_compound(
      {{Cylinder{0.01, half}, {rotation({0.0, 0.5 * 3.14159265, 0.0}), Vec3::Zero()}}});
  rod.inertia = Vec3(1e-3, 0.6, 0.6).asDiagonal();
  add_body(world, rod, at(Vec3(0.0, 0.0, 0.0101), Vec3::Zero(), Vec3(0.0, 20.0, 0.0)));
  Workspace w;
  depart(world, w);
  Touches touches = find_touches(world, w);
  const Flight flight = w.flight;  // as if no impact had come of it
  w.flight.touches.assign(touches.all.size(), {});
  Solved& solved = sustain(world, touches, w.flight, w);
  world.states[1].w_WB = Vec3(0.0, 20.0, 0.0);  // as if the contacts had let it turn on
  world.states[1].v_WB = Vec3::Zero();
  const auto lowest = [&] {
    const Pose X_WB = pose_at_end(world, w.flight, solved, 1);
    return X_WB.p.z() - half * std::abs((X_WB.q * Vec3::UnitX()).z());
  };
  ASSERT_LT(lowest(), -0.1);
  stop_swings(world, touches, w.flight, solved, w);
  EXPECT_TRUE(solved.touches[0].swings);
  EXPECT_GT(lowest(), -0.02);
  EXPECT_LT(world.states[1].w_WB.norm(), 20.0);
}

// z = -g t^2 / 2, the velocity at the end being -g t.
TEST(Move, LetsAFreeBodyFallAlongItsParabolaAndACarriedOneGoByItsVelocity) {
  for (const double carried : {0.0, 1.0}) {
    World world = ball_over_lane(1.0);
    Workspace w;
    depart(world, w);
    w.solved.carried.assign(2, carried);
    w.solved.slowed.assign(2, Vec3::Zero());
    world.states[1].v_WB = Vec3(2.0, 0.0, -kG * kStep);
    const Vec3 start = world.states[1].X_WB.p;
    move(world, w.flight, w.solved, w);
    const Vec3 moved = world.states[1].X_WB.p - start;
    EXPECT_NEAR(moved.x(), 2.0 * kStep, 1e-12);
    EXPECT_NEAR(moved.z(), -(carried > 0.0 ? 1.0 : 0.5) * kG * kStep * kStep, 1e-12);
  }
}

TEST(PushApart, TakesBackItsPartOfAnOverlapAndGivesNoSpeed) {
  const double depth = 1e-3;
  World world = ball_over_lane(-depth);
  Workspace w;
  Touches& touches = find_touches(world, w);
  const Flight& flight = *resolve_impacts(world, touches, w);
  const Solved& solved = sustain(world, touches, flight, w);
  const double z = world.states[1].X_WB.p.z();
  const Vec3 v = world.states[1].v_WB;
  push_apart(world, touches, flight, solved, w);
  const Parameters& p = world.parameters;  // at 240 Hz `push` of what is over the slop
  EXPECT_NEAR(world.states[1].X_WB.p.z() - z, p.push * (depth - p.slop), 1e-12);
  EXPECT_EQ(world.states[1].v_WB, v);
}

TEST(FallAsleep, LetsABallSleepThatHasBeenStillForLongEnoughAndIsCarried) {
  const int enough = static_cast<int>(0.25 * kRate);
  for (const int before : {enough - 2, enough - 1}) {
    Lying at;
    Solved& solved = sustain(at.world, at.touches, at.flight, at.w);
    at.world.memory.bodies[1].still = before;
    fall_asleep(at.world, at.touches, at.flight, solved);
    EXPECT_EQ(is_asleep(at.world, 1), before + 1 >= enough);
  }
}

TEST(Remember, LeavesTheNextStepWhatATouchCarried) {
  Lying at;
  Solved& solved = sustain(at.world, at.touches, at.flight, at.w);
  const double carried = solved.loads[0].impulse;
  remember(at.world, at.touches, at.flight, solved, at.w);
  const Memory& memory = at.world.memory;
  ASSERT_EQ(memory.touches.size(), 1u);
  EXPECT_TRUE(memory.touches[0].met);
  ASSERT_EQ(memory.touches[0].loads, 1u);
  EXPECT_EQ(memory.loads[memory.touches[0].first_load].impulse, carried);
  ASSERT_EQ(at.world.events.size(), 1u);
  EXPECT_TRUE(at.world.events[0].first);
  Workspace w;
  const Touches& again = find_touches(at.world, w);
  ASSERT_EQ(again.all.size(), 1u);
  EXPECT_FALSE(again.all[0].fresh);
  EXPECT_TRUE(again.all[0].met);
}

// A ball in the corner of a room, whose lane and wall are two parts of one fixed body.
TEST(PointsAtEnd, AreThoseOfThePartThatATouchIsOf) {
  World world = make_world({.rate_hz = kRate});
  Body corner = floor_body({0.0, 0.0});
  corner.shape =
      make_compound({{test::box({1.0, 1.0, 0.1}), {Quat::Identity(), Vec3(0.0, 0.0, -0.1)}},
                     {test::box({0.1, 1.0, 1.0}), {Quat::Identity(), Vec3(-0.1, 0.0, 1.0)}}});
  add_body(world, corner);
  const double in = 1e-3, near = kBallRadius - in;
  add_body(world, ball_body({0.0, 0.0}), at(Vec3(near, 0.0, near)));
  Workspace w;
  const Touches& touches = find_touches(world, w);
  ASSERT_EQ(touches.all.size(), 2u);
  AtEnd end;
  for (const Touch& touch : touches.all) {
    ASSERT_EQ(touch.a, 1u);
    const std::span<const ContactPoint> points =
        points_at_end(world, touches, touch, world.states[1].X_WB, world.states[0].X_WB, end);
    ASSERT_EQ(points.size(), 1u);
    const Vec3 from_ball = touch.part == 0 ? Vec3(0.0, 0.0, -1.0) : Vec3(-1.0, 0.0, 0.0);
    EXPECT_LT((points[0].n_AB_W - from_ball).norm(), 1e-9);
    EXPECT_NEAR(points[0].depth, in, 1e-9);
  }
}

// The impulse of a row's mass times the approach of two blocks at a point takes all of it away.
TEST(RowAt, HasTheMassByWhichAnImpulseStopsTheApproachAtThePoint) {
  World world = make_world({.rate_hz = kRate, .gravity_W = Vec3::Zero()});
  const State states[] = {at(Vec3(-0.3, 0.0, 0.0), Vec3(2.0, 0.5, 0.0), Vec3(0.0, 3.0, -1.0)),
                          at(Vec3(0.3, 0.1, 0.0), Vec3(-1.0, 0.0, 0.2), Vec3(1.0, 0.0, 2.0))};
  add_body(world, solid(test::box({0.3, 0.2, 0.1}), {0.0, 0.0}, 3.0), states[0]);
  add_body(world, solid(test::box({0.3, 0.1, 0.4}), {0.0, 0.0}, 2.0), states[1]);
  Workspace w;
  depart(world, w);
  const ContactPoint point{.p_W = Vec3(0.0, 0.05, 0.08), .n_AB_W = Vec3(0.96, 0.0, 0.28)};
  const Vec3 arms[] = {point.p_W - states[0].X_WB.p, point.p_W - states[1].X_WB.p};
  for (const bool b_moves : {true, false}) {
    Touch touch;
    touch.a = 0;
    touch.b = 1;
    touch.b_moves = b_moves;
    const NormalRow row = row_at(w.flight, touch, point, states[0].X_WB.p, states[1].X_WB.p);
    const auto speed_of = [&](std::size_t i, double impulse) {
      const Vec3 F = impulse * point.n_AB_W;
      const Vec3 v = states[i].v_WB + F / world.bodies[i].mass;
      const Vec3 w_W = states[i].w_WB + world.bodies[i].inertia.inverse() * arms[i].cross(F);
      return point.n_AB_W.dot(v + w_W.cross(arms[i]));
    };
    const double impulse = row.mass * (speed_of(0, 0.0) - speed_of(1, 0.0));
    EXPECT_GT(impulse, 1.0);
    EXPECT_NEAR(speed_of(0, -impulse), speed_of(1, b_moves ? impulse : 0.0), 1e-12);
  }
}

/// A ball that lies and has been still for long, as it is after its contacts were solved.
struct LongStill : Lying {
  Solved& solved = sustain(world, touches, flight, w);
  LongStill() { world.memory.bodies[1].still = kRate; }
  bool sleeps() {
    fall_asleep(world, touches, flight, solved);
    return is_asleep(world, 1);
  }
};

TEST(FallAsleep, NeedsHalfOfTheWeightCarried) {
  for (const double carried : {0.5, std::nextafter(0.5, 0.0)}) {
    LongStill at;
    at.solved.carried[1] = carried;
    EXPECT_EQ(at.sleeps(), carried == 0.5);
  }
  LongStill before_rules_2;
  before_rules_2.world.parameters.rules = 1;
  before_rules_2.solved.carried[1] = 0.0;
  EXPECT_TRUE(before_rules_2.sleeps());
}

TEST(FallAsleep, NeedsLessThanTheSpeedAndSpinOfSleepers) {
  for (const bool spins : {false, true}) {
    for (const bool less : {false, true}) {
      LongStill at;
      const Parameters& p = at.world.parameters;
      const double limit = spins ? p.sleep_spin : p.sleep_speed;
      const Vec3 most(0.0, less ? std::nextafter(limit, 0.0) : limit, 0.0);
      (spins ? at.world.states[1].w_WB : at.world.states[1].v_WB) = most;
      EXPECT_EQ(at.sleeps(), less) << spins;
      EXPECT_EQ(at.world.memory.bodies[1].still, less ? kRate + 1 : 0);
    }
  }
}

TEST(FallAsleep, NeverHappensOnADrivenBodyThatMovesAndIsTouched) {
  struct Case {
    double speed, depth;
    std::uint32_t points;
    int rules;
    bool sleeps;
  };
  for (const Case& c :
       {Case{0.1, 0.0, 1, 14, false}, Case{0.1, -kRests, 1, 14, false},
        Case{0.1, std::nextafter(-kRests, -1.0), 1, 14, true}, Case{0.1, 0.0, 0, 14, true},
        Case{0.0, 0.0, 1, 14, true}, Case{0.1, 0.0, 1, 1, true}}) {
    LongStill at;
    at.touches.all[0].b_driven = true;
    at.touches.all[0].points = c.points;
    at.w.flight.bodies[0].top_speed = c.speed;
    at.solved.touches[0].depth = c.depth;
    at.world.parameters.rules = c.rules;
    EXPECT_EQ(at.sleeps(), c.sleeps) << c.speed << " " << c.depth << " " << c.rules;
  }
}

// Three balls in a row, asleep: who wakes one wakes all.
TEST(FallAsleep, JoinsTheBodiesOfAnIsland) {
  for (const BodyId woken : {0u, 1u, 2u}) {
    World world = make_world({.rate_hz = kRate, .gravity_W = Vec3::Zero(), .sleep_after = 0.01});
    for (int i = 0; i < 3; ++i) {
      add_body(world, ball_body({0.0, 0.0}), at(Vec3(2.0 * kBallRadius * i, 0.0, 0.0)));
    }
    Workspace w;
    for (int i = 0; i < 10; ++i) step(world, w);
    for (const BodyId i : {0u, 1u, 2u}) ASSERT_TRUE(is_asleep(world, i));
    wake(world, woken);
    for (const BodyId i : {0u, 1u, 2u}) EXPECT_FALSE(is_asleep(world, i)) << woken << " " << i;
  }
}

}  // namespace
}  // namespace headpin::engine
