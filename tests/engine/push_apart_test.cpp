#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "engine/at_end.h"
#include "engine/bodies.h"
#include "engine/stages.h"
#include "tests/support/bowling.h"
#include "tests/support/random_shapes.h"

// The last stage of a step, which takes overlaps back, with touches made up for it.
namespace headpin::engine {
namespace {

using namespace detail;

constexpr BodyId kDriven = 0, kFree = 1, kOther = 2, kFixed = 3;
constexpr double kBodySlop = 5e-5, kPush = 0.2;  // the defaults, at 240 Hz

State block_at(Random& random, double x) {
  return at(Pose{any_rotation(random), Vec3(x, 0.0, 0.0)});
}

/// A driven body, two free ones and a fixed one, and what the earlier stages say of their touches.
struct Overlaps {
  explicit Overlaps(const Parameters& parameters = {.rate_hz = 240}, std::uint64_t seed = 5)
      : world(make_world(parameters)) {
    Random random(seed);
    const Kind kinds[] = {Kind::driven, Kind::free, Kind::free, Kind::fixed};
    for (int i = 0; i < 4; ++i) {
      Body body = solid(test::box({0.3, 0.2, 0.1 + 0.05 * i}), {0.0, 0.0}, 2.0 + i);
      body.kind = kinds[i];
      add_body(world, body, block_at(random, 2.0 * i));
    }
    depart(world, own);
  }
  double deep(double times) const { return times * deep_for(world, kFree, kFixed); }
  Touch& add(BodyId a, BodyId b, const ContactPoint& point) {
    Touch touch;
    touch.a = a;
    touch.b = b;
    touch.b_moves = world.bodies[b].kind == Kind::free;
    touch.b_driven = world.bodies[b].kind == Kind::driven;
    touch.first_point = static_cast<std::uint32_t>(touches.points.size());
    touch.points = 1;
    SolvedTouch result;
    result.depth = point.depth;
    result.first_deep = static_cast<std::uint32_t>(solved.deep_rows.size());
    result.deep = 1;
    DeepRow row;
    row.row = row_at(own.flight, touch, point, world.states[a].X_WB.p, world.states[b].X_WB.p);
    row.point = touch.first_point;
    solved.deep_rows.push_back(row);
    solved.touches.push_back(result);
    touches.points.push_back(point);
    touches.all.push_back(touch);
    return touches.all.back();
  }
  void push(Workspace& w) {
    for (const State& s : world.states) before.push_back(s.X_WB);
    push_apart(world, touches, own.flight, solved, w);
  }
  void push() { push(own); }
  Vec3 moved(BodyId i) const { return world.states[i].X_WB.p - before[i].p; }
  Vec3 turned(BodyId i) const {
    const Eigen::AngleAxisd turn(world.states[i].X_WB.q * before[i].q.conjugate());
    return turn.angle() * turn.axis();
  }
  /// By how much the surfaces of a touch have parted at its point.
  double parted(std::size_t k) const {
    const Touch& touch = touches.all[k];
    const ContactPoint& point = touches.points[touch.first_point];
    const auto along = [&](BodyId i) {
      return point.n_AB_W.dot(moved(i) + turned(i).cross(point.p_W - before[i].p));
    };
    return along(touch.b) - along(touch.a);
  }

  World world;
  Workspace own;
  Touches touches;
  Solved solved;
  std::vector<Pose> before;
};

/// A point 0.1 m beside the middle of the free body: a push there turns the body.
ContactPoint beside(double depth, const Vec3& n = Vec3(0.0, 0.6, -0.8)) {
  ContactPoint point;
  point.p_W = Vec3(2.1, 0.05, 0.02);
  point.n_AB_W = n;
  point.depth = depth;
  return point;
}

// Each push counts what earlier ones have done, of both bodies, by their ways and by their turns.
TEST(PushApart, PartsTheLastPointByItsPartWhateverWasPushedBefore) {
  Random random(31);
  for (int trial = 0; trial < 200; ++trial) {
    Overlaps at({.rate_hz = 240}, random.next());
    const auto point = [&](double depth) {
      ContactPoint p;
      p.p_W = Vec3(3.0, 0.0, 0.0) + 0.3 * direction(random);
      p.n_AB_W = direction(random);
      p.depth = depth;
      return p;
    };
    const BodyId pairs[][2] = {{kFree, kOther}, {kFree, kFixed}, {kOther, kDriven}};
    for (int k = 0; k < 6; ++k) {
      const auto& pair = pairs[index_below(random, 3)];
      at.add(pair[0], pair[1], point(random.uniform(0.0, 1e-4)));
    }
    const auto& last = pairs[trial % 3];
    at.add(last[0], last[1], point(1e-3));
    at.push();
    EXPECT_NEAR(at.parted(6), kPush * (1e-3 - kBodySlop), 1e-9);
    EXPECT_EQ(at.moved(kFixed), Vec3::Zero());
    EXPECT_EQ(at.moved(kDriven), Vec3::Zero());
  }
}

TEST(PushApart, PushesByEachPointOfATouch) {
  Overlaps at;
  at.add(kOther, kFixed, beside(0.0));
  at.add(kFree, kFixed, beside(1e-3, Vec3::UnitX()));
  at.add(kFree, kFixed, beside(2e-3, Vec3::UnitY()));
  at.touches.all.pop_back();  // its row becomes the second one of the touch before
  at.solved.touches.pop_back();
  at.solved.touches[1].deep = 2;
  at.push();
  EXPECT_LT(at.moved(kFree).x(), -1e-5);
  EXPECT_LT(at.moved(kFree).y(), -1e-5);
  EXPECT_EQ(at.moved(kOther), Vec3::Zero());
}

// What is not deeper than the slop is left, even where another push has made it deeper.
TEST(PushApart, LeavesAnOverlapOfTheSlop) {
  for (const double depth : {kBodySlop, std::nextafter(kBodySlop, 1.0)}) {
    Overlaps at;
    at.add(kFree, kFixed, beside(1e-3, Vec3(0.0, 1.0, 0.0)));
    at.add(kFree, kFixed, beside(depth, Vec3(0.0, -1.0, 0.0)));
    at.push();
    const double first = kPush * (1e-3 - kBodySlop);
    EXPECT_NEAR(at.parted(0), depth > kBodySlop ? 0.0 : first, 1e-9);
  }
}

// Where paper detection stopped at its cap, the depth is an estimate.
TEST(PushApart, MovesByAnEstimateAcrossGravityOnly) {
  for (const Vec3& gravity : {Vec3(0.0, 0.0, -9.81), Vec3(3.0, 1.0, -9.0), Vec3(0.0, 0.0, 0.0)}) {
    Overlaps at({.rate_hz = 240, .gravity_W = gravity});
    ContactPoint point = beside(1e-3);
    point.guessed = true;
    at.add(kFree, kOther, point);
    at.push();
    const Vec3 n = point.n_AB_W;
    const Vec3 up = gravity.isZero() ? gravity : Vec3(gravity.normalized());
    const double impulse = at.solved.deep_rows[0].row.mass * kPush * (point.depth - kBodySlop);
    const Vec3 F = impulse * (n - n.dot(up) * up);
    EXPECT_LT((at.moved(kFree) * at.world.bodies[kFree].mass + F).norm(), 1e-12);
    EXPECT_LT((at.moved(kOther) * at.world.bodies[kOther].mass - F).norm(), 1e-12);
    EXPECT_LT(at.turned(kFree).norm() + at.turned(kOther).norm(), 1e-12);
  }
}

// A body of which it is known where its points are at the end of the step is pushed there.
TEST(PushApart, LooksAgainWhereABodySwings) {
  World world = make_world({.rate_hz = 240});
  add_body(world, floor_body({1.0, 0.0}));
  add_body(world, ball_body({1.0, 0.0}), at(Vec3(0.0, 0.0, kBallRadius - 1e-3)));
  Workspace w;
  Touches& touches = find_touches(world, w);
  const Flight& flight = *resolve_impacts(world, touches, w);
  Solved& solved = sustain(world, touches, flight, w);
  world.states[1].X_WB.p.z() -= 1e-3;
  for (SolvedTouch& touch : solved.touches) touch.swings = true;
  push_apart(world, touches, flight, solved, w);
  EXPECT_NEAR(world.states[1].X_WB.p.z() - (kBallRadius - 2e-3), kPush * (2e-3 - kBodySlop), 1e-9);
}

/// What is told of the overlaps of a free body with a driven one, and with another behind it.
struct Pressed {
  const char* name;
  bool pinned;
  double driven = 1e-3;   ///< overlap with the driven body [m]
  double behind = 5.001;  ///< overlap with the other one, in deep ones
  int rules = Parameters{}.rules;
  BodyId by = kDriven, other = kFixed;
  std::uint32_t points = 1, points_behind = 1;
};

const Pressed kPressed[] = {
    {.name = "pressed far into a fixed body", .pinned = true},
    {.name = "under older rules", .pinned = false, .rules = 1},
    {.name = "five deep ones", .pinned = false, .behind = 5.0},
    {.name = "no point behind", .pinned = false, .points_behind = 0},
    {.name = "no point at the driven body", .pinned = false, .points = 0},
    {.name = "the slop", .pinned = false, .driven = kBodySlop},
    {.name = "over the slop", .pinned = true, .driven = std::nextafter(kBodySlop, 1.0)},
    {.name = "far into the driven body", .pinned = true, .driven = 0.05, .behind = 0.1},
    {.name = "behind it a free body", .pinned = true, .other = kOther},
    {.name = "pressed by none", .pinned = false, .by = kFixed},
};

// A body that a driven one presses far into something is not turned, nor lifted out of the driven one.
TEST(PushApart, TurnsNoBodyThatADrivenOnePressesFarIn) {
  Workspace w;  // what it holds of the last case has no meaning for the next
  for (const Pressed& c : kPressed) {
    SCOPED_TRACE(c.name);
    Overlaps at({.rate_hz = 240, .rules = c.rules});
    ContactPoint behind = beside(c.behind * at.deep(1.0), Vec3(0.0, 1.0, 0.0));
    if (c.other == kOther) {  // which is A of that touch
      behind.n_AB_W = -behind.n_AB_W;
      at.add(kOther, kFree, behind).points = c.points_behind;
    } else {
      at.add(kFree, c.other, behind).points = c.points_behind;
    }
    at.add(kFree, c.by, beside(c.driven)).points = c.points;
    at.push(w);
    EXPECT_EQ(at.turned(kFree).norm() < 1e-12, c.pinned);
    if (c.pinned) {
      EXPECT_NEAR(at.moved(kFree).z(), 0.0, 1e-15);
    }
  }
}

// It is pinned for all of its touches, and no other body is.
TEST(PushApart, TurnsAndLiftsTheBodiesBesideAPinnedOne) {
  Overlaps at;
  at.add(kFree, kFixed, beside(at.deep(5.001)));
  at.add(kFree, kDriven, beside(1e-3));
  at.add(kOther, kFixed, beside(at.deep(6.0)));
  at.add(kOther, kFixed, beside(1e-3));
  at.push();
  EXPECT_LT(at.turned(kFree).norm(), 1e-12);
  EXPECT_GT(at.moved(kFree).z(), 1e-4);  // out of the fixed one
  EXPECT_GT(at.turned(kOther).norm(), 1e-4);
  EXPECT_GT(at.moved(kOther).z(), 1e-5);
}

// A driven body that is far in nothing lifts and turns what it meets, whatever others are far in.
TEST(PushApart, TakesNoBodyForPinnedThatIsNotFarInItself) {
  Overlaps at;
  at.add(kOther, kFixed, beside(at.deep(6.0)));
  at.add(kFree, kDriven, beside(1e-3));
  at.push();
  EXPECT_GT(at.turned(kFree).norm(), 1e-4);
  EXPECT_GT(at.moved(kFree).z(), 1e-5);
}

}  // namespace
}  // namespace headpin::engine
