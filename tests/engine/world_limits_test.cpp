#include <functional>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/bodies.h"
#include "engine/seams.h"
#include "engine/world.h"
#include "tests/support/bowling.h"
#include "tests/support/random_shapes.h"

// What a world's functions accept and refuse, each limit met exactly; and what they leave behind.
namespace headpin::engine {
namespace {

using testing::HasSubstr;

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

std::string refused(const std::function<void()>& f) {
  try {
    f();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

Body fixed_box(const Vec3& half) {
  Body body = solid(test::box(half), {});
  body.kind = Kind::fixed;
  return body;
}

Body driven_ball(double radius) {
  Body body = ball_body({}, radius);
  body.kind = Kind::driven;
  return body;
}

World floating() {
  return make_world({.gravity_W = Vec3::Zero()});
}

TEST(MakeWorld, TakesAGravityOfUpToAThousand) {
  EXPECT_NO_THROW(make_world({.gravity_W = Vec3(0.0, 0.0, -1000.0)}));
  EXPECT_EQ(refused([] { make_world({.gravity_W = Vec3(0.0, 0.0, -1001.0)}); }),
            "gravity_W [m/s^2]: expected at most 1000, found 1001");
}

FrictionTable square_table() {
  return {.low_x = -1.0,
          .width = 1.0,
          .columns = 2,
          .edges = {0.0, 1.0, 2.5},
          .friction = {0.0, 0.1, 0.2, 1.0}};
}

std::string refused_table(FrictionTable table) {
  const auto shared = std::make_shared<const FrictionTable>(std::move(table));
  World world = floating();
  Body body = fixed_box(Vec3::Ones());
  body.name = "lane";
  body.table = shared;
  const std::string added = refused([&] { add_body(world, body); });
  body.table = nullptr;
  const BodyId lane = add_body(world, body);
  EXPECT_EQ(refused([&] { set_friction(world, lane, shared); }), added);
  EXPECT_EQ(world.bodies[lane].table, added == "accepted" ? shared : nullptr);
  return added;
}

TEST(FrictionTable, IsRefusedWithTheReason) {
  const std::string who = "body 0 'lane': ";
  EXPECT_EQ(refused_table(square_table()), "accepted");
  FrictionTable t = square_table();
  t.columns = 0;
  EXPECT_THAT(refused_table(t), HasSubstr("columns of the table of friction: expected 1 or more"));
  t = square_table();
  t.width = 0.0;
  EXPECT_EQ(refused_table(t), who + "width of a column of friction [m]: expected above 0, found 0");
  t = square_table();
  t.edges = {0.0, 1.0, 1.0};
  EXPECT_EQ(refused_table(t), who + "edge of a row of friction [m]: expected above 1, found 1");
  t = square_table();
  t.friction.pop_back();
  EXPECT_EQ(refused_table(t), who + "cells of friction: expected 4, found 3");
  t = square_table();
  t.friction[3] = 1.01;
  EXPECT_EQ(refused_table(t), who + "friction of a cell: expected 0 to 1, found 1.01");
  t = square_table();
  t.edges.clear();
  t.friction.clear();
  EXPECT_EQ(refused_table(t), "accepted");  // a table without rows has no place
}

TEST(AddBody, NamesABodyOfABadInertia) {
  for (const Kind kind : {Kind::free, Kind::driven}) {
    World world = floating();
    Body body = ball_body({}, 0.1);
    body.kind = kind;
    body.inertia = -Mat3::Identity();
    EXPECT_THAT(refused([&] { add_body(world, body); }), HasSubstr("body 0 'ball': inertia"));
    EXPECT_TRUE(world.bodies.empty());
  }
}

TEST(State, OfABodyIsFiniteInEachOfItsParts) {
  World world = floating();
  const BodyId ball = add_body(world, ball_body({}, 0.1));
  const std::string finite = "body 0 'ball': expected a finite pose and velocity";
  const auto set = [&](const std::function<void(State&)>& change) {
    State s;
    change(s);
    const std::string why = refused([&] { set_state(world, ball, s); });
    EXPECT_EQ(refused([&] { outside_fixed(world, ball, s); }), why);
    return why;
  };
  EXPECT_EQ(set([](State&) {}), "accepted");
  EXPECT_EQ(set([](State& s) { s.X_WB.p.y() = kNoNumber; }), finite);
  EXPECT_EQ(set([](State& s) { s.X_WB.q.x() = kNoNumber; }), finite);
  EXPECT_EQ(set([](State& s) { s.v_WB.x() = kNoNumber; }), finite);
  EXPECT_EQ(set([](State& s) { s.w_WB.z() = kNoNumber; }), finite);
  EXPECT_EQ(set([](State& s) { s.X_WB.q.w() = 1.5; }),
            "body 0 'ball': norm of its quaternion: expected 1, found 1.5");
}

TEST(State, GetsAQuaternionOfNormOne) {
  State s;
  s.X_WB.q.w() = 1.0 + 5e-7;
  World world = floating();
  const BodyId ball = add_body(world, ball_body({}, 0.1), s);
  EXPECT_NEAR(world.states[ball].X_WB.q.norm(), 1.0, 1e-15);
  set_state(world, ball, s);
  EXPECT_NEAR(world.states[ball].X_WB.q.norm(), 1.0, 1e-15);
}

TEST(AddBody, RefusesEachVelocityOfAFixedBody) {
  for (const auto& [v, w] : {std::pair(0.1, 0.0), std::pair(0.0, 0.1)}) {
    World world = floating();
    const State s = at(Vec3(0, 0, 0), Vec3(0, v, 0), Vec3(0, 0, w));
    EXPECT_THAT(refused([&] { add_body(world, fixed_box(Vec3::Ones()), s); }),
                HasSubstr("is fixed, expected no velocity"));
  }
}

/// What is said of a body at x beside another at the origin.
std::string refused_beside(const Body& first, const Body& second, double x) {
  World world = floating();
  add_body(world, first);
  return refused([&] { add_body(world, second, at(Vec3(x, 0.0, 0.0))); });
}

TEST(AddBody, RefusesAnOverlapOfMoreThanAQuarterOfTheSmallerRadius) {
  for (const double radius : {0.125, 2.0}) {
    const Body ball = ball_body({}, radius), larger = ball_body({}, 2.0 * radius);
    EXPECT_EQ(refused_beside(larger, ball, 2.76 * radius), "accepted");
    EXPECT_THAT(refused_beside(larger, ball, 2.74 * radius), HasSubstr("overlap with body 0"));
    EXPECT_THAT(refused_beside(ball, larger, 2.0 * radius), HasSubstr("overlap with body 0"));
    EXPECT_THAT(refused_beside(ball, ball, radius), HasSubstr("overlap with body 0"));
  }
  // On a half-space the overlap is exact.
  World world = floating();
  add_body(world, floor_body({}));
  EXPECT_NO_THROW(add_body(world, ball_body({}, 0.5), at(Vec3(0.0, 0.0, 0.375))));
  EXPECT_EQ(refused([&] { add_body(world, ball_body({}, 0.5), at(Vec3(9.0, 0.0, 0.25))); }),
            "body 2 'ball': overlap with body 0 'lane' [m]: expected at most 0.125, found 0.25");
}

TEST(AddBody, LetsFixedAndDrivenBodiesOverlap) {
  const Body box = fixed_box(Vec3::Ones()), hand = driven_ball(0.5), ball = ball_body({}, 0.5);
  EXPECT_EQ(refused_beside(box, box, 0.1), "accepted");
  EXPECT_EQ(refused_beside(box, hand, 0.1), "accepted");
  EXPECT_EQ(refused_beside(hand, hand, 0.1), "accepted");
  EXPECT_THAT(refused_beside(box, ball, 0.1), HasSubstr("overlap"));
  EXPECT_THAT(refused_beside(ball, hand, 0.1), HasSubstr("overlap"));
  EXPECT_THAT(refused_beside(hand, ball, 0.1), HasSubstr("overlap"));
}

TEST(World, RefusesABodyThatItLacks) {
  World world = floating();
  add_body(world, ball_body({}, 0.1));
  for (const BodyId i : {1u, 4'000'000'000u}) {
    const std::string none = "body " + std::to_string(i) + ": there are 1";
    EXPECT_EQ(refused([&] { set_state(world, i, {}); }), none);
    EXPECT_EQ(refused([&] { set_kind(world, i, Kind::driven); }), none);
    EXPECT_EQ(refused([&] { wake(world, i); }), none);
    EXPECT_EQ(refused([&] { put_to_sleep(world, i); }), none);
    EXPECT_EQ(refused([&] { outside_fixed(world, i, {}); }), none);
    EXPECT_EQ(refused([&] { forget_meetings(world, i); }), none);
    EXPECT_EQ(refused([&] { set_friction(world, i, nullptr); }), none);
  }
}

TEST(AddBody, LetsTheNextStepFindTheSeamsAgain) {
  World world = floating();
  add_body(world, fixed_box(Vec3::Ones()));
  detail::know_seams(world);
  ASSERT_TRUE(world.seams.made);
  add_body(world, fixed_box(Vec3::Ones()), at(Vec3(2, 0, 0)));
  EXPECT_FALSE(world.seams.made);
}

TEST(SetKind, RefusesToFixABodyAndToFreeAFixedOne) {
  World world = floating();
  const BodyId box = add_body(world, fixed_box(Vec3::Ones()));
  const BodyId ball = add_body(world, ball_body({}, 0.1), at(Vec3(0.0, 0.0, 9.0)));
  const char* const only = "only free and driven can change";
  EXPECT_THAT(refused([&] { set_kind(world, box, Kind::free); }), HasSubstr(only));
  EXPECT_THAT(refused([&] { set_kind(world, ball, Kind::fixed); }), HasSubstr(only));
}

TEST(Sleep, EndsForABodyThatIsSetAndForWhatRestsOnIt) {
  for (const bool by_kind : {false, true}) {
    World world = floating();
    const double r = 0.1, gap = 0.5 * detail::kRests;
    const BodyId ball = add_body(world, ball_body({}, r));
    EXPECT_FALSE(is_asleep(world, ball));
    // One rests on it, another reaches past it without a touch, a third lies far away.
    const BodyId rests = add_body(world, ball_body({}, r), at(Vec3(2.0 * r + gap, 0.0, 0.0)));
    const Body rod = solid(test::box(Vec3(0.01, 1.0, 0.01)), {}, 1.0);
    const BodyId beside = add_body(world, rod, at(Vec3(0.0, 0.0, r + 0.05)));
    const BodyId far = add_body(world, ball_body({}, r), at(Vec3(9.0, 0.0, 0.0)));
    const BodyId awake = add_body(world, ball_body({}, r), at(Vec3(-2.0 * r, 0.0, 0.0)));
    for (const BodyId i : {ball, rests, beside, far}) {
      put_to_sleep(world, i);
      EXPECT_TRUE(is_asleep(world, i));
    }
    world.memory.bodies[ball].supported = true;
    world.memory.bodies[awake].still = 7;
    if (by_kind) {
      set_kind(world, ball, Kind::driven);
    } else {
      set_state(world, ball, at(Vec3(0.0, 9.0, 0.0)));
    }
    EXPECT_FALSE(is_asleep(world, ball));
    EXPECT_FALSE(world.memory.bodies[ball].supported);
    EXPECT_FALSE(is_asleep(world, rests));
    EXPECT_TRUE(world.memory.bodies[rests].supported);  // it lay on something
    EXPECT_TRUE(is_asleep(world, beside));
    EXPECT_TRUE(is_asleep(world, far));
    EXPECT_EQ(world.memory.bodies[awake].still, 7);
  }
}

TEST(SetResponse, GivesTheWorldTheNameOfItsLaw) {
  World world = make_world({.response = "paper"});
  set_response(world, response_named("coulomb"));
  EXPECT_EQ(world.parameters.response, "coulomb");
}

TEST(OutsideFixed, GoesExactlyToAPlaceThatIsFree) {
  World world = floating();
  const double r = 0.1;
  const BodyId hand = add_body(world, driven_ball(r));
  add_body(world, ball_body({}, r), at(Vec3(1.0, 0.0, 0.0)));  // is not fixed: no obstacle
  add_body(world, fixed_box(Vec3(0.05, 1.0, 1.0)), at(Vec3(-r - 0.06, 0.0, 0.0)));  // behind it
  const Vec3 to(2.0, 0.0, 0.5), v(1.0, 2.0, 3.0);
  const State s = outside_fixed(world, hand, at(to, v));
  EXPECT_LT((s.X_WB.p - to).norm(), 1e-12);
  EXPECT_EQ(s.v_WB, v);
}

TEST(OutsideFixed, DoesNotPassThroughAThinWall) {
  World world = floating();
  const double r = 0.1;
  const BodyId hand = add_body(world, driven_ball(r));
  add_body(world, fixed_box(Vec3(0.005, 5.0, 5.0)), at(Vec3(0.5, 0.0, 0.0)));
  const State s = outside_fixed(world, hand, at(Vec3(1.0, 0.3, 0.0), Vec3(4.0, 2.0, 0.0)));
  EXPECT_LT((s.X_WB.p - Vec3(0.495 - r, 0.3, 0.0)).norm(), 1e-6);
  EXPECT_LT((s.v_WB - Vec3(0.0, 2.0, 0.0)).norm(), 1e-6);
}

// A ball of 2 kg and 0.5 m at (1, 2, 3): I = 2/5 m r^2 = 0.2; gravity 10.
TEST(Balance, IsOfTheFreeBodiesAlone) {
  World world = make_world({.gravity_W = Vec3(0.0, 0.0, -10.0)});
  const State s = at(Vec3(1, 2, 3), Vec3(4, 0, 0), Vec3(0, 0, 5));
  const BodyId ball = add_body(world, ball_body({}, 0.5, 2.0), s);
  add_body(world, driven_ball(0.5), at(Vec3(9, 9, 9), Vec3(1, 1, 1)));
  for (const Balance& b : {balance(world), balance_of(world, ball)}) {
    EXPECT_NEAR(b.energy, 16.0 + 2.5 + 60.0, 1e-12);
    EXPECT_LT((b.momentum - Vec3(8, 0, 0)).norm(), 1e-12);
    EXPECT_LT((b.angular_momentum - Vec3(0, 24, -16 + 1)).norm(), 1e-12);
  }
}

TEST(TakeOver, CopiesWhatTheOtherWorldIsAndNoTouch) {
  const auto made = [] {
    World world = make_world({.keep_ledger = true});
    add_body(world, floor_body({}));
    for (const double x : {0.0, 1.0, 2.0}) {
      add_body(world, ball_body({}), at(Vec3(x, 0.0, kBallRadius)));
    }
    return world;
  };
  World from = made(), to = made();
  set_state(from, 3, at(Vec3(2.0, 0.5, kBallRadius)));
  set_kind(from, 3, Kind::driven);
  run(from, 0.05);
  put_to_sleep(from, 2);
  run(to, 0.1);
  ASSERT_FALSE(from.memory.met.empty());
  ASSERT_TRUE(from.memory.bodies[1].supported);
  from.memory.bodies[1].still = 5;
  to.memory.met.clear();
  take_over(to, from);
  EXPECT_EQ(state_hash(to), state_hash(from));
  EXPECT_EQ(to.tick, from.tick);
  EXPECT_EQ(to.ledger.sustained.energy, from.ledger.sustained.energy);
  EXPECT_TRUE(to.memory.touches.empty());
  EXPECT_EQ(to.memory.met, from.memory.met);
  EXPECT_EQ(to.memory.balance.energy, from.memory.balance.energy);
  EXPECT_EQ(to.memory.bodies[1].still, 5);
  EXPECT_FALSE(to.memory.bodies[1].supported);
  EXPECT_FALSE(is_asleep(to, 1));
  EXPECT_TRUE(is_asleep(to, 2));
  EXPECT_EQ(to.bodies[3].kind, Kind::driven);
}

}  // namespace
}  // namespace headpin::engine
