#include "scene/stage/bodies.h"

#include <cmath>
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

}  // namespace
}  // namespace headpin::scene
