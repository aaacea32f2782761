// Where the thumbs lead, step by step.

#include "scene/play/walk.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "scene/stage/room.h"

namespace headpin::scene {
namespace {

constexpr double kTick = 1.0 / 240.0;

/// A head that looks some way.
Pose head(const Vec3& p_PD, const Vec3& ahead) {
  return {Quat::FromTwoVectors(-Vec3::UnitZ(), ahead), p_PD};
}

Vec3 level_way(int sixteenth) {
  const double angle = sixteenth * std::numbers::pi / 8.0;
  return {std::cos(angle), std::sin(angle), 0.0};
}

/// A room with everything that stands in it.
Scenario furnished() {
  Scenario scenario;
  scenario.lane.kick_backs = true;
  scenario.lane.masking_panel = true;
  return scenario;
}

/// Whether a head may be there.
bool is_clear(const Vec3& p_WD, const Scenario& scenario) {
  const Room& room = scenario.room;
  const double clear = scenario.walk.clearance;
  if (std::abs(p_WD.x()) > 0.5 * room.width - clear) return false;
  if (p_WD.y() < clear - room.behind || p_WD.y() > room.ahead - clear) return false;
  for (const Block& block : front_blocks(room_measures(scenario))) {
    const bool beside = p_WD.x() <= block.low_W.x() - clear ||
                        p_WD.x() >= block.high_W.x() + clear ||
                        p_WD.y() <= block.low_W.y() - clear || p_WD.y() >= block.high_W.y() + clear;
    if (!beside) return false;
  }
  return true;
}

TEST(WalkTest, GetsFasterAsItsAccelerationSaysAndSlowsDownLikewise) {
  const Scenario scenario;
  const Pose X_PD = head({0.0, -1.0, 1.7}, Vec3(1.0, 0.0, -0.5));  // down, to the right
  Walk walk;
  const double gained = scenario.walk.acceleration * kTick;
  for (int i = 1; i <= 120; ++i) {
    const Vec3 before = walk.p_WP;
    step(walk, scenario, X_PD, X_PD, 1, kTick);
    const double v = std::min(scenario.walk.speed, i * gained);
    EXPECT_LT((walk.v_WP - Vec3(v, 0.0, 0.0)).norm(), 1e-12) << i;
    EXPECT_LT((walk.p_WP - before - kTick * walk.v_WP).norm(), 1e-12) << i;
  }
  const double reached = walk.v_WP.norm();
  step(walk, scenario, X_PD, X_PD, -1, kTick);
  EXPECT_NEAR(walk.v_WP.x(), reached - gained, 1e-12);
  while (walk.v_WP.norm() > 0.0) step(walk, scenario, X_PD, X_PD, 0, kTick);
  const Vec3 there = walk.p_WP;
  step(walk, scenario, X_PD, X_PD, 0, kTick);
  EXPECT_EQ(walk.p_WP, there);
}

TEST(WalkTest, StraightUpOrDownIsNoDirection) {
  const Scenario scenario;
  for (const double z : {1.0, -1.0}) {
    Walk walk;
    const Pose X_PD = head({0.0, -1.0, 1.7}, Vec3(0.0, 0.0, z));
    for (int i = 0; i < 100; ++i) step(walk, scenario, X_PD, X_PD, 1, kTick);
    EXPECT_EQ(walk.p_WP, Vec3::Zero());
  }
}

// On either axis it goes as far as one more tick would be too far.
TEST(WalkTest, EndsAtWhateverStandsInItsWayAndNotBefore) {
  const Scenario scenario = furnished();
  for (const Vec3& from : {Vec3(0.0, -1.0, 1.7), Vec3(1.2, 3.0, 1.7), Vec3(0.0, 5.3, 1.7)}) {
    ASSERT_TRUE(is_clear(from, scenario)) << from.transpose();
    for (int i = 0; i < 16; ++i) {
      const Vec3 way = level_way(i);
      const Pose X_PD = head(from, way);
      Walk walk;
      for (int tick = 0; tick < 240 * 20; ++tick) step(walk, scenario, X_PD, X_PD, 1, kTick);
      const Vec3 there = from + walk.p_WP;
      EXPECT_TRUE(is_clear(there - 1e-9 * way, scenario)) << there.transpose();
      for (const int axis : {0, 1}) {
        if (std::abs(way[axis]) < 1e-9) continue;
        Vec3 next = there;
        next[axis] += std::copysign(kTick * scenario.walk.speed, way[axis]);
        EXPECT_FALSE(is_clear(next, scenario)) << i << " " << axis << ": " << there.transpose();
      }
    }
  }
}

// One's own steps are not limited: who is too near already may walk away, and no nearer.
TEST(WalkTest, WhoIsTooNearAlreadyWalksAwayAndNoNearer) {
  const Scenario scenario = furnished();
  const Room& room = scenario.room;
  const double deep = 0.5 * scenario.walk.clearance;
  const Block block = front_blocks(room_measures(scenario)).front();
  const Vec3 middle = 0.5 * (block.low_W + block.high_W);
  struct Near {
    Vec3 p, away;
  };
  for (const Near& one : {Near{{0.5 * room.width - deep, -1.0, 1.7}, {-1.0, 0.0, 0.0}},
                          Near{{deep - 0.5 * room.width, -1.0, 1.7}, {1.0, 0.0, 0.0}},
                          Near{{0.0, deep - room.behind, 1.7}, {0.0, 1.0, 0.0}},
                          Near{{middle.x(), block.low_W.y() - deep, 1.7}, {0.0, -1.0, 0.0}}}) {
    ASSERT_FALSE(is_clear(one.p, scenario)) << one.p.transpose();
    for (const bool away : {true, false}) {
      Walk walk;
      const Pose X_PD = head(one.p, away ? one.away : Vec3(-one.away));
      for (int tick = 0; tick < 240; ++tick) step(walk, scenario, X_PD, X_PD, 1, kTick);
      EXPECT_EQ(walk.p_WP.dot(one.away) > 0.3, away) << one.p.transpose();
      if (!away) {
        EXPECT_LT(walk.p_WP.norm(), 1e-9) << one.p.transpose();
      }
    }
  }
}

TEST(WalkTest, EndsBeforeTheMaskingPanelAndBehindIt) {
  const Scenario scenario = furnished();
  const Block panel = front_blocks(room_measures(scenario)).back();
  const double clear = scenario.walk.clearance, tick_way = kTick * scenario.walk.speed;
  for (const double way : {1.0, -1.0}) {
    const double edge = way > 0.0 ? panel.low_W.y() - clear : panel.high_W.y() + clear;
    const Vec3 from(0.0, edge - way * 0.8, 1.7);
    ASSERT_TRUE(is_clear(from, scenario));
    const Pose X_PD = head(from, Vec3(0.0, way, 0.0));
    Walk walk;
    for (int tick = 0; tick < 480; ++tick) step(walk, scenario, X_PD, X_PD, 1, kTick);
    const double left = way * (edge - (from + walk.p_WP).y());
    EXPECT_GE(left, -1e-9) << way;
    EXPECT_LE(left, tick_way) << way;
  }
}

}  // namespace
}  // namespace headpin::scene
