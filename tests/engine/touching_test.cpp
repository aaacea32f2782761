#include "engine/touching.h"

#include <numbers>

#include <gtest/gtest.h>

#include "engine/stages.h"
#include "tests/support/bowling.h"
#include "tests/support/random_shapes.h"

// Touches of two bodies: the friction of a place, the time that points are found for, parts, loads.
namespace headpin::engine {
namespace {

using namespace detail;

constexpr int kSteps = 256;  // a second

/// A ball that lies on a lane with friction of places, bodies 0 and 1; the product of both is 1/4.
World ball_in_places(const Body& lane, const Vec3& from, const Vec3& v = Vec3::Zero()) {
  World world = make_world({.rate_hz = kSteps, .response = "coulomb"});
  add_body(world, lane);
  add_body(world, ball_body({1.0, 0.5}), at(Vec3(from.x(), from.y(), kBallRadius), v));
  return world;
}

double friction_of(const Body& lane, const Vec3& from, const Vec3& v = Vec3::Zero()) {
  World world = ball_in_places(lane, from, v);
  Workspace w;
  const Touches& touches = find_touches(world, w);
  if (touches.all.size() != 1) return -1.0;
  EXPECT_EQ(touches.all[0].pair.elasticity, 0.5);
  EXPECT_EQ(touches.all[0].sliding.limit, touches.all[0].pair.friction);
  return touches.all[0].pair.friction;
}

Body lane_of_areas(std::vector<FrictionArea> areas) {
  Body lane = floor_body({0.5, 0.5});
  lane.areas = std::move(areas);
  return lane;
}

TEST(FrictionOfAPlace, IsThatOfTheFirstAreaWithItsLowEdgesOnly) {
  const Body lane = lane_of_areas({{Vec2(1, 2), Vec2(3, 4), 0.75}, {Vec2(2, 2), Vec2(5, 4), 0.5}});
  EXPECT_EQ(friction_of(lane, Vec3(1, 2, 0)), 0.75);
  EXPECT_EQ(friction_of(lane, Vec3(2, 3, 0)), 0.75);  // both: the first counts
  EXPECT_EQ(friction_of(lane, Vec3(3, 3, 0)), 0.5);
  EXPECT_EQ(friction_of(lane, Vec3(1, 4, 0)), 0.25);
  EXPECT_EQ(friction_of(lane, Vec3(5, 3, 0)), 0.25);
  EXPECT_EQ(friction_of(lane, Vec3(0.5, 3, 0)), 0.25);
  EXPECT_EQ(friction_of(lane, Vec3(1, 1.5, 0)), 0.25);
  EXPECT_EQ(friction_of(floor_body({0.5, 0.5}), Vec3(1, 2, 0)), 0.25);
}

TEST(FrictionOfAPlace, IsThatOfTheTableBeforeTheAreas) {
  Body lane = lane_of_areas({{Vec2(0, 0), Vec2(9, 9), 0.75}});
  const FrictionTable table{
      .low_x = 0.0, .width = 1.0, .columns = 2, .edges = {0.0, 1.0}, .friction = {0.125, 1.0}};
  lane.table = std::make_shared<const FrictionTable>(table);
  EXPECT_EQ(friction_of(lane, Vec3(0.5, 0.5, 0)), 0.125);
  EXPECT_EQ(friction_of(lane, Vec3(1.5, 0.5, 0)), 1.0);
  EXPECT_EQ(friction_of(lane, Vec3(0.5, 2.0, 0)), 0.75);
  lane.areas.clear();
  EXPECT_EQ(friction_of(lane, Vec3(0.5, 0.5, 0)), 0.125);
  EXPECT_EQ(friction_of(lane, Vec3(0.5, 2.0, 0)), 0.25);
}

// 4 m/s are 1/64 m in a step. The way is looked at in the middle of each of its quarters.
TEST(FrictionOfAPlace, IsTheMeanOverTheWayOfTheStep) {
  const double way = 1.0 / 64.0;
  for (const int quarters : {0, 1, 2, 3, 4}) {
    const Body lane = lane_of_areas({{Vec2(-1, -1), Vec2(0.25 * quarters * way, 1), 0.75}});
    EXPECT_NEAR(friction_of(lane, Vec3(0, 0, 0), Vec3(4, 0, 0)), 0.25 + 0.125 * quarters, 1e-12);
  }
  // It is that over B: here the lane is turned by a quarter and stands elsewhere.
  World world = make_world({.rate_hz = kSteps});
  const Quat turn = rotation(Vec3(0, 0, 0.5 * std::numbers::pi));
  add_body(world, lane_of_areas({{Vec2(-1, -1), Vec2(0.5 * way, 1), 0.75}}),
           at(Pose{turn, Vec3(7, 8, 0)}));
  add_body(world, ball_body({1.0, 0.5}), at(Vec3(7, 8, kBallRadius), Vec3(0, 4, 0)));
  Workspace w;
  const Touches& touches = find_touches(world, w);
  ASSERT_EQ(touches.all.size(), 1u);
  EXPECT_NEAR(touches.all[0].pair.friction, 0.5, 1e-12);
}

/// A slender body that tumbles on its way down to a lane; the lane is body 0 or 1.
World tumbling(bool lane_first, const Body& lane) {
  World world = make_world({.rate_hz = kSteps, .response = "coulomb"});
  if (lane_first) add_body(world, lane);
  Body body = solid(Ellipsoid{{0.1, 0.1, 0.1}}, {1.0, 0.5});
  body.inertia = Vec3(1.0, 2.0, 2.5).asDiagonal();
  add_body(world, body, at(Vec3(0, 0, 0.105), Vec3(4, 0, -3), Vec3(5, 6, 7)));
  if (!lane_first) add_body(world, lane);
  return world;
}

TEST(Touches, AreThoseOfTheTimeThatTheyAreLookedFor) {
  const double step = 1.0 / kSteps, t = 0.5 * step, way = 4.0 * step;
  // On the first three quarters of the way of the whole step there is no friction.
  const Body lane = lane_of_areas({{Vec2(-1, -1), Vec2(0.75 * way, 1), 0.0}});
  for (const bool lane_first : {true, false}) {
    World world = tumbling(lane_first, lane);
    const BodyId body = lane_first ? 1 : 0;
    Workspace w;
    Touches& touches = find_touches(world, w);
    const Flight flight = w.flight;
    ASSERT_EQ(touches.all.size(), 1u);
    const Touch before = touches.all[0];
    EXPECT_EQ(before.w_WA, Vec3(5, 6, 7));
    EXPECT_NEAR(before.pair.friction, 0.0625, 1e-12);
    ASSERT_EQ(add_touches(world, flight, 0, t, touches), 1u);
    Touch again = before;
    look_again(world, flight, again, t, touches);
    const State then = state_at(world, flight, body, t);
    ASSERT_GT((then.w_WB - Vec3(5, 6, 7)).norm(), 1e-3);
    for (const Touch& touch : {touches.all.back(), again}) {
      EXPECT_EQ(touch.a, body);
      EXPECT_EQ(touch.time, t);
      EXPECT_EQ(touch.w_WA, then.w_WB);
      EXPECT_TRUE(touch.w_WB.isZero(0.0));
      EXPECT_NEAR(touch.pair.friction, 0.125, 1e-12);  // on the rest of the way
      ASSERT_EQ(touch.points, 1u);
      const ContactPoint& point = touches.points[touch.first_point];
      EXPECT_LT((point.n_AB_W - Vec3(0, 0, -1)).norm(), 1e-12);
      EXPECT_NEAR(point.depth, 0.1 - then.X_WB.p.z(), 1e-9);
    }
    EXPECT_EQ(again.sliding.limit, again.pair.friction);
    EXPECT_EQ(again.sliding.kept, 0.0);
  }
}

TEST(Touches, OfTwoBodiesThatTumbleHaveTheTurningOfBoth) {
  World world = make_world({.rate_hz = kSteps});
  for (const double side : {-1.0, 1.0}) {
    Body body = ball_body({}, 0.1);
    body.inertia = Vec3(1.0, 2.0, 2.5).asDiagonal();
    add_body(world, body, at(Vec3(0.1001 * side, 0, 0), Vec3(-side, 0, 0), Vec3(5, 6 * side, 7)));
  }
  Workspace w;
  Touches& touches = find_touches(world, w);
  const Flight flight = w.flight;
  ASSERT_EQ(touches.all.size(), 1u);
  const double t = 0.5 / kSteps;
  ASSERT_EQ(add_touches(world, flight, 0, t, touches), 1u);
  Touch again = touches.all[0];
  look_again(world, flight, again, t, touches);
  for (const Touch& touch : {touches.all[1], again}) {
    for (const auto& [body, w_W] :
         {std::pair(touch.a, touch.w_WA), std::pair(touch.b, touch.w_WB)}) {
      EXPECT_EQ(w_W, state_at(world, flight, body, t).w_WB);
      EXPECT_GT((w_W - world.states[body].w_WB).norm(), 1e-3);
    }
  }
}

TEST(LookAgain, FindsThePointsOfThePartThatATouchIsOf) {
  World world = make_world({.rate_hz = kSteps});
  Body corner = floor_body({});
  corner.shape = make_compound({{test::box({1, 1, 0.1}), {Quat::Identity(), Vec3(0, 0, -0.1)}},
                                {test::box({0.1, 1, 1}), {Quat::Identity(), Vec3(-0.1, 0, 1)}}});
  add_body(world, corner);
  add_body(world, ball_body({}), at(Vec3(kBallRadius, 0, kBallRadius)));
  Workspace w;
  Touches& touches = find_touches(world, w);
  const Flight flight = w.flight;
  ASSERT_EQ(touches.all.size(), 2u);
  for (Touch touch : std::vector(touches.all)) {
    look_again(world, flight, touch, 0.0, touches);
    ASSERT_EQ(touch.points, 1u);
    const Vec3 from_ball = touch.part == 0 ? Vec3(0, 0, -1) : Vec3(-1, 0, 0);
    EXPECT_LT((touches.points[touch.first_point].n_AB_W - from_ball).norm(), 1e-9);
  }
}

Compound row_of_balls(std::size_t count) {
  std::vector<Part> parts;
  for (std::size_t k = 0; k < count; ++k) {
    parts.push_back({Ellipsoid{Vec3::Constant(0.01)},
                     {Quat::Identity(), Vec3(0.05 * static_cast<double>(k), 0.0, 0.0)}});
  }
  return make_compound(std::move(parts));
}

/// Two rows of balls far from each other, one of them fixed.
World two_rows(bool fixed_first, std::size_t fixed, std::size_t free,
               int rules = Parameters{}.rules) {
  World world = make_world({.rules = rules});
  for (const bool is_fixed : {fixed_first, !fixed_first}) {
    Body body;
    body.kind = is_fixed ? Kind::fixed : Kind::free;
    body.shape = row_of_balls(is_fixed ? fixed : free);
    add_body(world, body, at(Vec3(0.0, is_fixed ? 0.0 : 99.0, 0.0)));
  }
  return world;
}

TEST(PartsTouched, AreThoseOfAFixedBodyOfSeveral) {
  const Candidate c{.a = 0, .b = 1};
  for (const bool first : {true, false}) {
    EXPECT_EQ(parts_touched(two_rows(first, 3, 2), c), 3u);
    EXPECT_EQ(parts_touched(two_rows(first, 1, 2), c), 1u);
    EXPECT_EQ(parts_touched(two_rows(first, 3, 2, 9), c), 1u);  // not under these rules
    EXPECT_FALSE(has_touch_for_each_part(two_rows(first, 3, 2, 9), c));
  }
  // As many pairs of parts as a feature holds.
  EXPECT_TRUE(has_touch_for_each_part(two_rows(true, 256, 256), c));
  EXPECT_FALSE(has_touch_for_each_part(two_rows(true, 257, 256), c));
  World free = two_rows(true, 3, 2);
  free.bodies[0].kind = Kind::free;
  EXPECT_FALSE(has_touch_for_each_part(free, c));
}

TEST(KeepPointsOf, LeavesThoseOfThePartOfTheFixedBody) {
  const Candidate c{.a = 0, .b = 1};
  for (const bool first : {true, false}) {
    const std::uint32_t parts_a = first ? 3 : 2, parts_b = first ? 2 : 3;
    std::vector<ContactPoint> points(1);  // one that another touch has found before
    for (std::uint32_t a = 0; a < parts_a; ++a) {
      for (std::uint32_t b = 0; b < parts_b; ++b) {
        ContactPoint p;
        p.feature = (a * parts_b + b) << 16 | 5;
        p.depth = first ? a : b;
        points.push_back(p);
      }
    }
    Touch touch;
    touch.part = 2;
    std::vector<ContactPoint> all = points;
    keep_points_of(two_rows(first, 3, 2), c, touch, 1, points);
    ASSERT_EQ(points.size(), 3u);
    EXPECT_EQ(points[1].depth, 2.0);
    EXPECT_EQ(points[2].depth, 2.0);
    keep_points_of(two_rows(first, 3, 2, 9), c, touch, 1, all);
    EXPECT_EQ(all.size(), 7u);
  }
}

TEST(WasLoaded, IsATouchOfTheLastStepThatCarriedSomething) {
  Memory memory;
  memory.loads = {{1.0, 0}, {0.0, 0}, {0.0, 0}, {2.0, 0}};
  memory.touches.resize(2);
  memory.touches[0].first_load = 1;
  memory.touches[0].loads = 2;
  memory.touches[1].first_load = 2;
  memory.touches[1].loads = 2;
  Touch touch;
  EXPECT_FALSE(was_loaded(memory, touch));
  touch.last = 1;
  EXPECT_TRUE(was_loaded(memory, touch));
  touch.fresh = true;
  EXPECT_FALSE(was_loaded(memory, touch));
}

/// Whether two balls, or a ball and a half-space, show only overlap.
bool only_overlap(Query::Mode mode, int rules, bool a_exact, bool b_exact, bool floor = false) {
  World world = make_world({.query = {.mode = mode}, .rules = rules});
  Body a = floor ? floor_body({}) : ball_body({}), b = ball_body({});
  a.exact = a_exact;
  b.exact = b_exact;
  add_body(world, a);
  add_body(world, b, at(Vec3(0, 0, 1)));
  return shows_only_overlap(world, 0, 1) && shows_only_overlap(world, 1, 0);
}

TEST(ShowsOnlyOverlap, IsOfThePapersDetectionBetweenBoundedBodies) {
  EXPECT_TRUE(only_overlap(Query::paper, 14, false, false));
  EXPECT_FALSE(only_overlap(Query::paper, 10, false, false));
  EXPECT_FALSE(only_overlap(Query::converged, 14, false, false));
  EXPECT_FALSE(only_overlap(Query::paper, 14, true, false));
  EXPECT_FALSE(only_overlap(Query::paper, 14, false, true));
  EXPECT_FALSE(only_overlap(Query::paper, 14, false, false, true));
}

}  // namespace
}  // namespace headpin::engine
