// What a lane is made of: gutters that a ball falls into, skittles like their profile, the scenes that
// come along.

#include <algorithm>
#include <filesystem>

#include <gtest/gtest.h>

#include "scene/scenario/scenario.h"
#include "scene/stage/outline.h"
#include "scene/stage/read_scenario.h"
#include "scene/stage/stage.h"

namespace headpin::scene {
namespace {

Scenario with_gutters(double depth) {
  Scenario scenario;
  scenario.lane.gutter_width = 0.235;
  scenario.lane.gutter_depth = depth;
  return scenario;
}

/// A ball that rolls from the foul line, so far right and so many degrees to the right.
struct Rolling {
  Stage stage;
  engine::World world;
  engine::BodyId ball;

  Rolling(const Scenario& scenario, double x, double aside)
      : stage(make_stage(scenario)), world(stage.world), ball(stage.balls.front()) {
    const double r = scenario.ball.radius, speed = 5.0;
    const SinCos turn = sin_cos(aside);
    engine::State state;
    state.X_WB.p = Vec3(x, 0.2, r);
    state.v_WB = speed * Vec3(turn.sin, turn.cos, 0.0);
    state.w_WB = Vec3::UnitZ().cross(state.v_WB) / r;
    engine::set_kind(world, ball, engine::Kind::free);
    engine::set_state(world, ball, state);
  }
  const Vec3& p() const { return world.states[ball].X_WB.p; }
  void roll_to(double y) {
    for (int k = 0; k < 2400 && p().y() < y; ++k) engine::step(world);
  }
  int skittles_moved() const {
    int moved = 0;
    for (const engine::BodyId skittle : stage.skittles) {
      moved += world.states[skittle].X_WB.p != stage.world.states[skittle].X_WB.p ? 1 : 0;
    }
    return moved;
  }
};

// It falls in, rolls along the bottom between the sides, and passes the skittles.
TEST(Gutter, ABallThatLeavesTheLaneRollsAlongItToTheEnd) {
  for (const double side : {-1.0, 1.0}) {
    const Scenario scenario = with_gutters(0.048);
    const double r = scenario.ball.radius, half = 0.5 * scenario.lane.width;
    Rolling ball(scenario, side * 0.35, side * 0.09);
    ball.roll_to(5.5);
    ASSERT_GE(ball.p().y(), 5.5);
    while (ball.p().y() < 7.4) {
      engine::step(ball.world);
      EXPECT_GT(side * ball.p().x(), half);
      EXPECT_LT(side * ball.p().x(), half + 0.235);
      EXPECT_LT(ball.p().z(), r);
    }
    EXPECT_EQ(ball.skittles_moved(), 0);
  }
}

TEST(Gutter, ABallAtRestInItLiesItsDepthBelowTheLane) {
  const Scenario scenario = with_gutters(0.048);
  Rolling ball(scenario, 0.5 * scenario.lane.width + 0.1175, 0.0);
  engine::State state = ball.world.states[ball.ball];
  state.v_WB = state.w_WB = Vec3::Zero();
  engine::set_state(ball.world, ball.ball, state);
  for (int k = 0; k < 1200; ++k) engine::step(ball.world);
  EXPECT_NEAR(ball.p().z(), scenario.ball.radius - 0.048, 1e-4);
}

TEST(Gutter, PaintedOnTheFloorABallRollsOverIt) {
  const Scenario scenario = with_gutters(0.0);
  Rolling ball(scenario, 0.35, 0.09);
  ball.roll_to(7.0);
  EXPECT_GT(ball.p().x(), 0.5 * scenario.lane.width + 0.235);
  EXPECT_NEAR(ball.p().z(), scenario.ball.radius, 1e-6);
}

// The lane beside gutters is a block and not a plane: a ball and skittles find it as flat.
TEST(Gutter, TheLaneBesideItIsAsFlatAsAPlane) {
  Rolling plane(with_gutters(0.0), 0.05, 0.0), block(with_gutters(0.048), 0.05, 0.0);
  plane.roll_to(5.5);
  block.roll_to(5.5);
  EXPECT_NEAR(block.p().x(), plane.p().x(), 1e-6);
  EXPECT_NEAR(block.p().z(), plane.p().z(), 1e-6);
  EXPECT_NEAR(block.world.states[block.ball].v_WB.y(), plane.world.states[plane.ball].v_WB.y(),
              1e-3);
}

/// Largest distance from the axis of the parts at a height.
double radius_of_parts(const std::vector<SkittlePart>& parts, double height) {
  double widest = 0.0;
  for (const SkittlePart& part : parts) {
    if (height < part.low || height > part.high) continue;
    const double share = (height - part.low) / (part.high - part.low);
    const double radius = part.shape == PartShape::cylinder ? part.radius
                          : part.shape == PartShape::cone
                              ? part.radius * (1.0 - share)
                              : 2.0 * part.radius * std::sqrt(share * (1.0 - share));
    widest = std::max(widest, radius);
  }
  return widest;
}

/// How far a point (height, radius) is from the outline of the parts [m].
double distance_to_parts(const std::vector<SkittlePart>& parts, const Vec2& point) {
  constexpr double kStep = 1e-4;
  const double top = std::ranges::max(parts, {}, &SkittlePart::high).high;
  double nearest = 1.0;
  for (double h = std::max(0.0, point.x() - 0.02); h <= std::min(top, point.x() + 0.02);
       h += kStep) {
    nearest = std::min(nearest, (Vec2(h, radius_of_parts(parts, h)) - point).norm());
  }
  return std::min(nearest, (Vec2(top, 0.0) - point).norm());
}

// The parts that collide are the measured pin within 2 mm: across the axis where it is measured, and
// everywhere along its outline, round top included.
TEST(TenPin, OfPrimitivesIsItsProfileWithinTwoMillimetres) {
  const Skittle skittle = Scenario().skittle;
  for (const Vec2& point : skittle.profile) {
    if (point.x() == skittle.height) continue;  // the tip
    EXPECT_NEAR(radius_of_parts(skittle.parts, point.x()), point.y(), 2e-3) << point.x();
  }
  for (const Vec2& point : smooth_outline(skittle.profile)) {
    EXPECT_LT(distance_to_parts(skittle.parts, point), 2e-3) << point.x();
  }
}

// A uniform solid of the profile, whose figures were worked out apart from this program.
TEST(TenPin, HasTheMassPropertiesOfItsProfile) {
  const Scenario scenario;
  const auto [body, centre_height] = skittle_body(scenario);
  EXPECT_NEAR(body.mass, 1.588, 1e-12);
  EXPECT_NEAR(centre_height, 0.1474, 0.0005);
  EXPECT_NEAR(body.inertia(0, 0), 1.344e-2, 0.01 * 1.344e-2);
  EXPECT_NEAR(body.inertia(2, 2), 1.97e-3, 0.01 * 1.97e-3);
  Scenario parts = scenario;
  parts.skittle.weighed = Weighed::parts;
  EXPECT_NE(skittle_body(parts).centre_height, centre_height);
}

TEST(TurnedMass, OfAnEllipsoidsOutlineIsTheEllipsoids) {
  const double a = 0.06, c = 0.19, mass = 1.5;
  const engine::MassProperties found = turned_mass(ellipsoid_outline(2.0 * c, a), mass);
  EXPECT_NEAR(found.centre.z(), c, 1e-9);
  EXPECT_NEAR(found.inertia(2, 2), 0.4 * mass * a * a, 1e-3 * mass * a * a);
  EXPECT_NEAR(found.inertia(0, 0), 0.2 * mass * (a * a + c * c), 1e-3 * mass * c * c);
}

std::vector<std::string> bundled_files() {
  std::vector<std::string> files;
  for (const auto& entry :
       std::filesystem::directory_iterator(HEADPIN_SOURCE_DIR "/assets/scenarios")) {
    files.push_back(entry.path().string());
  }
  std::ranges::sort(files);
  return files;
}

// Awake, for sleep would hide that something creeps.
TEST(BundledScenario, StandsUntouchedForAMinute) {
  for (const std::string& file : bundled_files()) {
    for (const SkittleShape shape : {SkittleShape::parts, SkittleShape::ellipsoid}) {
      Scenario scenario = load_scenario(file);
      scenario.collision.shape = shape;
      const Stage stage = make_stage(scenario);
      engine::World world = stage.world;
      if (shape == SkittleShape::parts) {
        for (const engine::BodyId skittle : stage.skittles) engine::wake(world, skittle);
      }
      for (int k = 0; k < 60 * 240; ++k) engine::step(world);
      for (const engine::BodyId skittle : stage.skittles) {
        const Pose &now = world.states[skittle].X_WB, &before = stage.world.states[skittle].X_WB;
        EXPECT_LT((now.p - before.p).norm(), 1e-4)
            << file << " " << name_of(shape) << " " << skittle;
        EXPECT_GT((now.q * Vec3::UnitZ()).z(), 1.0 - 1e-6) << file << " " << name_of(shape);
      }
    }
  }
}

// The paper's data set had 7 compound objects of 22 primitives.
TEST(PaperObjects, AreSevenOfTwentyTwoPrimitives) {
  const Stage stage =
      make_stage(load_scenario(HEADPIN_SOURCE_DIR "/assets/scenarios/paper-objects.toml"));
  std::size_t objects = 0, primitives = 0;
  for (const engine::Body& body : stage.world.bodies) {
    const std::size_t parts = body.shape->parts.size();
    if (parts < 2) continue;
    ++objects;
    primitives += parts;
  }
  EXPECT_EQ(objects, 7u);
  EXPECT_EQ(primitives, 22u);
}

}  // namespace
}  // namespace headpin::scene
