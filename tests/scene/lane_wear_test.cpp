// Wear of the oil on a lane: held against powers of what a pass leaves, sums, and mirror images.

#include "scene/play/lane_wear.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/base/sources.h"
#include "scene/play/game.h"
#include "scene/record/events.h"
#include "scene/watch/alone.h"
#include "tests/scene/refusal.h"
#include "tests/support/hand_script.h"

namespace headpin::scene {
namespace {

using testing::HasSubstr;

constexpr double kOil = 0.04, kDry = 0.2, kEnd = 12.192;  // of sport-oil, in the middle boards

Scenario sport_oil(double wear, double carry_down = 0.0) {
  Scenario scenario = load_scenario(HEADPIN_SOURCE_DIR "/assets/scenarios/sport-oil.toml");
  scenario.lane.oil.wear = wear;
  scenario.lane.oil.carry_down = carry_down;
  return scenario;
}

/// A lane on which balls are thrown one after another, each at a full rack.
class Alley {
 public:
  explicit Alley(const Scenario& scenario) : stage_(make_stage(scenario)), world_(stage_.world) {}

  /// The way of a ball until it has left the lane.
  BallPath roll(const engine::State& start) {
    hashes.clear();
    engine::World world = stage_.world;
    take_over_wear(world, stage_, world_, stage_);
    const engine::BodyId ball = stage_.balls.front();
    engine::set_kind(world, ball, engine::Kind::free);
    engine::set_state(world, ball, start);
    Game game = make_game(stage_);
    std::vector<Event> events;
    Tick tick{stage_, world, {}, events};
    events.push_back(event(tick, kind::release, {ball}));
    while (world.tick < 10 * world.parameters.rate_hz) {
      note_velocities(game, world);
      engine::step(world);
      note_step(game, tick);
      hashes.push_back(engine::state_hash(world));
      if (!game.watched) break;
      events.clear();
    }
    world_ = world;
    return events.empty() ? BallPath{} : events.back().detail.value_or(BallPath{});
  }

  /// The friction that a ball feels that slides along the middle of a board for a twentieth of a
  /// second.
  double felt(double board, double from) const {
    engine::World world = stage_.world;
    take_over_wear(world, stage_, world_, stage_);
    const engine::BodyId ball = stage_.balls.front();
    engine::set_kind(world, ball, engine::Kind::free);
    engine::set_state(world, ball,
                      {{Quat::Identity(), at(board, from)}, Vec3(0, 5, 0), Vec3::Zero()});
    for (int k = 0; k < 12; ++k) engine::step(world);
    return (5.0 - world.states[ball].v_WB.y()) / (0.05 * stage_.scenario.collision.gravity);
  }

  /// A ball that rolls straight along the middle of a board.
  engine::State straight(double board) const {
    const double r = stage_.scenario.ball.radius;
    return {{Quat::Identity(), at(board, 0.1)}, Vec3(0, 8, 0), Vec3(-8.0 / r, 0, 0)};
  }

  Vec3 at(double board, double distance) const {
    return {(20.0 - board) * stage_.room.lane_width / 39.0, distance, stage_.scenario.ball.radius};
  }

  const engine::FrictionTable& lane() const { return lane_of(world_, stage_); }
  const engine::FrictionTable& fresh() const { return *stage_.fresh_lane; }
  bool is_worn() const { return world_.bodies[stage_.lane].table != nullptr; }

  std::vector<std::uint64_t> hashes;  ///< of the last throw

 private:
  Stage stage_;
  engine::World world_;  ///< after the last throw
};

/// 7.6 m/s to the right, 290 rpm: it hooks to the left.
engine::State hooking(const Alley& alley, double side = 1.0) {
  return {{Quat::Identity(), Vec3(side * 0.05, 0.1, alley.at(20, 0).z())},
          Vec3(side * 0.3, 7.6, 0.0),
          Vec3(-26.0, -side * 16.0, 0.0)};
}

// A pass leaves the share 1 - wear of what the oil takes off the friction of dry wood. A ball that
// slides there feels it.
TEST(LaneWear, AfterSeveralPassesIsAPowerOfThatOfOne) {
  const double wear = 0.1;
  Alley alley(sport_oil(wear));
  for (int pass = 1; pass <= 5; ++pass) {
    alley.roll(alley.straight(20));
    const double left = std::pow(1.0 - wear, pass);
    EXPECT_NEAR(alley.felt(20, 3.0), kDry + (kOil - kDry) * left, 1e-6) << pass;
    EXPECT_NEAR(alley.felt(20, 11.2), kDry + (0.12 - kDry) * left, 1e-6) << pass;
  }
}

TEST(LaneWear, IsNoneThreeBoardsAside) {
  Alley alley(sport_oil(0.3, 0.1)), unused(sport_oil(0.3, 0.1));
  for (int pass = 0; pass < 3; ++pass) alley.roll(alley.straight(20));
  EXPECT_GT(alley.felt(20, 3.0), kOil + 0.05);
  for (const double board : {17.0, 23.0}) EXPECT_NEAR(alley.felt(board, 3.0), kOil, 1e-6) << board;
  alley.roll(alley.straight(17));
  unused.roll(unused.straight(17));
  EXPECT_EQ(alley.hashes, unused.hashes);
}

// Oil is gone from every board that the way crosses, and there alone.
TEST(LaneWear, FollowsTheWayOfTheBall) {
  Alley alley(sport_oil(0.5));
  const double radius = alley.at(20, 0).z(), width = alley.lane().width;
  engine::State start = alley.straight(20);
  start.v_WB.x() = 0.4;  // rolls along its way: 40 mm to the right in 0.8 m
  start.w_WB = Vec3(-8.0, 0.4, 0.0) / radius;
  alley.roll(start);
  for (std::size_t row = 0; row + 1 < alley.lane().edges.size(); ++row) {
    const double begin = alley.lane().edges[row], end = alley.lane().edges[row + 1];
    if (begin < 0.1 || end > 10.0) continue;
    for (std::size_t column = 0; column < 39; ++column) {
      const double left = -0.5 * 39 * width + static_cast<double>(column) * width;
      const double from = 0.05 * (begin - 0.1), to = 0.05 * (end - 0.1);
      const double inside = std::min(left + width, to) - std::max(left, from);
      if (std::abs(inside) < 0.004) continue;  // as wide as the contact
      const std::size_t cell = row * 39 + column;
      EXPECT_EQ(alley.lane().friction[cell] != alley.fresh().friction[cell], inside > 0.0)
          << begin << " column " << column;
    }
  }
}

TEST(LaneWear, LetsTheSameReleaseHookEarlier) {
  Alley alley(sport_oil(0.1));
  const BallPath first = alley.roll(hooking(alley));
  for (int pass = 0; pass < 8; ++pass) alley.roll(hooking(alley));
  const BallPath last = alley.roll(hooking(alley));
  ASSERT_TRUE(first.hook_end && last.hook_end && first.skid_end && last.skid_end);
  ASSERT_TRUE(first.entry && last.entry);
  EXPECT_LT(*last.skid_end, *first.skid_end - 0.3);
  EXPECT_LT(*last.hook_end, *first.hook_end - 0.3);
  EXPECT_GT(last.entry->board, first.entry->board + 1.0) << "farther to the left";
}

// What a throw does to the lane, it does not feel itself.
TEST(LaneWear, BeginsWithTheSecondThrow) {
  Alley worn(sport_oil(1.0)), even(sport_oil(0.0));
  worn.roll(hooking(worn));
  even.roll(hooking(even));
  EXPECT_EQ(worn.hashes, even.hashes);
  EXPECT_TRUE(worn.is_worn());
  EXPECT_FALSE(even.is_worn());
  worn.roll(hooking(worn));
  even.roll(hooking(even));
  EXPECT_NE(worn.hashes, even.hashes);
}

/// The sum of friction times length over a board, of what `lane` has less than `other` beyond the
/// end of the oil, or before it [m].
double sum_of_less(const engine::FrictionTable& lane, const engine::FrictionTable& other,
                   bool beyond) {
  double sum = 0.0;
  for (std::size_t cell = 0; cell < lane.friction.size(); ++cell) {
    const std::size_t row = cell / lane.columns;
    if ((lane.edges[row] >= kEnd) != beyond) continue;
    sum += (other.friction[cell] - lane.friction[cell]) * (lane.edges[row + 1] - lane.edges[row]);
  }
  return sum;
}

// The part that is carried down lies beyond the end of the oil: nearly all of it, as the lane goes on
// for 6 m. It makes the dry boards more slippery, most at the end of the oil.
TEST(LaneWear, LaysAPartOfTheOilDownBeyondItsEnd) {
  Alley alley(sport_oil(0.2, 0.25));
  alley.roll(alley.straight(20));
  const double taken = sum_of_less(alley.fresh(), alley.lane(), false);
  const double laid = sum_of_less(alley.lane(), alley.fresh(), true);
  EXPECT_GT(taken, 0.3);
  EXPECT_LE(laid, 0.25 * taken);
  EXPECT_GT(laid, 0.95 * 0.25 * taken);
  EXPECT_LT(alley.felt(20, 12.3), alley.felt(20, 14.0) - 0.002);
  EXPECT_LT(alley.felt(20, 14.0), kDry - 0.001);
  EXPECT_NEAR(alley.felt(17, 12.3), kDry, 1e-6);
  for (int pass = 0; pass < 60; ++pass) alley.roll(alley.straight(20));
  for (const double friction : alley.lane().friction) {
    EXPECT_GE(friction, kOil);
    EXPECT_LE(friction, kDry);
  }
}

TEST(LaneWear, WithoutCarryDownLeavesDryBoardsDry) {
  Alley alley(sport_oil(0.2, 0.0));
  for (int pass = 0; pass < 3; ++pass) alley.roll(alley.straight(20));
  EXPECT_EQ(sum_of_less(alley.lane(), alley.fresh(), true), 0.0);
}

TEST(LaneWear, OfALeftHanderIsTheMirrorImage) {
  Scenario scenario = sport_oil(0.3, 0.2);
  scenario.lane.oil.zones = {{2, 15, 0.0, 9.0, 0.04}, {16, 37, 0.0, 11.0, 0.08}};
  Alley right(scenario);
  scenario.lane.oil.mirrored = true;
  Alley left(scenario);
  for (int pass = 0; pass < 3; ++pass) {
    right.roll(hooking(right));
    left.roll(hooking(left, -1.0));
  }
  const engine::FrictionTable &a = right.lane(), &b = left.lane();
  ASSERT_EQ(a.friction.size(), b.friction.size());
  int worn = 0;
  for (std::size_t cell = 0; cell < a.friction.size(); ++cell) {
    const std::size_t row = cell / 39, column = cell % 39;
    EXPECT_NEAR(a.friction[cell], b.friction[row * 39 + 38 - column], 1e-9) << row << " " << column;
    worn += a.friction[cell] != right.fresh().friction[cell];
  }
  EXPECT_GT(worn, 50);
}

TEST(LaneWear, StaysWhenTheConditionChangesAndThePatternDoesNot) {
  Alley alley(sport_oil(0.3));
  alley.roll(alley.straight(20));
  const auto other_lane = [&](const Scenario& scenario) {
    Session session = make_session(sport_oil(0.3));
    engine::set_friction(session.world, session.stage->lane,
                         std::make_shared<const engine::FrictionTable>(alley.lane()));
    const auto stage = std::make_shared<const Stage>(make_stage(scenario));
    const Session moved = on_its_own(session, stage);
    return moved.world.bodies[moved.stage->lane].table;
  };
  Scenario scenario = sport_oil(0.3);
  scenario.material.skittle.friction = 0.1;
  ASSERT_TRUE(other_lane(scenario));
  EXPECT_EQ(*other_lane(scenario), alley.lane());
  scenario.lane.oil.zones.pop_back();
  EXPECT_FALSE(other_lane(scenario)) << "another pattern is fresh";
  EXPECT_FALSE(other_lane(sport_oil(0.0))) << "a lane that does not wear is fresh";
}

TEST(LaneWear, StaysWhenAVersionOfTheGameBegins) {
  Scenario scenario = load_scenario(HEADPIN_SOURCE_DIR "/assets/scenarios/paper-experiment.toml");
  scenario.lane.oil.zones = {{1, 39, 0.0, 5.0, 0.04}};
  scenario.lane.oil.wear = 0.5;
  Session session = make_session(scenario);
  engine::FrictionTable worn = *session.stage->fresh_lane;
  worn.friction[100] = 0.11;
  engine::set_friction(session.world, session.stage->lane,
                       std::make_shared<const engine::FrictionTable>(worn));
  HandScript hand(scenario);
  hand.touch(scenario.version.blue.button);
  devices::ReplaySource source(hand.samples);
  while (session.version == 0 && session.now() < Time{2'000'000}) advance(session, source);
  ASSERT_EQ(session.version, 2u);
  EXPECT_EQ(lane_of(session.world, *session.stage), worn);
}

TEST(LaneWear, IsRefusedOutsideOfItsRangeAndWithoutOil) {
  const std::string zones =
      "zones = [{first_board = 1, last_board = 39, from = 0.0, to = 4.0, friction = 0.04}]\n";
  EXPECT_EQ(refusal("[lane.oil]\n" + zones + "wear = 0.02\ncarry_down = 0.2"), "");
  EXPECT_THAT(refusal("[lane.oil]\n" + zones + "wear = 1.5"),
              HasSubstr("lane.toml:3: lane.oil.wear must be a number from 0 to 1"));
  EXPECT_THAT(refusal("[lane.oil]\n" + zones + "carry_down = -0.1"),
              HasSubstr("lane.toml:3: lane.oil.carry_down must be a number from 0 to 1"));
  EXPECT_EQ(refusal("[lane.oil]\n\nwear = 0.02"),
            "lane.toml:3: lane.oil.wear must be 0 on a lane without zones of oil, found 0.02");
}

/// Four boards of a metre, in rows of 1, 2, 3 and 4 m.
engine::FrictionTable wide_boards() {
  return {.low_x = -2.0,
          .width = 1.0,
          .columns = 4,
          .edges = {0.0, 1.0, 3.0, 6.0, 10.0},
          .friction = std::vector<double>(16, kOil)};
}

TouchedCells touched_on(const Vec2& from, const Vec2& to) {
  TouchedCells cells;
  add_way(cells, wide_boards(), from, to);
  return cells;
}

// Half a metre to the right for each metre ahead.
TEST(LaneWear, IsOnTheBoardsThatAWayCrossesRowByRow) {
  const TouchedCells crossed{0, 4, 5, 9, 10, 11, 15};
  EXPECT_EQ(touched_on({-1.5, 0.5}, {1.5, 6.5}), crossed);
  EXPECT_EQ(touched_on({1.5, 6.5}, {-1.5, 0.5}), crossed) << "a ball that comes back";
  EXPECT_EQ(touched_on({-1.5, 2.0}, {0.5, 2.0}), (TouchedCells{4, 5, 6})) << "straight across";
  EXPECT_EQ(touched_on({0.5, 0.5}, {0.5, 1.0}), (TouchedCells{2, 6})) << "a row has its first edge";
  EXPECT_EQ(touched_on({0.5, -1.0}, {0.5, 0.5}), TouchedCells{2}) << "from before the lane";
  EXPECT_EQ(touched_on({0.5, 9.0}, {0.5, 12.0}), TouchedCells{14}) << "to beyond its end";
}

// The contact is some millimetres wide: it may be on two boards, or half beside the lane.
TEST(LaneWear, IsAsWideAsTheContact) {
  for (const double side : {-1.0, 1.0}) {
    EXPECT_EQ(touched_on({side * 0.002, 4.0}, {side * 0.002, 5.0}), (TouchedCells{9, 10}));
    EXPECT_EQ(touched_on({side * 0.004, 4.0}, {side * 0.004, 5.0}).size(), 1u);
  }
  EXPECT_EQ(touched_on({-2.001, 4.0}, {-2.001, 5.0}), TouchedCells{8});
  EXPECT_EQ(touched_on({2.001, 4.0}, {2.001, 5.0}), TouchedCells{11});
  EXPECT_EQ(touched_on({-2.1, 4.0}, {-2.1, 5.0}), TouchedCells{});
  EXPECT_EQ(touched_on({2.1, 4.0}, {2.1, 5.0}), TouchedCells{});
}

// Half of the oil goes. Of the friction that it took away, times length, the mean of two boards is
// (0.08 + 0.06) * 2 / 2 = 0.14 m in the first row and 0.04 * 0.5 / 2 = 0.01 m in the second one. A
// quarter is carried down: 0.0375 m, of which the dry board of the second row, of 0.5 m, gets
// 0.5 / 1.524, and the third row, longer than 5 ft, the rest.
TEST(LaneWear, OfAPassIsThatOfAHandCalculation) {
  const engine::FrictionTable fresh{.low_x = 0.0,
                                    .width = 1.0,
                                    .columns = 2,
                                    .edges = {0.0, 2.0, 2.5, 6.5},
                                    .friction = {0.04, 0.08, 0.12, 0.2, 0.2, 0.2}};
  const Oil oil{.zones = {}, .dry = 0.2, .wear = 0.5, .carry_down = 0.25};
  const engine::FrictionTable after = worn(fresh, fresh, {0, 1, 2, 3, 4}, oil);
  const double second = 0.0375 / 1.524;
  const double rest = 0.0375 - 0.5 * second / 2.0;  // it is on one of two boards
  const std::vector expected{0.12, 0.14, 0.16, 0.2 - second, 0.2 - rest / 4.0, 0.2};
  EXPECT_THAT(after.friction, testing::Pointwise(testing::DoubleNear(1e-12), expected));
}

TEST(LaneWear, IsNoneOfABallThatTouchedNothingOrOnALaneWithoutWear) {
  const Stage wears = make_stage(sport_oil(0.5)), wears_not = make_stage(sport_oil(0.0));
  engine::World world = wears.world, other = wears_not.world;
  wear_lane(world, wears, {});
  EXPECT_FALSE(world.bodies[wears.lane].table);
  wear_lane(other, wears_not, {0});
  EXPECT_FALSE(other.bodies[wears_not.lane].table);
  wear_lane(world, wears, {0});
  EXPECT_TRUE(world.bodies[wears.lane].table);
}

}  // namespace
}  // namespace headpin::scene
