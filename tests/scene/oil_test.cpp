// Oil on the lane: what a pattern may be, where it is, and what a ball does on it.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene/looks/room_mesh.h"
#include "scene/scenario/scenario.h"
#include "scene/stage/read_scenario.h"
#include "scene/stage/stage.h"
#include "tests/scene/refusal.h"

namespace headpin::scene {
namespace {

using testing::HasSubstr;

std::string zone(int first, int last, double from, double to, double friction = 0.04) {
  return fmt::format("{{first_board = {}, last_board = {}, from = {}, to = {}, friction = {}}},\n",
                     first, last, from, to, friction);
}

std::string refused(const std::string& zones) {
  return refusal("[lane.oil]\nzones = [\n" + zones + "]\n");
}

TEST(OilPattern, HasNoOverlap) {
  EXPECT_EQ(refused(zone(1, 20, 0, 3) + zone(20, 39, 2, 4)),
            "lane.toml:4: lane.oil.zones must not overlap, found zones 1 and 2 on board 20 at 2 m");
  EXPECT_EQ(refused(zone(1, 20, 0, 3) + zone(21, 39, 2, 4)), "");
  EXPECT_EQ(refused(zone(1, 20, 0, 3) + zone(1, 20, 3, 4)), "");
}

TEST(OilPattern, HasNoHole) {
  EXPECT_EQ(
      refused(zone(5, 30, 0, 2) + zone(5, 30, 2.5, 4)),
      "lane.toml:4: lane.oil.zones must leave no hole, found one before zone 2: board 5 at 2 m");
  EXPECT_EQ(
      refused(zone(20, 30, 0, 2) + zone(5, 15, 0, 2)),
      "lane.toml:3: lane.oil.zones must leave no hole, found one before zone 1: board 16 at 0 m");
  EXPECT_EQ(
      refused(zone(5, 30, 0, 2) + zone(10, 20, 2, 4) + zone(5, 30, 4, 5)),
      "lane.toml:5: lane.oil.zones must leave no hole, found one before zone 3: board 5 at 2 m");
  EXPECT_EQ(refused(zone(5, 30, 1, 2) + zone(8, 20, 2, 4)), "") << "dry beside, before and beyond";
}

TEST(OilPattern, LiesOnTheLaneBeforeTheSkittles) {
  EXPECT_EQ(refused(zone(1, 40, 0, 2)),
            "lane.toml:3: lane.oil.zones, zone 1: last_board must be a whole number from 1 to 39, "
            "found 40");
  EXPECT_THAT(refused(zone(0, 39, 0, 2)), HasSubstr("first_board must be a whole number from 1"));
  EXPECT_EQ(
      refused(zone(20, 10, 0, 2)),
      "lane.toml:3: lane.oil.zones must have first_board at or before last_board, found 20 and "
      "10 in zone 1");
  EXPECT_EQ(refused(zone(1, 39, 2, 2)),
            "lane.toml:3: lane.oil.zones must have from below to, found 2 and 2 in zone 1");
  EXPECT_THAT(refused(zone(1, 39, -1, 2)), HasSubstr("from must be a number from 0 to 50"));
  EXPECT_EQ(
      refused(zone(1, 39, 0, 2) + zone(1, 39, 2, 5.95)),
      "lane.toml:4: lane.oil.zones must end before the skittles, at 5.9 m; found 5.95 in zone "
      "2");
  EXPECT_THAT(refused(zone(1, 39, 0, 2, 1.5)), HasSubstr("friction must be a number from 0 to 1"));
  EXPECT_THAT(refusal("[lane.oil]\nzones = [3]"),
              HasSubstr("a table {first_board, last_board, from, to, friction}"));
  EXPECT_THAT(refusal("[lane.oil]\nzones = [{board = 3}]"), HasSubstr("unknown key 'board'"));
}

Scenario oiled() {
  Scenario scenario;
  scenario.lane.oil.zones = {{1, 10, 1.0, 3.0, 0.05}, {11, 39, 0.0, 4.0, 0.1}};
  return scenario;
}

TEST(OilPattern, IsWrittenAndReadAgain) {
  const Scenario scenario = oiled();
  const Scenario again = parse_scenario(to_toml(scenario), "again.toml");
  EXPECT_EQ(to_toml(again), to_toml(scenario));
  ASSERT_EQ(again.lane.oil.zones.size(), 2u);
  EXPECT_EQ(again.lane.oil.zones[1].last_board, 39);
  EXPECT_EQ(again.lane.oil.zones[0].friction, 0.05);
}

// Board 1 is at the right gutter; of a mirrored pattern, at the left one.
TEST(OilPattern, IsOnItsBoardsAndThenTheLaneIsDryAsFarAsTheSkittles) {
  Scenario scenario = oiled();
  const double half = 0.5 * scenario.lane.width, board = scenario.lane.width / 39;
  const auto areas = [&] { return make_stage(scenario).world.bodies.front().areas; };
  std::vector<engine::FrictionArea> lane = areas();
  ASSERT_EQ(lane.size(), 3u);
  EXPECT_NEAR(lane[0].low.x(), half - 10 * board, 1e-12);
  EXPECT_NEAR(lane[0].high.x(), half, 1e-12);
  EXPECT_EQ(lane[0].low.y(), 1.0);
  EXPECT_EQ(lane[0].high.y(), 3.0);
  EXPECT_EQ(lane[0].friction, 0.05);
  EXPECT_NEAR(lane[2].low.x(), -half, 1e-12);
  EXPECT_NEAR(lane[2].high.y(), scenario.lane.head_pin - 0.1, 1e-12);
  EXPECT_EQ(lane[2].friction, 0.2);
  scenario.lane.oil.mirrored = true;
  lane = areas();
  EXPECT_NEAR(lane[0].low.x(), -half, 1e-12);
  EXPECT_NEAR(lane[0].high.x(), -half + 10 * board, 1e-12);
  scenario.lane.oil.zones.clear();
  EXPECT_TRUE(areas().empty());
}

/// A ball that slides down the lane without spin, far from every edge.
double speed_after(const Scenario& scenario, double from, double seconds) {
  Stage stage = make_stage(scenario);
  const engine::BodyId ball = stage.balls.front();
  engine::State state;
  state.X_WB.p = Vec3(0.0, from, scenario.ball.radius);
  state.v_WB = Vec3(0.0, 8.0, 0.0);
  engine::set_kind(stage.world, ball, engine::Kind::free);
  engine::set_state(stage.world, ball, state);
  while (static_cast<double>(stage.world.tick) < seconds * stage.world.parameters.rate_hz) {
    engine::step(stage.world);
  }
  return stage.world.states[ball].v_WB.y();
}

TEST(OilPattern, SlowsABallAsTheFrictionOfItsZones) {
  for (const char* name : {"house-oil", "sport-oil"}) {
    const Scenario scenario =
        load_scenario(fmt::format("{}/assets/scenarios/{}.toml", HEADPIN_SOURCE_DIR, name));
    const double g = scenario.collision.gravity;
    EXPECT_NEAR(speed_after(scenario, 1.0, 0.25), 8.0 - 0.04 * g * 0.25, 1e-6) << name;
    EXPECT_NEAR(speed_after(scenario, 10.99, 0.125), 8.0 - 0.12 * g * 0.125, 0.02) << name;
    EXPECT_NEAR(speed_after(scenario, 13.0, 0.25), 8.0 - 0.2 * g * 0.25, 1e-6) << name;
  }
}

// Eyes and page see it: parts of the lane that are darker and reflect more.
TEST(OilPattern, IsSeenWhereItIs) {
  const RoomMeshes none = room_meshes(room_measures(Scenario()));
  Scenario as_dry = oiled();
  for (OilZone& zone : as_dry.lane.oil.zones) zone.friction = as_dry.lane.oil.dry;
  const RoomMeshes dry = room_meshes(room_measures(as_dry));
  const RoomMeshes wet = room_meshes(room_measures(oiled()));
  EXPECT_TRUE(none.oil.indices.empty());
  ASSERT_FALSE(wet.oil.indices.empty());
  EXPECT_GT(wet.oil.gloss, wet.lane.gloss);
  for (const render::Vertex& v : wet.oil.vertices) {
    EXPECT_LE(v.p.y(), 4.001f);
    if (v.p.x() <= 0.27f) continue;
    EXPECT_GT(v.p.y(), 0.999f);
    EXPECT_LT(v.p.y(), 3.001f);
  }
  // The same places, with oil as slippery as dry wood: not darker.
  ASSERT_EQ(dry.oil.vertices.size(), wet.oil.vertices.size());
  for (std::size_t i = 0; i < wet.oil.vertices.size(); ++i) {
    EXPECT_LT(wet.oil.vertices[i].colour.sum(), 0.95f * dry.oil.vertices[i].colour.sum());
  }
}

}  // namespace
}  // namespace headpin::scene
