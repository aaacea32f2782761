// Impacts, the paths to them, and what is left to be stopped at the end, each called alone. Numbers by hand.

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "engine/at_end.h"
#include "engine/meeting.h"
#include "engine/stages.h"
#include "tests/support/bowling.h"
#include "tests/support/random_shapes.h"

namespace headpin::engine {
namespace {

using namespace detail;

constexpr double kStepOfImpacts = 1.0 / 240.0;

/// A ball of 1 kg, of unit inertia, that meets a driven one, on the side to which that one moves.
struct PressedBall {
  explicit PressedBall(double elasticity, const Vec3& driven_v, const State& ball,
                       bool pressed = true, int rules = Parameters{}.rules)
      : world(make_world({.gravity_W = Vec3::Zero(), .rules = rules})) {
    Body driven = ball_body({1.0, 0.0});
    driven.kind = Kind::driven;
    add_body(world, driven, at(Vec3::Zero(), driven_v));
    Body light = ball_body({elasticity, 0.0}, kBallRadius, 1.0);
    light.inertia = Mat3::Identity();
    add_body(world, light, at(Vec3(2.0 * kBallRadius + 5e-7, 0.0, 0.0), ball.v_WB, ball.w_WB));
    Touches& touches = find_touches(world, w);
    EXPECT_EQ(touches.all.size(), 1u);
    for (Touch& touch : touches.all) touch.pressed = pressed;
    resolve_impacts(world, touches, w);
  }
  const Vec3& v() const { return world.states[1].v_WB; }
  bool insists() const { return w.flight.touches[0].insists; }

  World world;
  Workspace w;
};

const Vec3 kVelocityOfHand(3.0, 0.0, 0.0);

State going_by(const Vec3& v, const Vec3& w = Vec3::Zero()) {
  return at(Vec3::Zero(), v, w);
}

TEST(SqueezedBody, IsPushedWithoutRestitutionIfItsDrivenBodyPressedItJustBefore) {
  const State rest = going_by(Vec3::Zero());
  EXPECT_NEAR((PressedBall(0.5, kVelocityOfHand, rest).v() - Vec3(3.0, 0.0, 0.0)).norm(), 0.0,
              1e-12);
  EXPECT_NEAR((PressedBall(0.5, kVelocityOfHand, rest, false).v() - Vec3(4.5, 0.0, 0.0)).norm(),
              0.0, 1e-12);
  EXPECT_NEAR((PressedBall(0.5, kVelocityOfHand, rest, true, 1).v() - Vec3(4.5, 0.0, 0.0)).norm(),
              0.0, 1e-12);
}

TEST(SqueezedBody, IsNoneIfTheDrivenBodyStandsOrGoesAway) {
  const PressedBall stands(0.5, Vec3::Zero(), going_by(Vec3(-2.0, 0.0, 0.0)));
  EXPECT_NEAR(stands.v().x(), 1.0, 1e-12);
  const PressedBall recedes(0.5, Vec3(-1.0, 0.0, 0.0), going_by(Vec3(-3.0, 0.0, 0.0)));
  EXPECT_NEAR(recedes.v().x(), 0.0, 1e-12);
}

// A throw gives (1 + e) v = 4.5 m/s.
TEST(SqueezedBody, GetsNoMoreSpeedThanAThrowGives) {
  const PressedBall slow(0.5, kVelocityOfHand, going_by(Vec3(0.0, 3.2, 0.0)));
  EXPECT_NEAR((slow.v() - Vec3(3.0, 3.2, 0.0)).norm(), 0.0, 1e-12);  // 4.39 m/s
  EXPECT_FALSE(slow.insists());
  const PressedBall fast(0.5, kVelocityOfHand,
                         going_by(Vec3(0.0, 5.0, 0.0)));  // would have 5.83 m/s
  EXPECT_NEAR((fast.v() - Vec3(0.0, 5.0, 0.0)).norm(), 0.0, 1e-12);
  EXPECT_TRUE(fast.insists());
  EXPECT_EQ(fast.w.flight.touches[0].due, kNever);
  EXPECT_EQ(fast.world.statistics.impacts, 1);
  EXPECT_EQ(fast.world.statistics.pulls, 0);
  // As if the driven body stood still.
  const PressedBall nears(0.5, kVelocityOfHand, going_by(Vec3(-1.0, 5.0, 0.0)));
  EXPECT_NEAR((nears.v() - Vec3(0.0, 5.0, 0.0)).norm(), 0.0, 1e-12);
}

// A hoop that rolls at the 4.5 m/s of a throw has v^2 = 20.25 J/kg.
TEST(SqueezedBody, GetsNoMoreEnergyThanAHoopThatRollsAtThatSpeed) {
  for (const double spin_energy : {15.0, 16.0}) {  // and 4.5 J/kg by its speed
    const Vec3 w(std::sqrt(2.0 * spin_energy), 0.0, 0.0);
    const PressedBall ball(0.5, kVelocityOfHand, going_by(Vec3::Zero(), w));
    EXPECT_NEAR(ball.v().x(), spin_energy == 15.0 ? 3.0 : 0.0, 1e-12);
    EXPECT_EQ(ball.insists(), spin_energy == 16.0);
  }
}

TEST(SqueezedBody, MayReachBothLimitsExactly) {
  const PressedBall speed(0.0, kVelocityOfHand, going_by(Vec3::Zero()));  // 3 m/s
  EXPECT_EQ(speed.v().x(), 3.0);
  EXPECT_FALSE(speed.insists());
  const PressedBall energy(0.0, kVelocityOfHand,
                           going_by(Vec3::Zero(), Vec3(3.0, 0.0, 0.0)));  // 9 J/kg
  EXPECT_EQ(energy.v().x(), 3.0);
  EXPECT_FALSE(energy.insists());
}

/// Three balls 3 mm apart, of which the first goes at 4 m/s; from body 0 to 2, or the other way.
World row_of_balls(int impacts, bool other_way) {
  World world = make_world({.gravity_W = Vec3::Zero(), .impacts = impacts});
  for (int k = 0; k < 3; ++k) {
    const int place = other_way ? 2 - k : k;
    add_body(world, ball_body({1.0, 0.0}),
             at(Vec3((2.0 * kBallRadius + 3e-3) * place, 0.0, 0.0),
                place == 0 ? Vec3(4.0, 0.0, 0.0) : Vec3::Zero().eval()));
  }
  return world;
}

TEST(ResolveImpacts, HoldABodyAtItsLastImpactThatReachedTheLimitOfImpacts) {
  for (const bool other_way : {false, true}) {
    World world = row_of_balls(1, other_way);
    Workspace w;
    const Flight* const flight = resolve_impacts(world, find_touches(world, w), w);
    ASSERT_NE(flight, nullptr);
    const BodyId first = other_way ? 2 : 0, last = 2 - first;
    EXPECT_NEAR(flight->bodies[first].clock, 3e-3 / 4.0, 1e-6);
    EXPECT_EQ(flight->bodies[1].impacts, 1);
    EXPECT_EQ(flight->bodies[1].clock, step_seconds(world));
    EXPECT_EQ(flight->bodies[last].impacts, 0);
    EXPECT_EQ(flight->bodies[last].clock, 0.0);
    EXPECT_EQ(world.statistics.unfinished_impacts, 1);
    EXPECT_EQ(world.events.size(), 1u);
    World later = row_of_balls(64, other_way);  // with the buffers of before
    resolve_impacts(later, find_touches(later, w), w);
    EXPECT_EQ(w.flight.struck.size(), 3u);
    EXPECT_NEAR(w.flight.bodies[1].clock, 6e-3 / 4.0, 1e-6);
    for (const BodyId i : {0u, 1u, 2u}) {
      EXPECT_NEAR(later.states[i].v_WB.x(), i == last ? 4.0 : 0.0, 1e-9);
    }
  }
}

TEST(ResolveImpacts, GoBackToTheStartOfTheStepWhenASleeperIsHit) {
  World world = row_of_balls(64, false);
  put_to_sleep(world, 2);
  Workspace w;
  Touches& touches = find_touches(world, w);
  const std::vector<State> before = world.states;
  ASSERT_TRUE(is_asleep(world, 2));  // the ball that rests cannot reach it yet
  EXPECT_EQ(resolve_impacts(world, touches, w), nullptr);
  EXPECT_FALSE(is_asleep(world, 2));
  for (const BodyId i : {0u, 1u, 2u}) {
    EXPECT_EQ(world.states[i].X_WB.p, before[i].X_WB.p);
    EXPECT_EQ(world.states[i].v_WB, before[i].v_WB);
  }
  EXPECT_TRUE(world.events.empty());
  EXPECT_EQ(world.statistics.impacts, 0);
}

TEST(ResolveImpacts, LeaveStruckBodiesToGravity) {
  World world = row_of_balls(64, false);
  for (auto& body : world.memory.bodies) body.supported = true;
  Workspace w;
  depart(world, w);
  EXPECT_FALSE(w.flight.bodies[1].falls);
  resolve_impacts(world, find_touches(world, w), w);
  EXPECT_TRUE(w.flight.bodies[1].falls);
}

// Small balls are followed however slow they are, so that they do not overlap deeply.
TEST(ResolveImpacts, GiveRestitutionAboveTheSpeedOfALastingContactOnly) {
  for (const double closing : {0.15, 0.16}) {
    World world = make_world({.gravity_W = Vec3::Zero(), .impact_speed = 0.15});
    for (const double side : {-1.0, 1.0}) {
      add_body(world, ball_body({1.0, 0.0}, 0.02),
               at(Vec3(side * (0.02 + 1e-4), 0.0, 0.0), Vec3(-side * 0.5 * closing, 0.0, 0.0)));
    }
    Workspace w;
    resolve_impacts(world, find_touches(world, w), w);
    ASSERT_EQ(world.events.size(), 1u);
    EXPECT_NEAR(world.states[1].v_WB.x(), closing > 0.15 ? 0.5 * closing : 0.0, 1e-9);
  }
}

// "Slower approaches are solved as lasting contacts": at that speed it is none either.
TEST(ResolveImpacts, AreForApproachesAboveTheSpeedOfImpacts) {
  for (const double closing : {0.15, 0.16}) {
    World world = make_world({.gravity_W = Vec3::Zero(), .impact_speed = 0.15});
    for (const double side : {-1.0, 1.0}) {
      add_body(
          world, ball_body({1.0, 0.0}),
          at(Vec3(side * (kBallRadius + 1e-4), 0.0, 0.0), Vec3(-side * 0.5 * closing, 0.0, 0.0)));
    }
    Workspace w;
    resolve_impacts(world, find_touches(world, w), w);
    EXPECT_EQ(world.events.size(), closing > 0.15 ? 1u : 0u);
  }
}

// A path of two that fall apart from each other's touch: what falls gains g t on what is carried.
TEST(LandsLater, IsAboutTheSpeedAtWhichABallMeetsTheLaneAfterTheStep) {
  const double g = 9.81, dt = kStepOfImpacts, lasting = std::max(0.15, 2.5 * g * dt);
  for (const double down : {0.0, 0.05, 0.1, 0.2, -0.02, -0.1}) {
    for (const double gap : {-1e-5, 0.0, 1e-5, 1e-4, 3e-4, 6e-4, 9e-4}) {
      World world = make_world({});
      add_body(world, floor_body({1.0, 0.0}));
      add_body(world, ball_body({1.0, 0.0}),
               at(Vec3(0.0, 0.0, kBallRadius + gap), Vec3(0.0, 0.0, -down)));
      Workspace w;
      depart(world, w);
      Touch touch;
      touch.a = 1;
      touch.b = 0;
      const ContactPoint point{.p_W = Vec3::Zero(), .n_AB_W = Vec3(0.0, 0.0, -1.0), .depth = -gap};
      const double left = gap - down * dt - 0.5 * g * dt * dt, at_end = down + g * dt;
      const double meets =
          std::sqrt(std::max(0.0, at_end * at_end + 2.0 * g * std::max(0.0, left)));
      if (std::abs(meets - lasting) < 1e-6) continue;
      EXPECT_EQ(lands_later(world, w.flight, touch, point),
                left >= 0.0 && at_end > 0.0 && meets > lasting)
          << down << " " << gap;
    }
  }
}

// x = v t + g t^2 / 2 since the body's clock.
TEST(StateAt, IsThatOfTheBodysPathSinceItsClock) {
  World world = make_world({});
  Body other = solid(test::box({0.1, 0.2, 0.3}), {0.5, 0.5}, 2.0);
  const Vec3 v(1.0, 2.0, 3.0), spin(5.0, 1.0, -8.0);
  add_body(world, other, at(Vec3::Zero(), v, spin));
  other.kind = Kind::driven;
  add_body(world, other, at(Vec3(5.0, 0.0, 0.0), v, spin));
  other.kind = Kind::fixed;
  add_body(world, other, at(Vec3(9.0, 0.0, 0.0)));
  add_body(world, ball_body({0.5, 0.5}), at(Vec3(12.0, 0.0, 0.0), v, spin));
  put_to_sleep(world, 3);
  Workspace w;
  depart(world, w);
  for (Flyer& flyer : w.flight.bodies) flyer.clock = 1e-3;
  const double t = 2.5e-3, passed = 1.5e-3;
  const State free = state_at(world, w.flight, 0, t), driven = state_at(world, w.flight, 1, t);
  const Vec3 g(0.0, 0.0, -9.81), p = passed * v + 0.5 * passed * passed * g;
  EXPECT_NEAR((free.X_WB.p - p).norm(), 0.0, 1e-15);
  EXPECT_NEAR((free.v_WB - v - passed * g).norm(), 0.0, 1e-14);
  const Mat3 R_WB = free.X_WB.q.toRotationMatrix(), &I = world.bodies[0].inertia;
  EXPECT_LT((R_WB * I * R_WB.transpose() * free.w_WB - I * spin).norm(), 1e-6 * (I * spin).norm());
  EXPECT_GT((free.w_WB - spin).norm(), 1e-4);  // Euler's equations
  EXPECT_NEAR((driven.X_WB.p - Vec3(5.0, 0.0, 0.0) - passed * v).norm(), 0.0, 1e-14);
  EXPECT_EQ(driven.w_WB, spin);
  EXPECT_LT(driven.X_WB.q.angularDistance(rotation(passed * spin)), 1e-7);
  for (const BodyId still : {2u, 3u}) {
    EXPECT_EQ(state_at(world, w.flight, still, t).X_WB.p, world.states[still].X_WB.p);
    EXPECT_EQ(state_at(world, w.flight, still, t).v_WB, world.states[still].v_WB);
  }
}

TEST(Depart, MakesTheListsOnceAndClearsTheLastStep) {
  World world = row_of_balls(64, false);
  Workspace w;
  w.flight.struck.emplace_back(0, State{});
  depart(world, w);
  EXPECT_TRUE(w.flight.struck.empty());
  EXPECT_TRUE(world.seams.made);
  EXPECT_TRUE(world.roll.made);
  EXPECT_FALSE(know_roll(world));
  world.roll.made = false;
  EXPECT_TRUE(know_roll(world));
  EXPECT_FALSE(know_roll(world));
  EXPECT_NEAR(w.flight.bodies[0].sought, 4.0 * kStepOfImpacts, 1e-15);
}

TEST(Roll, BoundsFlatFixedBodiesByTheirBoxSinceRules6) {
  for (const int rules : {5, 6}) {
    World world = make_world({.rules = rules});
    Body body = solid(test::box({0.1, 0.2, 0.3}), {0.5, 0.5}, 2.0);
    for (const Kind kind : {Kind::fixed, Kind::driven, Kind::free}) {
      body.kind = kind;
      add_body(world, body, at(Vec3(static_cast<double>(world.bodies.size()), 0.0, 0.0)));
    }
    Body round = ball_body({0.5, 0.5});
    round.kind = Kind::fixed;
    add_body(world, round, at(Vec3(3.0, 0.0, 0.0)));
    const Pose tilted{rotation({0.0, 0.6, 0.0}), Vec3(0.0, 0.0, -2.0)};
    add_body(world, floor_body({0.5, 0.5}), at(tilted));
    know_roll(world);
    ASSERT_EQ(world.roll.planes_W.size(), 1u);
    EXPECT_NEAR(world.roll.planes_W[0].height, -2.0 * std::cos(0.6), 1e-12);
    if (rules == 5) {
      EXPECT_TRUE(world.roll.limits_W.empty());
      continue;
    }
    ASSERT_EQ(world.roll.limits_W.size(), 4u);
    for (std::size_t k = 0; k < 4; ++k) {
      EXPECT_EQ(std::isfinite(world.roll.limits_W[k].low.x()), k == 0);
    }
  }
}

/// A rod of 1 m over a block, about to turn into it in a step of 1/60 s, with what stops it.
struct SwingingRod {
  explicit SwingingRod(Kind kind, double spin = 20.0, int rules = Parameters{}.rules,
                       const Vec3& block_v = Vec3::Zero())
      : world(make_world({.rate_hz = 60, .gravity_W = Vec3::Zero(), .rules = rules})) {
    Body block = solid(test::box({1.0, 1.0, 0.2}), {0.0, 0.0}, 20.0);
    block.kind = kind;
    add_body(world, block, at(Vec3(0.0, 0.0, -0.2)));
    Body rod = ball_body({0.0, 0.0});
    rod.shape = make_compound(
        {{Cylinder{0.01, 0.5}, {rotation({0.0, 0.5 * 3.14159265, 0.0}), Vec3::Zero()}}});
    rod.inertia = Vec3(1e-3, 0.6, 0.6).asDiagonal();
    add_body(world, rod, at(Vec3(0.0, 0.0, 0.0101), Vec3::Zero(), Vec3(0.0, spin, 0.0)));
    depart(world, w);
    touches = &find_touches(world, w);
    w.flight.touches.assign(touches->all.size(), {});
    solved = &sustain(world, *touches, w.flight, w);
    world.states[1].w_WB = Vec3(0.0, spin, 0.0);  // as if the contacts had let it turn on
    world.states[1].v_WB = Vec3::Zero();
    world.states[0].w_WB = Vec3::Zero();
    world.states[0].v_WB = block_v;
    w.by_driven = {};
  }
  void stop() { stop_swings(world, *touches, w.flight, *solved, w); }
  bool swings() { return stop(), solved->touches[0].swings; }
  Vec3 momentum(BodyId i) const { return world.bodies[i].mass * world.states[i].v_WB; }
  double lowest() const {
    const Pose X_WB = pose_at_end(world, w.flight, *solved, 1);
    return X_WB.p.z() - 0.5 * std::abs((X_WB.q * Vec3::UnitX()).z());
  }

  World world;
  Workspace w;
  Touches* touches = nullptr;
  Solved* solved = nullptr;
};

// 0.2 rad within the step.
TEST(StopSwings, AreForBodiesThatTurnFarInWhatIsLeftOfTheStep) {
  EXPECT_FALSE(SwingingRod(Kind::fixed, 0.1995 * 60.0).swings());
  EXPECT_TRUE(SwingingRod(Kind::fixed, 0.2005 * 60.0).swings());
  SwingingRod late(Kind::fixed, 0.3 * 60.0);
  late.w.flight.bodies[1].clock = 0.5 / 60.0;
  EXPECT_FALSE(late.swings());
  SwingingRod deep(Kind::fixed, 0.0);
  deep.solved->touches[0].depth = 1.01 * deep_for(deep.world, 0, 1);
  EXPECT_TRUE(deep.swings());
  SwingingRod pointless(Kind::fixed);
  pointless.touches->all[0].points = 0;
  EXPECT_FALSE(pointless.swings());
}

TEST(StopSwings, GiveWhatTheyTakeToTheOtherBodyOrToTheLedgerOfAHand) {
  SwingingRod on_free(Kind::free);
  on_free.stop();
  EXPECT_GT(on_free.momentum(1).z(), 1.0);
  EXPECT_NEAR((on_free.momentum(0) + on_free.momentum(1)).norm(), 0.0, 1e-9);
  EXPECT_EQ(on_free.w.by_driven.momentum.norm(), 0.0);
  SwingingRod on_fixed(Kind::fixed);
  on_fixed.stop();
  EXPECT_GT(on_fixed.momentum(1).z(), 1.0);
  EXPECT_EQ(on_fixed.w.by_driven.momentum.norm(), 0.0);
  EXPECT_GT(on_fixed.lowest(), -0.02);
}

// Where squeezes are bounded a driven body counts as standing still: it does no work.
TEST(StopSwings, LetADrivenBodyPushOnlyUnderOlderRules) {
  const Vec3 up(0.0, 0.0, 0.5);
  for (const int rules : {1, Parameters{}.rules}) {
    SwingingRod rod(Kind::driven, 20.0, rules, up);
    rod.stop();
    const Balance& given = rod.w.by_driven;
    EXPECT_GT(rod.momentum(1).z(), 1.0) << rules;
    EXPECT_NEAR((given.momentum - rod.momentum(1)).norm(), 0.0, 1e-9);
    EXPECT_NEAR(given.energy, rules == 1 ? given.momentum.dot(up) : 0.0, 1e-9);
    const double turned = 0.6 * (rod.world.states[1].w_WB.y() - 20.0);
    EXPECT_NEAR(given.angular_momentum.y(), turned, 0.1 * std::abs(turned));
  }
}

}  // namespace
}  // namespace headpin::engine
