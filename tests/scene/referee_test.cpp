// What the referee counts: whose a fallen skittle is, and when a ball was thrown.

#include "scene/play/referee.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include <gmock/gmock.h>

#include "scene/play/score.h"
#include "scene/play/session.h"
#include "scene/record/events.h"
#include "tests/scene/with_rules.h"

namespace headpin::scene {
namespace {

// What the hand does to a rack of six, driven straight, without a device.
class ByHand {
 public:
  explicit ByHand(Scenario scenario) : session_(make_session(std::move(scenario))) {}

  const Stage& stage() const { return *session_.stage; }
  engine::World& world() { return session_.world; }
  Game& game() { return session_.game; }
  engine::BodyId ball() const { return stage().balls.front(); }
  const std::vector<Event>& events() const { return events_; }
  Time now() const { return session_.now(); }

  std::vector<const Event*> of_kind(std::string_view kind) const {
    std::vector<const Event*> found;
    for (const Event& event : events_) {
      if (event.kind == kind) found.push_back(&event);
    }
    return found;
  }

  void put(engine::BodyId body, const Vec3& p_W, const Vec3& v_W) {
    engine::set_state(world(), body, {{Quat::Identity(), p_W}, v_W, Vec3::Zero()});
  }
  void let_fly(const Vec3& p_W, const Vec3& v_W) {
    engine::set_kind(world(), ball(), engine::Kind::free);
    put(ball(), p_W, v_W);
  }
  /// A ball that rolls beside all skittles, and is counted.
  void miss() {
    const std::size_t before = of_kind(kind::delivery).size();
    let_fly({0.49, 0.5, 0.11}, {0.0, 3.0, 0.0});
    until([&] { return of_kind(kind::delivery).size() > before; }, 10.0);
  }
  /// Takes a body along at a velocity, as a hand that carries it does.
  void carry(engine::BodyId body, const Vec3& from_W, const Vec3& v_W, double for_s) {
    engine::set_kind(world(), body, engine::Kind::driven);
    Vec3 p_W = from_W;
    const double dt = engine::step_seconds(world());
    for (double t = 0.0; t < for_s; t += dt) {
      put(body, p_W, v_W);
      tick(body);
      p_W += dt * v_W;
    }
  }
  void tick(std::optional<engine::BodyId> held = {}) {
    if (held) session_.player.held = Held{*held, Quat::Identity()};
    // What is held is where this test has it: without samples the hand is nowhere.
    Session& s = session_;
    const Moment moment{s.next_tick(), s.tick + 1};
    s.events.clear();
    note_velocities(s.game, s.world);
    engine::step(s.world);
    s.tick = moment.tick;
    const Tick tick{*s.stage, s.world, moment, s.events};
    note_step(s.game, tick);
    if (referee(s.game, tick, held)) taken_ = true;
    events_.insert(events_.end(), s.events.begin(), s.events.end());
    s.player.held.reset();
  }
  template <typename Done>
  bool until(const Done& done, double longest_s, std::optional<engine::BodyId> held = {}) {
    const Time end = session_.now() + microseconds(longest_s);
    while (!done() && session_.now() < end) tick(held);
    return done();
  }
  void wait(double for_s, std::optional<engine::BodyId> held = {}) {
    until([] { return false; }, for_s, held);
  }
  Score score() const { return scene::score(events_); }
  bool taken() const { return taken_; }

 private:
  Session session_;
  std::vector<Event> events_;
  bool taken_ = false;
};

TEST(Referee, WhatTheHandTopplesIsNoBallsAndIsSetAside) {
  ByHand play(with_rules(GameKind::plain, 2, 2));
  const engine::BodyId skittle = play.stage().skittles.back();
  const Vec3 spot = play.stage().world.states[skittle].X_WB.p;
  // A solid hand comes from outside of the rack, at the neck of one at its edge, and goes away.
  const engine::BodyId hand = *play.stage().hand;
  const double side = spot.x() > 0.0 ? 1.0 : -1.0;
  const Vec3 from = spot + Vec3(side * 0.3, 0.0, 0.1);
  play.carry(hand, from, Vec3(-side * 1.5, 0.0, 0.0), 0.25);
  play.put(hand, kAway.p, Vec3::Zero());
  play.wait(2.0);
  const auto fallen = play.of_kind(kind::skittle_down);
  ASSERT_FALSE(fallen.empty());
  for (const Event* e : fallen) EXPECT_EQ(e->detail.value_or(By::nobody), By::hand);
  const std::vector<std::string> first_fallen = fallen.front()->bodies;
  EXPECT_TRUE(play.of_kind(kind::delivery).empty());
  play.miss();  // events that `fallen` points to move
  ASSERT_EQ(play.of_kind(kind::delivery).size(), 1u);
  EXPECT_EQ(play.of_kind(kind::delivery).front()->value, 0.0);
  ASSERT_EQ(play.of_kind(kind::dead_wood).size(), 1u);
  EXPECT_GE(play.of_kind(kind::dead_wood).front()->value, 1.0);
  for (const std::string& name : first_fallen) {
    EXPECT_THAT(play.of_kind(kind::dead_wood).front()->bodies, testing::Contains(name));
  }
  EXPECT_GT(play.world().states[skittle].X_WB.p.y(), play.stage().scenario.room.ahead);
  EXPECT_THAT(in_words(play.score().games.front()), testing::HasSubstr("by hand (frame 1 ball 1)"));
  EXPECT_EQ(play.score().skittles_down, 0);
  // As trials of before have it, it is all the ball's.
  Scenario before = with_rules(GameKind::plain, 2, 2);
  before.game.hand_fells = HandFells::counted;
  ByHand counted(before);
  counted.carry(*counted.stage().hand, from, Vec3(-side * 1.5, 0.0, 0.0), 0.25);
  counted.put(*counted.stage().hand, kAway.p, Vec3::Zero());
  counted.wait(2.0);
  counted.miss();
  EXPECT_GE(counted.of_kind(kind::delivery).front()->value, 1.0);
  EXPECT_TRUE(counted.of_kind(kind::dead_wood).empty());
}

TEST(Referee, ABallThatIsCarriedThroughTheRackFellsNothing) {
  ByHand play(with_rules(GameKind::plain, 2, 2));
  const double head_pin = play.stage().scenario.lane.head_pin;
  play.carry(play.ball(), {0.0, head_pin - 0.5, 0.15}, {0.0, 2.0, 0.0}, 0.7);
  EXPECT_TRUE(play.of_kind(kind::first_contact).empty());
  play.wait(2.0, play.ball());
  const std::size_t fallen = play.of_kind(kind::skittle_down).size();
  ASSERT_GT(fallen, 1u);
  play.let_fly({0.49, 0.5, 0.11}, Vec3::Zero());
  play.until([&] { return !play.of_kind(kind::delivery).empty(); }, 10.0);
  ASSERT_EQ(play.of_kind(kind::delivery).size(), 1u);
  EXPECT_EQ(play.of_kind(kind::delivery).front()->value, 0.0);
  ASSERT_EQ(play.of_kind(kind::dead_wood).size(), 1u);
  EXPECT_GE(play.of_kind(kind::dead_wood).front()->value, static_cast<double>(fallen));
}

// USBC, illegal pinfall: a ball that leaves the lane before it reaches the pins. Here it comes back to them over a flat floor.
TEST(Referee, WhatABallKnocksDownAfterItLeftTheLaneStandsAgain) {
  for (const StrayFells fells : {StrayFells::apart, StrayFells::counted}) {
    Scenario scenario = with_rules(GameKind::plain, 2, 2);
    scenario.game.stray_fells = fells;
    ByHand play(scenario);
    const double beside = 0.5 * scenario.lane.width + 0.2, head_pin = scenario.lane.head_pin;
    play.let_fly({beside, head_pin - 2.0, scenario.ball.radius}, {-0.33 * beside * 8.0, 8.0, 0.0});
    play.until([&] { return !play.of_kind(kind::delivery).empty(); }, 12.0);
    const auto fallen = play.of_kind(kind::skittle_down);
    ASSERT_GT(fallen.size(), 1u) << name_of(fells);
    ASSERT_EQ(play.of_kind(kind::delivery).size(), 1u) << name_of(fells);
    if (fells == StrayFells::counted) {
      EXPECT_GE(play.of_kind(kind::delivery).front()->value, static_cast<double>(fallen.size()));
      EXPECT_TRUE(play.of_kind(kind::set_again).empty());
      continue;
    }
    for (const Event* e : fallen) EXPECT_EQ(e->detail.value_or(By::nobody), By::stray_ball);
    EXPECT_EQ(play.of_kind(kind::delivery).front()->value, 0.0);
    EXPECT_TRUE(play.of_kind(kind::dead_wood).empty());
    EXPECT_GE(play.of_kind(kind::set_again).front()->value, static_cast<double>(fallen.size()));
    EXPECT_THAT(in_words(play.score().games.front()),
                testing::HasSubstr("by a stray ball (frame 1 ball 1)"));
    for (const engine::BodyId skittle : play.stage().skittles) {  // some may have been moved
      const Vec3 off =
          play.world().states[skittle].X_WB.p - play.stage().world.states[skittle].X_WB.p;
      EXPECT_LT(off.norm(), scenario.game.off_spot);
    }
    // The second ball has all of them before it, and counts.
    play.let_fly({0.0, head_pin - 1.5, 0.11}, {0.0, 8.0, 0.0});
    play.until([&] { return play.of_kind(kind::delivery).size() > 1; }, 12.0);
    EXPECT_GT(play.of_kind(kind::delivery).back()->value, 1.0);
    EXPECT_EQ(play.of_kind(kind::set_again).size(), 1u);
  }
}

// The same: a ball that rebounds from the rear cushion.
TEST(Referee, WhatABallKnocksDownOnItsWayBackStandsAgain) {
  ByHand play(with_rules(GameKind::plain, 2, 2));
  play.let_fly({0.0, 7.3, 0.11}, {0.0, -6.0, 0.0});
  play.until([&] { return !play.of_kind(kind::delivery).empty(); }, 12.0);
  ASSERT_GT(play.of_kind(kind::skittle_down).size(), 1u);
  EXPECT_EQ(play.of_kind(kind::delivery).front()->value, 0.0);
  ASSERT_EQ(play.of_kind(kind::set_again).size(), 1u);
  EXPECT_GE(play.of_kind(kind::set_again).front()->value, 2.0);
}

// A ball on the approach has not left the lane, nor has one that touched a skittle first, nor one in the air.
TEST(Referee, ABallThatReachesTheSkittlesIsNotStray) {
  const Scenario scenario = with_rules(GameKind::plain, 2, 2);
  const double half = 0.5 * scenario.lane.width, low = scenario.ball.radius;
  const auto fallen_and_counted = [&](const Vec3& from, const Vec3& v) {
    ByHand play(scenario);
    play.let_fly(from, v);
    play.until([&] { return !play.of_kind(kind::delivery).empty(); }, 12.0);
    // Later it may come back from the wall, and is stray then.
    EXPECT_EQ(play.of_kind(kind::skittle_down).front()->detail.value_or(By::nobody), By::ball);
    EXPECT_GT(play.of_kind(kind::delivery).front()->value, 0.0);
  };
  fallen_and_counted({half + 0.02, -1.0, low}, {-(half + 0.02) * 8.0 / 7.0, 8.0, 0.0});
  fallen_and_counted({half + 0.1, 4.0, 0.4}, {-(half + 0.1) * 8.0 / 2.0, 8.0, 0.0});
  fallen_and_counted({0.0, 4.5, low}, {0.6, 8.0, 0.0});
  const Vec2 corner = scenario.rack.spots.back();  // a corner pin, met over the lane's edge
  const Vec3 at_edge(half + 0.001, scenario.lane.head_pin + corner.y() - 0.4, low);
  fallen_and_counted(at_edge, {-1.5, 8.0, 0.0});
}

/// The default scenario with plain rules, under rules of the step.
Scenario plain_under(std::int64_t rules) {
  Scenario scenario = with_rules(GameKind::plain, 2, 2);
  scenario.collision.rules = rules;
  return scenario;
}

// A stray ball before made them rock. The ball that is thrown now meets the head pin, and that one the others.
TEST(Referee, WhatAStrayBallSetRockingIsTheNextBallsToFell) {
  for (const std::int64_t rules : {10, 11}) {
    ByHand play(plain_under(rules));
    const auto& skittles = play.stage().skittles;
    for (const engine::BodyId skittle : skittles) {
      if (skittle == skittles.front()) continue;
      const Pose& X_WB = play.world().states[skittle].X_WB;
      engine::set_state(play.world(), skittle, {X_WB, Vec3::Zero(), Vec3(0.2, 0.0, 0.0)});
      play.game().moved_by[skittle] = By::stray_ball;
    }
    const double head_pin = play.stage().scenario.lane.head_pin;
    play.let_fly({0.0, head_pin - 0.4, play.stage().scenario.ball.radius}, {0.0, 8.0, 0.0});
    play.tick();
    for (const engine::BodyId skittle : skittles) {
      if (skittle == skittles.front()) continue;
      EXPECT_EQ(play.game().moved_by[skittle], rules < 11 ? By::stray_ball : By::nobody) << rules;
    }
    // The ball alone is a stray one when it comes back from the wall.
    const bool fell = play.until([&] { return play.of_kind(kind::skittle_down).size() > 3; }, 2.0);
    ASSERT_TRUE(fell) << rules;
    std::size_t by_stray = 0;
    for (const Event* e : play.of_kind(kind::skittle_down)) {
      by_stray += e->detail.value_or(By::nobody) == By::stray_ball;
    }
    EXPECT_EQ(by_stray > 0, rules < 11) << rules;
  }
}

// A ball sent it there, upright; the same ball comes back from the wall and touches it.
TEST(Referee, ASkittleThatABallSentOffItsSpotStaysThatBalls) {
  for (const std::int64_t rules : {10, 11}) {
    ByHand play(plain_under(rules));
    const engine::BodyId sent = play.stage().skittles.back();
    play.put(sent, {1.2, 6.9, play.stage().skittle_centre}, Vec3::Zero());
    play.game().moved_by[sent] = By::ball;
    play.let_fly({1.2, 7.3, play.stage().scenario.ball.radius}, {0.0, -3.0, 0.0});
    play.until([&] { return !play.of_kind(kind::delivery).empty(); }, 12.0);
    ASSERT_EQ(play.of_kind(kind::delivery).size(), 1u) << rules;
    ASSERT_FALSE(play.of_kind(kind::touch).empty() && play.of_kind(kind::first_contact).empty());
    const std::string& name = play.world().bodies[sent].name;
    if (rules < 11) {
      ASSERT_EQ(play.of_kind(kind::set_again).size(), 1u);
      EXPECT_THAT(play.of_kind(kind::set_again).front()->bodies, testing::Contains(name));
    } else {
      EXPECT_THAT(play.of_kind(kind::delivery).front()->bodies, testing::Contains(name));
    }
  }
}

// Three pins. The first ball fells one and the hand two, so all are set; then each ball fells one. Their sum with
// the first ball's is that of a rack while one still stands.
TEST(Referee, SkittlesAreSetWhenNoneIsLeftAndNotBefore) {
  for (const std::int64_t rules : {10, 11}) {
    Scenario scenario = with_rules(GameKind::skittles, 1, 6);
    scenario.collision.rules = rules;
    scenario.rack.spots.resize(3);
    ByHand play(scenario);
    const auto& skittles = play.stage().skittles;
    const auto fell = [&](std::size_t i, By by) {
      const double y = 2.0 + 0.5 * static_cast<double>(i);
      play.put(skittles[i], {-1.5, y, play.stage().skittle_centre}, Vec3::Zero());
      play.game().moved_by[skittles[i]] = by;
    };
    const auto swept = [&] {
      const auto& of = play.game().swept;
      return std::count(of.begin(), of.end(), 1);
    };
    fell(0, By::ball);
    fell(1, By::hand);
    fell(2, By::hand);
    play.miss();
    ASSERT_EQ(play.of_kind(kind::delivery).back()->value, 1.0);
    ASSERT_EQ(play.of_kind(kind::dead_wood).size(), 1u);
    ASSERT_EQ(swept(), 0);
    fell(0, By::ball);
    play.miss();
    ASSERT_EQ(swept(), 1) << rules;
    fell(1, By::ball);
    play.miss();
    EXPECT_EQ(swept(), rules < 11 ? 0 : 2);
    if (rules < 11) continue;
    fell(2, By::ball);
    play.miss();
    EXPECT_EQ(swept(), 0);
    EXPECT_EQ(play.game().frames.back(), (Frame{1, 1, 1, 1}));
  }
}

TEST(Referee, ASkittleHeldAsTheBallIsCountedIsTheHandsAndStandsForTheNextFrame) {
  ByHand play(with_rules(GameKind::plain, 2, 1));
  const engine::BodyId held = play.stage().skittles.back();
  const auto rack = static_cast<double>(play.stage().skittles.size());
  const Vec3 in_hand(-1.5, -0.5, 1.0);
  engine::set_kind(play.world(), held, engine::Kind::driven);
  play.put(held, in_hand, Vec3::Zero());
  play.wait(0.2, held);
  const double head_pin = play.stage().scenario.lane.head_pin;
  play.let_fly({0.0, head_pin - 1.0, 0.11}, {0.0, 8.0, 0.0});
  play.until([&] { return !play.of_kind(kind::frame).empty(); }, 10.0, held);
  ASSERT_EQ(play.of_kind(kind::delivery).size(), 1u);
  EXPECT_LE(play.of_kind(kind::delivery).front()->value, rack - 1.0);
  EXPECT_THAT(play.of_kind(kind::delivery).front()->bodies,
              testing::Not(testing::Contains(play.world().bodies[held].name)));
  EXPECT_THAT(play.of_kind(kind::dead_wood).front()->bodies,
              testing::ElementsAre(play.world().bodies[held].name));
  EXPECT_TRUE(play.taken());
  for (const engine::BodyId skittle : play.stage().skittles) {
    EXPECT_EQ(play.world().states[skittle].X_WB.p, play.stage().world.states[skittle].X_WB.p);
    EXPECT_EQ(play.world().bodies[skittle].kind, engine::Kind::free);
  }
}

TEST(Referee, ASkittleThatWasCountedInTheHandStandsForTheNextFrame) {
  for (const std::int64_t rules : {11, 12}) {
    Scenario scenario = with_rules(GameKind::plain, 2, 1);
    scenario.game.hand_fells = HandFells::counted;
    scenario.collision.rules = rules;
    ByHand play(scenario);
    const engine::BodyId held = play.stage().skittles.back();
    engine::set_kind(play.world(), held, engine::Kind::driven);
    play.put(held, {-1.5, -0.5, 1.0}, Vec3::Zero());
    play.wait(0.2, held);
    play.let_fly({0.49, 0.5, 0.11}, {0.0, 3.0, 0.0});
    play.until([&] { return !play.of_kind(kind::frame).empty(); }, 10.0, held);
    ASSERT_EQ(play.of_kind(kind::delivery).front()->value, 1.0) << rules;
    EXPECT_EQ(play.game().swept[held], rules < 12 ? 1 : 0);
    EXPECT_EQ(play.taken(), rules >= 12);
  }
}

// The law of a throw: v / g up, as long down again; it is not counted before it is down.
TEST(Referee, ABallThrownStraightUpIsCountedOnceItIsDown) {
  ByHand play(with_rules(GameKind::plain, 2, 2));
  const double up = 4.95, low = play.stage().scenario.ball.radius, from = 0.75;
  play.let_fly({-1.0, -1.0, from}, {0.0, 0.0, up});
  play.until([&] { return !play.of_kind(kind::delivery).empty(); }, 10.0);
  const double g = play.stage().scenario.collision.gravity;
  const double lands = (up + std::sqrt(up * up + 2.0 * g * (from - low))) / g;
  EXPECT_GT(seconds(play.of_kind(kind::delivery).front()->time), lands);
  EXPECT_LT(seconds(play.of_kind(kind::delivery).front()->time),
            play.stage().scenario.game.ball_back_s);
}

TEST(Referee, ABallThatIsCaughtAgainWasNotThrown) {
  ByHand play(with_rules(GameKind::plain, 2, 2));
  for (const double after_s : {0.05, 0.3, 1.0}) {  // a slip of the trigger; a toss
    play.let_fly({-1.0, -1.0, 1.2}, {0.0, 0.0, 0.5 * 9.81 * after_s});
    play.wait(after_s);
    engine::set_kind(play.world(), play.ball(), engine::Kind::driven);
    play.put(play.ball(), {-1.0, -1.0, 1.2}, Vec3::Zero());
    play.wait(2.0, play.ball());
    EXPECT_TRUE(play.of_kind(kind::delivery).empty()) << after_s;
  }
  play.miss();
  EXPECT_EQ(play.of_kind(kind::delivery).front()->detail.text(), "frame 1 ball 1");
  EXPECT_FALSE(play.taken()) << "it stays in the hand";
}

// Beyond the foul line a ball is thrown for good after half a second.
TEST(Referee, ABallTakenBackBeyondTheLineWasNotThrownWithinHalfASecond) {
  for (const double after_s : {0.48, 0.52}) {
    ByHand play(with_rules(GameKind::plain, 2, 2));
    play.let_fly({-1.0, 0.3, 1.2}, {0.0, 0.0, 0.5 * 9.81 * after_s});
    play.wait(after_s);
    engine::set_kind(play.world(), play.ball(), engine::Kind::driven);
    play.put(play.ball(), {-1.0, -1.0, 1.2}, Vec3::Zero());
    play.wait(2.0, play.ball());
    EXPECT_EQ(play.of_kind(kind::delivery).size(), after_s < 0.5 ? 0u : 1u) << after_s;
    EXPECT_FALSE(play.taken()) << "it stays in the hand";
  }
}

// A ball that is laid down is at rest at once: what it is given is half a second.
TEST(Referee, ABallAtRestIsCountedHalfASecondAfterItWasLetGo) {
  for (const BallEnds ends : {BallEnds::rest, BallEnds::slow}) {
    Scenario scenario = with_rules(GameKind::plain, 2, 2);
    scenario.game.ends = ends;
    ByHand play(scenario);
    play.let_fly({0.3, 1.0, play.stage().scenario.ball.radius}, Vec3::Zero());
    play.tick();
    const double let_go = seconds(play.now());
    play.until([&] { return !play.of_kind(kind::delivery).empty(); }, 10.0);
    ASSERT_EQ(play.of_kind(kind::delivery).size(), 1u) << name_of(ends);
    EXPECT_NEAR(seconds(play.of_kind(kind::delivery).front()->time), let_go + 0.5,
                engine::step_seconds(play.world()) + 1e-6)
        << name_of(ends);
  }
}

// Slower than 5 cm/s it tips no skittle. It rolls without slipping here, on one spot.
TEST(Referee, ABallIsAtRestBelowFiveCentimetresASecond) {
  for (const double speed : {0.049, 0.051}) {
    ByHand play(with_rules(GameKind::plain, 2, 2));
    const double radius = play.stage().scenario.ball.radius;
    play.let_fly({0.3, 1.0, radius}, Vec3::Zero());
    for (double t = 0.0; t < 1.0; t += engine::step_seconds(play.world())) {
      if (!play.of_kind(kind::delivery).empty()) break;
      engine::set_state(play.world(), play.ball(),
                        {{Quat::Identity(), {0.3, 1.0, radius}},
                         Vec3(0.0, speed, 0.0),
                         Vec3(-speed / radius, 0.0, 0.0)});
      play.tick();
    }
    EXPECT_EQ(play.of_kind(kind::delivery).size(), speed < 0.05 ? 1u : 0u) << speed;
  }
}

// As trials of before have it, nothing but the ball's return says that the next one is another.
TEST(Referee, TheNextBallStrikesForTheFirstTimeAgain) {
  for (const HandFells fells : {HandFells::counted, HandFells::apart}) {
    Scenario scenario = with_rules(GameKind::ninepins, 3, 1);
    scenario.game.hand_fells = fells;
    ByHand play(scenario);
    for (std::size_t ball = 1; ball <= 2; ++ball) {
      play.let_fly({0.0, 4.5, 0.11}, {0.0, 6.0, 0.0});
      play.until([&] { return play.of_kind(kind::delivery).size() == ball; }, 12.0);
      EXPECT_EQ(play.of_kind(kind::first_contact).size(), ball) << name_of(fells);
      EXPECT_FALSE(play.game().struck) << name_of(fells);
      EXPECT_FALSE(play.taken()) << "there is nothing in the hand to be taken";
    }
  }
}

TEST(Referee, ACarriedSkittleThatMeetsABallIsTheHandsAllTheSame) {
  ByHand play(with_rules(GameKind::plain, 2, 2));
  const engine::BodyId skittle = play.stage().skittles.front();
  const double radius = play.stage().scenario.ball.radius;
  play.let_fly({0.3, 1.0, radius}, Vec3::Zero());
  for (int i = 0; i < 60; ++i) {  // each tick anew: later ones would tell again whose it is
    const double x = 0.8 * engine::step_seconds(play.world()) * i;
    play.carry(skittle, {x, 1.0, play.stage().skittle_centre}, {0.8, 0.0, 0.0}, 1e-6);
    ASSERT_EQ(play.game().moved_by[skittle], By::hand) << i;
  }
  EXPECT_FALSE(play.of_kind(kind::first_contact).empty());
}

// The ball loses what the skittle gains, against its flight.
TEST(Referee, TheFirstContactHasTheImpulseThatSlowsTheBallDown) {
  ByHand play(with_rules(GameKind::plain, 2, 2));
  play.let_fly({0.0, 5.0, 0.11}, {0.0, 6.0, 0.0});
  play.until([&] { return !play.of_kind(kind::first_contact).empty(); }, 2.0);
  ASSERT_EQ(play.of_kind(kind::first_contact).size(), 1u);
  const Event& contact = *play.of_kind(kind::first_contact).front();
  const double mass = play.stage().scenario.ball.mass;
  EXPECT_GT(std::abs(contact.j_W.y()), 0.1 * mass);
  EXPECT_LT(contact.j_W.norm(), 2.0 * mass * 6.0);  // as from a wall
  EXPECT_LT(contact.value, 6.0);                    // it slid on the lane
  EXPECT_GT(contact.value, 4.0);
}

}  // namespace
}  // namespace headpin::scene
