// What counts as coming, as one's own throw and as a way out, state by state.

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/base/sources.h"
#include "scene/play/presence.h"
#include "scene/play/session.h"
#include "scene/record/events.h"

namespace headpin::scene {
namespace {

const Vec3 kHeadThere(0.0, 0.0, 1.65);

/// A world without gravity, someone who stands in it, and what is watched tick by tick.
struct Lookout {
  Stage stage;
  engine::World world;
  Player player;
  Presence presence;
  std::vector<Event> events;

  Lookout() : stage(make_stage(weightless())), world(stage.world) {
    player.head.push(Time{0}, {Quat::Identity(), kHeadThere});
  }
  static Scenario weightless() {
    Scenario scenario;
    scenario.collision.gravity = 0.0;
    return scenario;
  }
  void put(engine::BodyId body, const Vec3& p_WB, const Vec3& v_WB) {
    engine::set_kind(world, body, engine::Kind::free);
    engine::set_state(world, body, {{Quat::Identity(), p_WB}, v_WB, Vec3::Zero()});
  }
  void look() { watch(presence, player, {stage, world, {Time{500'000}, 120}, events}); }
};

engine::State flying(const Vec3& p_WB, const Vec3& v_WB) {
  return {{Quat::Identity(), p_WB}, v_WB, Vec3::Zero()};
}

// Thrown along y. It is one's own while it is in reach, still in the hand, or on its way past the body.
TEST(PresenceWay, OnesOwnThrowIsOnesOwnUntilItTurnsBackOrIsFarAway) {
  struct Case {
    const char* what;
    Vec3 p_WB, v_WB;
    bool leaving, is_own;
  };
  const Vec3 ahead(0.0, 3.0, 0.0);
  for (const Case& one : {Case{"flies away", {0.0, 1.0, 1.0}, ahead, false, false},
                          Case{"leaves the hand", {0.0, 1.0, 1.0}, ahead, true, true},
                          Case{"is behind the body", {0.25, -1.0, 1.0}, ahead, false, true},
                          Case{"is near the body", {0.25, 0.1, 1.0}, ahead, false, true},
                          Case{"lies at the feet", {0.25, 0.1, 0.11}, Vec3::Zero(), false, true},
                          Case{"comes back", {0.25, 0.1, 1.0}, -ahead, false, false}}) {
    Lookout lookout;
    const engine::BodyId ball = lookout.stage.balls.front();
    lookout.put(ball, one.p_WB, one.v_WB);
    if (one.leaving) lookout.player.leaving = ball;
    lookout.presence.own.push_back({ball, ahead});
    lookout.look();
    EXPECT_EQ(is_own(lookout.presence, ball), one.is_own) << one.what;
  }
}

TEST(PresenceWay, WhatIsTakenAgainIsNoLongerAThrow) {
  Lookout lookout;
  const engine::BodyId ball = lookout.stage.balls.front();
  lookout.put(ball, {0.25, 0.1, 1.0}, {0.0, 3.0, 0.0});
  engine::set_kind(lookout.world, ball, engine::Kind::driven);
  lookout.presence.own.push_back({ball, Vec3::UnitY()});
  lookout.look();
  EXPECT_FALSE(is_own(lookout.presence, ball));
}

// Oracle: the belly of a skittle that stands upright is nearest to someone upright.
TEST(PresenceWay, TheDistanceOfASkittleIsThatOfItsSurface) {
  Lookout lookout;
  const engine::BodyId skittle = lookout.stage.skittles.front();
  lookout.put(skittle, kHeadThere + Vec3(0.3, 0.4, -0.5), {0.0, -4.0, 0.0});
  lookout.look();
  ASSERT_EQ(lookout.presence.approaches.size(), 1u);
  EXPECT_NEAR(lookout.presence.approaches[0].closest, 0.5 - lookout.stage.widest_skittle, 4e-4);
}

// A second before it is nearest: 5 m away along 3 : 4, and half a metre aside.
TEST(PresenceWay, ABallPassesAsFarAsItsWayLeads) {
  const Vec3 nearest(0.4, -0.3, 1.0), v_WB(3.0, 4.0, 0.0);
  const auto comes = passing(flying(nearest - v_WB, v_WB), 0.1, kHeadThere, std::nullopt, 0.0);
  ASSERT_TRUE(comes);
  EXPECT_NEAR(comes->time_s, 1.0, 1e-12);
  EXPECT_NEAR(comes->distance, 0.4, 1e-12);
  EXPECT_FALSE(comes->at_hand);
  // Where it is nearest, it comes no nearer.
  const engine::State beside = flying({0.3, 0.0, 1.0}, {0.0, 2.0, 0.0});
  EXPECT_FALSE(passing(beside, 0.1, kHeadThere, std::nullopt, 0.0));
}

TEST(PresenceWay, ABallComesAtTheHandIfItComesNearerToIt) {
  const engine::State comes = flying({0.0, 2.0, 1.0}, {0.0, -2.0, 0.0});
  const Vec3 aside(0.4, 0.0, 1.65);
  const auto at_hand = [&](const Vec3& p_WD, const Vec3& p_WH) {
    const auto found = passing(comes, 0.1, p_WD, p_WH, 0.0);
    return found && found->at_hand;
  };
  EXPECT_TRUE(at_hand(aside, {0.1, 0.5, 1.0}));
  EXPECT_FALSE(at_hand(aside, {0.1, 2.0, 1.0})) << "it is abeam already";
  EXPECT_FALSE(at_hand(aside, {0.1, 2.5, 1.0})) << "it is past it";
  EXPECT_FALSE(at_hand(kHeadThere, {0.0, 0.5, 1.0})) << "it hits both";
}

/// Someone with head and hand, of whom a tracker tells so many times a second where both are.
struct Mover {
  double rate_hz = 60.0;
  Vec3 v_hand = Vec3::Zero();
  Vec3 a = Vec3::Zero(), a_hand = Vec3::Zero();  ///< from 0.4 to 0.8 s [m/s^2]

  std::vector<devices::Sample> samples() const {
    std::vector<devices::Sample> all;
    for (int i = 0; i < 2 * static_cast<int>(rate_hz); ++i) {
      devices::TrackerSample sample;
      sample.device_time = microseconds(i / rate_hz);
      sample.sequence = i;
      const double now = seconds(sample.device_time), t = std::max(0.0, now - 0.4);
      const double gone = t < 0.4 ? 0.5 * t * t : 0.4 * (t - 0.2);
      sample.station = devices::kHeadStation;
      sample.X_TS.p = Vec3(0.3, -1.0, 1.65) + gone * a;
      all.emplace_back(sample);
      sample.station = devices::kHandStation;
      sample.X_TS.p = Vec3(0.6, -0.7, 0.95) + now * v_hand + gone * a_hand;
      all.emplace_back(sample);
    }
    return all;
  }
};

/// What is found of someone at whom a ball flies from 3 m ahead, passing 0.2 m to the left.
PassedPlayer passed_by_ball(const Mover& mover) {
  Scenario scenario = Lookout::weightless();
  scenario.hand.solid = false;
  Session session = make_session(scenario);
  const engine::BodyId ball = session.stage->balls.front();
  engine::set_kind(session.world, ball, engine::Kind::free);
  engine::set_state(session.world, ball, flying({0.1, 2.0, 1.55}, {0.0, -4.0, 0.0}));
  devices::ReplaySource source(mover.samples());
  while (session.now() < Time{1'900'000}) {
    advance(session, source);
    for (const Event& event : session.events) {
      if (event.kind == kind::passed_player) return event.detail.value_or(PassedPlayer{});
    }
  }
  ADD_FAILURE() << "it never passed";
  return {};
}

// In 0.2 s it goes 0.22 m, or more than 0.3 m as in a throw.
TEST(PresenceWay, AHandThatSwingsGetsOutOfNoWay) {
  const Vec3 right(1.0, 0.0, 0.0);
  EXPECT_NEAR(passed_by_ball({.v_hand = 0.6 * right, .a_hand = 5.0 * right}).hand_away_mps2, 5.0,
              0.1);
  EXPECT_LT(passed_by_ball({.v_hand = 2.0 * right, .a_hand = 5.0 * right}).hand_away_mps2, 0.1);
}

// In 0.2 s there are at most six samples, or five.
TEST(PresenceWay, AnAccelerationTakesSixSamples) {
  const Vec3 right(5.0, 0.0, 0.0);
  EXPECT_NEAR(passed_by_ball({.rate_hz = 28.0, .a = right}).head_away_mps2, 5.0, 0.2);
  EXPECT_EQ(passed_by_ball({.rate_hz = 24.0, .a = right}).head_away_mps2, 0.0);
}

}  // namespace
}  // namespace headpin::scene
