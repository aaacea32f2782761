#include "scene/stage/bodies.h"

#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include <gtest/gtest.h>

#include "scene/record/log.h"
#include "scene/stage/read_scenario.h"
#include "scene/stage/stage.h"

namespace headpin::scene {
namespace {

TEST(SkittleBody, WeighsWhatItsScenarioSaysAndBalancesWhereAPinDoes) {
  const Scenario scenario;
  const auto [body, centre_height] = skittle_body(scenario);
  EXPECT_NEAR(body.mass, 1.588, 1e-12);
  EXPECT_NEAR(centre_height, 0.1474, 0.01);  // of a pin's profile; ours are primitives
  EXPECT_NEAR(body.inertia(0, 0), 1.344e-2, 0.1 * 1.344e-2);
  EXPECT_NEAR(body.inertia(2, 2), 1.97e-3, 0.1 * 1.97e-3);
  Scenario ellipsoid = scenario;
  ellipsoid.collision.shape = SkittleShape::ellipsoid;
  EXPECT_EQ(skittle_body(ellipsoid).centre_height, centre_height);
  ellipsoid.skittle.ellipsoid_weighed = WeighedEllipsoid::itself;
  EXPECT_NEAR(skittle_body(ellipsoid).centre_height, 0.5 * 0.381, 1e-9);
}

Scenario of_one_mesh(std::vector<Vec3> corners) {
  Scenario scenario;
  SkittlePart part;
  part.shape = PartShape::polyhedron;
  part.corners = std::move(corners);
  part.faces = {{3, 2, 1, 0}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  scenario.skittle.parts = {part};
  scenario.skittle.weighed = Weighed::parts;
  scenario.skittle.mass = 1.0;
  return scenario;
}

/// The corners of a box on the floor, in the order of of_one_mesh.
std::vector<Vec3> box_corners(const Vec3& size) {
  std::vector<Vec3> corners;
  for (const double z : {0.0, size.z()}) {
    for (const auto& [x, y] : {std::array{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}) {
      corners.emplace_back(x * size.x(), y * size.y(), z);
    }
  }
  return corners;
}

// A plank 40 degrees aslant, by hand: m / 12 (a^2 + b^2), turned.
TEST(SkittleBody, OfAMeshStandsAsTheMeshDoes) {
  const Vec3 size(0.04, 0.36, 0.30);
  const Mat3 R =
      Eigen::AngleAxisd(40.0 * std::numbers::pi / 180.0, Vec3::UnitZ()).toRotationMatrix();
  std::vector<Vec3> corners = box_corners(size);
  for (Vec3& p : corners) p = R * p;
  Scenario scenario = of_one_mesh(corners);
  const auto [body, centre_height] = skittle_body(scenario);
  EXPECT_NEAR(centre_height, 0.15, 1e-12);
  const Vec3 squares = size.cwiseAbs2();
  const Vec3 own((squares.y() + squares.z()) / 12.0, (squares.x() + squares.z()) / 12.0,
                 (squares.x() + squares.y()) / 12.0);
  EXPECT_NEAR((body.inertia - R * own.asDiagonal() * R.transpose()).norm(), 0.0, 1e-12);
  const engine::Part& part = body.shape->parts.at(0);
  double farthest = 0.0;
  for (const Vec3& p_G : std::get<engine::Polyhedron>(part.shape).vertices()) {
    const Vec3 p = part.X_BG * p_G + Vec3(0.0, 0.0, centre_height);
    double nearest = 1.0;
    for (const Vec3& corner : corners) nearest = std::min(nearest, (p - corner).norm());
    farthest = std::max(farthest, nearest);
  }
  EXPECT_NEAR(farthest, 0.0, 1e-12);
}

// Of a cube all axes are principal axes, until it is sheared by a millionth.
TEST(SkittleBody, OfAMeshThatIsNearlyACubeStands) {
  std::vector<Vec3> corners = box_corners(Vec3::Constant(0.1));
  for (Vec3& p : corners) p.x() += 1e-6 * (p.z() - 0.05) + 2e-6 * p.y();
  Scenario scenario = of_one_mesh(corners);
  EXPECT_NEAR(skittle_body(scenario).centre_height, 0.05, 1e-6);
  scenario.collision.rules = 8;
  EXPECT_THROW(skittle_body(scenario), std::invalid_argument);
}

TEST(BodyNames, TellTheRolesOfTheBodiesThatMove) {
  Scenario scenario;
  scenario.hand.solid = true;
  scenario.lane.kick_backs = scenario.lane.masking_panel = true;
  Stage stage = make_stage(scenario);
  add_ball(stage, {1.0, 0.0, 1.0});
  const std::vector<std::string> names = body_names(stage);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const bool fixed = stage.roles[i] == Role::lane || stage.roles[i] == Role::wall;
    EXPECT_EQ(role_named(names[i]), fixed ? std::nullopt : std::optional(stage.roles[i]))
        << names[i];
  }
  EXPECT_EQ(role_named("ballast"), std::nullopt);
}

TEST(RoomFixtures, NothingGetsOutOfTheRoom) {
  // Balls thrown every which way from over the deck, with nothing lost at any surface.
  Scenario scenario;
  scenario.lane.kick_backs = true;
  scenario.lane.masking_panel = true;
  set_elasticity(scenario.material, 1.0);
  set_friction(scenario.material, 0.0);
  engine::World world = engine::make_world(world_parameters(scenario));
  for (const Fixture& fixture : room_fixtures(scenario)) {
    engine::add_body(world, fixture.body, {fixture.X_WB, Vec3::Zero(), Vec3::Zero()});
  }
  const engine::BodyId ball = engine::add_body(world, ball_body(scenario),
                                               {.X_WB = {Quat::Identity(), Vec3(0.0, 6.5, 0.4)}});
  int met_kick_back = 0, met_ceiling = 0;
  for (int i = 0; i < 60; ++i) {
    const SinCos turn = sin_cos(0.1047 * i);
    engine::set_state(world, ball,
                      {{Quat::Identity(), Vec3(0.0, 6.5, 0.4)},
                       Vec3(9.0 * turn.cos, 9.0 * turn.sin, i % 2 == 0 ? 1.0 : 8.0),
                       Vec3::Zero()});
    for (int k = 0; k < 240; ++k) {
      engine::step(world);
      const Vec3& p = world.states[ball].X_WB.p;
      ASSERT_LT(std::abs(p.x()), 0.5 * scenario.room.width);
      ASSERT_LT(p.y(), scenario.room.ahead);
      ASSERT_GT(p.z(), 0.5 * scenario.ball.radius);
      ASSERT_LT(p.z(), scenario.room.height);
      for (const engine::ContactEvent& e : world.events) {
        met_kick_back += world.bodies[e.b].name.ends_with("kick-back");
        met_ceiling += world.bodies[e.b].name == "ceiling";
      }
    }
  }
  EXPECT_GT(met_kick_back, 20);
  EXPECT_GT(met_ceiling, 10);
}

std::set<std::string> names_of(const std::vector<Fixture>& fixtures) {
  std::set<std::string> names;
  for (const Fixture& fixture : fixtures) names.insert(fixture.body.name);
  return names;
}

// The paper tells of a room and a game of bowling: of no panel, kick-backs or gutters.
TEST(RoomFixtures, OfThePapersRoomAreFloorWallsAndCeiling) {
  EXPECT_EQ(names_of(room_fixtures(Scenario{})),
            (std::set<std::string>{"lane", "left wall", "right wall", "wall behind", "wall ahead",
                                   "ceiling"}));
}

// Whatever the defaults are, a trial of before these keys has the room it was made in.
TEST(RoomFixtures, OfATrialFromBeforeTheirKeysAreThoseOfThen) {
  const Trial trial = read_trial(HEADPIN_SOURCE_DIR "/tests/scene/trials/rules-1.lcmlog");
  const Scenario scenario = scenario_of_trial(trial.header.scenario, "rules-1.lcmlog");
  EXPECT_EQ(names_of(room_fixtures(scenario)),
            (std::set<std::string>{"lane", "left wall", "right wall", "wall behind", "wall ahead",
                                   "left kick-back", "right kick-back", "masking panel"}));
  EXPECT_EQ(scenario.lane.gutter_width, 0.235);
}

// Two crossed boards. Rules 1 to 13 keep the moments of their time, which were 0.1 percent off.
TEST(SkittleBody, OfThinBoardsHasTheMomentsOfItsRules) {
  const double length = 0.11, width = 0.0049, height = 0.38, w2 = width * width;
  Scenario scenario = of_one_mesh(box_corners({length, width, height}));
  scenario.skittle.parts.push_back(scenario.skittle.parts[0]);
  scenario.skittle.parts[1].corners = box_corners({width, length, height});
  scenario.skittle.mass = 1.588;
  scenario.collision.rules = 14;
  const double area = 2.0 * length * width - w2;
  const double moment = scenario.skittle.mass / area *
                        (2.0 * length * width * (length * length + w2) - w2 * 2.0 * w2) / 12.0;
  EXPECT_NEAR(skittle_body(scenario).body.inertia(2, 2), moment, 1e-9 * moment);
  scenario.collision.rules = 13;
  EXPECT_NEAR(skittle_body(scenario).body.inertia(2, 2), 0.0016396352307531835, 1e-12);
}

}  // namespace
}  // namespace headpin::scene
