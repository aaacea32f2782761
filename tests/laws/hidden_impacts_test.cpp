// An impact is met at its time of impact, whatever else the two bodies do: rest on each other, or be apart at
// the start of the step under the paper's detection. References are closed forms.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/bowling.h"

namespace headpin::engine {
namespace {

constexpr Material kSmoothElastic{1.0, 0.0};

World without_gravity(int rules, int rate_hz = 240, Query::Mode mode = Query::converged) {
  Parameters parameters;
  parameters.rules = rules;
  parameters.gravity_W = Vec3::Zero();
  parameters.rate_hz = rate_hz;
  parameters.query.mode = mode;
  return make_world(parameters);
}

/// Two balls of 3 cm, 0.4 m apart, on a floor without gravity: the left one sinks slowly from a gap of
/// 0.1 mm, the right one at 4 m/s from 8 mm, so that it has to bounce after 2 ms.
struct Dumbbell {
  static constexpr double kRadius = 0.03, kArm = 0.2, kSlow = 1e-4, kFast = 8e-3;

  explicit Dumbbell(double left_sinks, int rules) : world(without_gravity(rules)) {
    add_body(world, floor_body(kSmoothElastic));
    std::vector<Part> balls;
    for (const double x : {-kArm, kArm}) {
      balls.push_back({Ellipsoid{Vec3::Constant(kRadius)}, {Quat::Identity(), {x, 0, 0}}});
    }
    Body body{.name = "dumbbell", .shape = make_compound(balls), .material = kSmoothElastic};
    body.inertia = Vec3(0.002, 0.04, 0.04).asDiagonal();
    const double lean = std::asin((kFast - kSlow) / (2.0 * kArm));
    const Quat turn(Eigen::AngleAxisd(-lean, Vec3::UnitY()));
    const Vec3 p(0.0, 0.0, kRadius + 0.5 * (kFast + kSlow));
    const Vec3 v(0.0, 0.0, -0.5 * (4.0 + left_sinks)), w(0.0, (4.0 - left_sinks) / 0.4, 0.0);
    id = add_body(world, body, at(Pose{turn, p}, v, w));
  }

  /// Height of the lowest point of the right ball [m].
  double right() const { return (world.states[id].X_WB * Vec3(kArm, 0, 0)).z() - kRadius; }

  World world;
  BodyId id = 0;
};

TEST(HiddenImpacts, ASlowContactOfTheSameBodiesHidesNone) {
  for (const double sinks : {-0.01, 0.01, 0.05, 0.1, 0.14, 0.16, 0.3}) {
    SCOPED_TRACE(sinks);
    Dumbbell d(sinks, 11);
    step(d.world);
    EXPECT_GE(d.world.statistics.impacts, 1);
    EXPECT_GT(d.right(), 5e-3);  // 8 mm below where it began, and back again
    EXPECT_LT(d.world.statistics.queries.queries, 40);
  }
  Dumbbell older(0.1, 10);  // as it was
  step(older.world);
  EXPECT_LT(older.right(), -5e-3);
}

/// A pin's fall onto the floor from a random attitude, turning: the deepest that it gets into it [m].
double deepest_of_fall(std::mt19937_64& random, int rate_hz, int rules) {
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  Parameters parameters;
  parameters.rate_hz = rate_hz;
  parameters.rules = rules;
  World world = make_world(parameters);
  add_body(world, floor_body({0.7, 0.7}));
  const Quat turn = Quat(any(random), any(random), any(random), any(random)).normalized();
  const Vec3 v(any(random), any(random), any(random)), w(any(random), any(random), any(random));
  add_body(world, skittle_body({0.7, 0.7}), at(Pose{turn, {0.0, 0.0, 0.4}}, v, 12.0 * w));
  Workspace workspace;
  double deepest = 0.0;
  for (int k = 0; k < 2 * rate_hz; ++k) {
    step(world, workspace);
    deepest = std::max(deepest, world.statistics.deepest_overlap);
  }
  return deepest;
}

TEST(HiddenImpacts, AFallingPinIsNotCaughtTooDeep) {
  double older = 0.0;
  for (const int rate_hz : {60, 120, 240}) {
    SCOPED_TRACE(rate_hz);
    std::mt19937_64 random(1997);
    double deepest = 0.0;
    for (int k = 0; k < 100; ++k) deepest = std::max(deepest, deepest_of_fall(random, rate_hz, 11));
    EXPECT_LT(deepest, rate_hz == 240 ? 1e-3 : 4.7e-3);  // of a radius of 0.235 m
    for (int k = 0; k < 100; ++k) older = std::max(older, deepest_of_fall(random, rate_hz, 10));
  }
  EXPECT_GT(older, 8e-3);  // as it was
}

/// A ball of 10.85 cm at 6 m/s meets one of 6.05 cm that rests, smooth and elastic, `beside` its centre: the
/// velocity of that one, and the largest overlap.
struct Struck {
  double direction = 0.0, speed = 0.0, overlap = 0.0;  // [deg], [m/s], [m]
};

Struck strike(double beside, double from, int rate_hz, int rules) {
  constexpr double kRadius = 0.1085, kOther = 0.0605;
  World world = without_gravity(rules, rate_hz, Query::paper);
  const BodyId ball = add_body(world, ball_body(kSmoothElastic, kRadius, 6.8),
                               at(Vec3(-from, beside, 0.0), Vec3(6.0, 0.0, 0.0)));
  const BodyId other = add_body(world, ball_body(kSmoothElastic, kOther, 1.588), at(Vec3::Zero()));
  Struck struck;
  for (int k = 0; k < rate_hz / 2; ++k) {
    step(world);
    const double apart = (world.states[ball].X_WB.p - world.states[other].X_WB.p).norm();
    struck.overlap = std::max(struck.overlap, kRadius + kOther - apart);
  }
  const Vec3& v = world.states[other].v_WB;
  struck.speed = v.norm();
  struck.direction = std::atan2(-v.y(), v.x()) * 180.0 / std::numbers::pi;
  return struck;
}

TEST(HiddenImpacts, ThePapersDetectionMeetsBodiesThatWereApartAtTheirTime) {
  for (const int rate_hz : {60, 240, 1000}) {
    for (const double beside : {0.04, 0.08, 0.12, 0.15}) {
      for (int phase = 0; phase < 20; ++phase) {
        SCOPED_TRACE(testing::Message() << rate_hz << " Hz, " << beside << " m, " << phase);
        const Struck struck = strike(beside, 0.7 + 6.0 / rate_hz * phase / 20, rate_hz, 11);
        EXPECT_NEAR(struck.direction, std::asin(beside / 0.169) * 180.0 / std::numbers::pi, 0.1);
        const double along = std::sqrt(1.0 - std::pow(beside / 0.169, 2));
        EXPECT_NEAR(struck.speed, 2.0 * 6.8 / (6.8 + 1.588) * 6.0 * along, 0.01);
        EXPECT_LT(struck.overlap, 1e-4);
      }
    }
  }
  EXPECT_GT(strike(0.04, 0.7, 240, 10).overlap, 5e-3);  // as it was
}

TEST(HiddenImpacts, UnderThePapersDetectionFastBallsDoNotPassThroughEachOther) {
  World world = without_gravity(11, 240, Query::paper);
  for (const double side : {-1.0, 1.0}) {
    add_body(world, ball_body(kSmoothElastic, 0.02, 1.0),
             at(Vec3(0.5 * side + 0.01, 0.0, 0.0), Vec3(-6.0 * side, 0.0, 0.0)));
  }
  run(world, 0.25);
  EXPECT_NEAR(world.states[0].v_WB.x(), -6.0, 1e-9);
  EXPECT_NEAR(world.states[1].v_WB.x(), 6.0, 1e-9);
}

// It was seen to come with gravity's part in its speed, and then taken for a lasting contact in the air.
TEST(HiddenImpacts, UnderThePapersDetectionABallThatLandsSlowlyIsNotBrakedInTheAir) {
  for (const int rate_hz : {60, 120, 240}) {
    for (int n = 0; n < 100; ++n) {
      Parameters parameters;
      parameters.rate_hz = rate_hz;
      parameters.query.mode = Query::paper;
      World world = make_world(parameters);
      Body support = ball_body({0.7, 0.0}, 0.1, 1.0);
      support.kind = Kind::fixed;
      add_body(world, support);
      double gap = 2e-4 + 5.8e-3 / 99.0 * n, speed = 0.0;
      const BodyId ball =
          add_body(world, ball_body({0.7, 0.0}, 0.1, 1.0), at(Vec3(0.0, 0.0, 0.2 + gap)));
      for (int k = 0; k < 0.3 * rate_hz; ++k) {
        step(world);
        const State& now = world.states[ball];
        const double there = now.X_WB.p.z() - 0.2, v = now.v_WB.z();
        if (gap > 1e-4 && there > 1e-4 && world.statistics.impacts == 0) {
          EXPECT_NEAR(v, speed - 9.81 / rate_hz, 1e-6) << rate_hz << " " << n << " " << k;
        }
        const double gain = 9.81 * (there - gap) + 0.5 * (v * v - speed * speed);
        EXPECT_LT(gap > 0.0 ? gain : 0.0, 1e-6) << rate_hz << " " << n << " " << k;
        gap = there;
        speed = v;
      }
    }
  }
}

TEST(HiddenImpacts, UnderThePapersDetectionPartsOfAFixedBodyAreMetInTimeToo) {
  World world = without_gravity(11, 240, Query::paper);
  const Shape post = Ellipsoid{Vec3::Constant(0.06)};
  const auto place = [](double y) { return Pose{Quat::Identity(), Vec3(0.0, y, 0.0)}; };
  add_body(world, {.name = "posts",
                   .shape = make_compound({{post, place(-0.2)}, {post, place(0.2)}}),
                   .material = kSmoothElastic,
                   .kind = Kind::fixed});
  const BodyId ball = add_body(world, ball_body(kSmoothElastic, 0.1, 1.0),
                               at(Vec3(-0.7, 0.23, 0.0), Vec3(6.0, 0.0, 0.0)));
  double closest = 1.0;
  for (int k = 0; k < 120; ++k) {
    step(world);
    closest = std::min(closest, (world.states[ball].X_WB.p - place(0.2).p).norm());
  }
  EXPECT_GT(closest, 0.16 - 1e-4);
  EXPECT_LT(world.states[ball].v_WB.x(), 0.0);
}

// Where a plane of the paper says that what meets moves apart, the search for an impact ends.
TEST(HiddenImpacts, UnderThePapersDetectionTheSearchForAnImpactEnds) {
  std::mt19937_64 random(16);
  std::normal_distribution<double> any;
  const auto vector = [&] { return Vec3(any(random), any(random), any(random)); };
  std::int64_t most = 0;
  for (int n = 0; n < 200; ++n) {
    World world = without_gravity(11, 60, Query::paper);
    for (const double side : {-1.0, 1.0}) {
      const Quat turn = Quat(any(random), any(random), any(random), any(random)).normalized();
      add_body(world, solid(Cylinder{0.06, 0.1}, {0.8, 0.6}),
               at(Pose{turn, Vec3(0.3 * side, 0, 0) + 0.05 * vector()}, Vec3(-2.0 * side, 0.0, 0.0),
                  5.0 * vector()));
    }
    for (int k = 0; k < 20; ++k) {
      step(world);
      most = std::max(most, world.statistics.queries.queries);
    }
  }
  EXPECT_LT(most, 200);
}

/// A turning ball and a turning ellipsoid meet with elasticity 0 and friction 0.49, without gravity: the velocity of
/// the ball after that step, in a frame that is turned. What they do depends on the seed.
std::optional<Vec3> goes_on(unsigned seed, const Quat& turn, int rules) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> any;
  const auto vector = [&] { return Vec3(any(random), any(random), any(random)); };
  const Vec3 d = vector().normalized();
  constexpr Material kRough{0.0, 0.7};
  World world = without_gravity(rules, 60);
  const BodyId ball = add_body(world, solid(Ellipsoid{Vec3::Constant(0.1)}, kRough, 1.0),
                               at(turn * Vec3::Zero(), Vec3::Zero(), turn * (3.0 * vector())));
  const Quat attitude = Quat(any(random), any(random), any(random), any(random)).normalized();
  add_body(world, solid(Ellipsoid{{0.15, 0.1, 0.06}}, kRough, 1.0),
           at(Pose{turn * attitude, turn * (0.8 * d)}, turn * (0.4 * vector() - 4.0 * d),
              turn * (3.0 * vector())));
  for (int k = 0; k < 60; ++k) {
    step(world);
    if (!world.events.empty()) return turn.conjugate() * world.states[ball].v_WB;
  }
  return {};
}

/// Number of collisions after which the frame decides how the ball goes on.
int depend_on_the_frame(int rules) {
  std::mt19937_64 random(2026);
  std::normal_distribution<double> any;
  int count = 0, collisions = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    const std::optional<Vec3> straight = goes_on(seed, Quat::Identity(), rules);
    if (!straight) continue;
    ++collisions;
    bool same = true;
    for (int n = 0; n < 12; ++n) {
      const Quat turn = Quat(any(random), any(random), any(random), any(random)).normalized();
      const std::optional<Vec3> v = goes_on(seed, turn, rules);
      same = same && v && (*v - *straight).norm() < 1e-4;
    }
    count += same ? 0 : 1;
  }
  EXPECT_GT(collisions, 40);
  return count;
}

TEST(HiddenImpacts, FrictionAfterAnInelasticOneDoesNotDependOnTheFrame) {
  EXPECT_EQ(depend_on_the_frame(11), 0);
  EXPECT_GT(depend_on_the_frame(10), 0);  // as it was
}

}  // namespace
}  // namespace headpin::engine
