// Whole games: what is counted, swept, set again; two versions and their buttons.

#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "devices/trial/sources.h"
#include "scene/play/events.h"
#include "scene/play/run.h"
#include "scene/play/score.h"
#include "tests/support/hand_script.h"

namespace headpin::scene {
namespace {

struct Played : Observer {
  void tick(const Session& now) override {
    for (const devices::Event& event : now.events) {
      events.push_back(event);
      score.add(event);
    }
    hashes.push_back(engine::state_hash(now.world));
  }
  std::vector<const devices::Event*> of_kind(std::string_view kind) const {
    std::vector<const devices::Event*> found;
    for (const devices::Event& event : events) {
      if (event.kind == kind) found.push_back(&event);
    }
    return found;
  }
  Session session;
  std::vector<devices::Event> events;
  std::vector<std::uint64_t> hashes;
  Score score;
};

Played play(const Scenario& scenario, const std::vector<devices::Sample>& samples) {
  Played played;
  Session session = make_session(scenario);
  devices::ReplaySource source(samples);
  const Time end = source.end();
  NoPace pace;
  Observer* const observers[] = {&played};
  run(session, source, pace, observers, [&](const Session& s) { return s.now() >= end; });
  played.session = std::move(session);
  return played;
}

Scenario with_rules(const std::string& rules, int frames, int balls) {
  Scenario scenario;
  scenario.game.rules = rules;
  scenario.game.frames = frames;
  scenario.game.balls = balls;
  return scenario;
}

TEST(GameTest, BallsComeBackSkittlesAreSweptAndSetAgainAndItEnds) {
  const Scenario scenario = with_rules("plain", 2, 2);
  HandScript hand(scenario);
  for (const double x : {0.0, 0.3, -0.1, 0.4, 0.0}) hand.throw_from(x);
  const Played played = play(scenario, hand.samples);
  const auto deliveries = played.of_kind(kind::delivery);
  ASSERT_EQ(deliveries.size(), 4u);  // the fifth throw is nobody's
  EXPECT_GT(deliveries[0]->value, 0.0);
  EXPECT_EQ(played.of_kind(kind::game).size(), 1u);
  EXPECT_EQ(played.of_kind(kind::frame).size(), 2u);
  EXPECT_EQ(played.of_kind(kind::game_over).size(), 1u);
  EXPECT_GE(played.of_kind(kind::ball_back).size(), 4u);
  // What a ball felled is away before the next, so a frame counts none twice: behind the wall, upright.
  for (const engine::BodyId skittle : played.session.stage->skittles) {
    const engine::State& state = played.session.world.states[skittle];
    const bool swept = played.session.game.swept[skittle] == 1;
    EXPECT_EQ(state.X_WB.p.y() > scenario.room.ahead, swept);
    if (swept) {
      EXPECT_EQ(state.X_WB.p.z(), played.session.stage->skittle_centre);
    }
  }
  ASSERT_EQ(played.score.games.size(), 1u);
  const Sheet& sheet = played.score.games.front();
  EXPECT_TRUE(sheet.over);
  double sum = 0.0;
  for (const devices::Event* delivery : deliveries) {
    sum += delivery->value;
    EXPECT_EQ(delivery->bodies.size(), delivery->value);
  }
  for (const Frame& frame : sheet.frames) {
    int down = 0;
    for (const int roll : frame) down += roll;
    EXPECT_LE(down, 10);
  }
  EXPECT_EQ(points(sheet), sum);
  EXPECT_EQ(played.of_kind(kind::game_over).front()->value, sum);
}

TEST(GameTest, BetweenFramesTheRackStandsAsAtTheStart) {
  const Scenario scenario = with_rules("ninepins", 3, 1);
  HandScript hand(scenario);
  hand.throw_from(0.05);
  const Played played = play(scenario, hand.samples);
  ASSERT_EQ(played.of_kind(kind::frame).size(), 1u);
  const Stage& stage = *played.session.stage;
  for (const engine::BodyId skittle : stage.skittles) {
    EXPECT_EQ(played.session.world.states[skittle].X_WB.p, stage.world.states[skittle].X_WB.p);
    EXPECT_TRUE(engine::is_asleep(played.session.world, skittle));
    EXPECT_FALSE(played.session.game.swept[skittle]);
  }
  const engine::BodyId ball = stage.balls.front();
  EXPECT_EQ(played.session.world.states[ball].X_WB.p, scenario.ball.home);
  EXPECT_EQ(played.session.world.bodies[ball].kind, engine::Kind::driven);
}

TEST(GameTest, WithoutFrictionNothingRestsAndTheBallComesBackAllTheSame) {
  Scenario scenario = with_rules("plain", 1, 1);
  set_elasticity(scenario.material, 1.0);
  set_friction(scenario.material, 0.0);
  HandScript hand(scenario);
  hand.throw_from(0.0);
  const Played played = play(scenario, hand.samples);
  ASSERT_EQ(played.of_kind(kind::delivery).size(), 1u);
  const double after = seconds(played.of_kind(kind::delivery).front()->time -
                               played.of_kind(kind::release).front()->time);
  EXPECT_NEAR(after, scenario.game.ball_back_s, 0.01);
  EXPECT_TRUE(played.score.games.front().over);
}

TEST(GameTest, AnUprightSkittleFarFromItsSpotIsDown) {
  Scenario scenario = with_rules("plain", 1, 1);
  scenario.game.off_spot = 1e-6;  // whatever was moved at all
  HandScript hand(scenario);
  hand.throw_from(0.35);
  const double strict = play(scenario, hand.samples).of_kind(kind::delivery).front()->value;
  scenario.game.off_spot = 10.0;
  const Played fallen = play(scenario, hand.samples);
  EXPECT_EQ(fallen.of_kind(kind::delivery).front()->value,
            static_cast<double>(fallen.of_kind(kind::skittle_down).size()));
  EXPECT_GE(strict, fallen.of_kind(kind::delivery).front()->value);
}

Scenario with_buttons() {
  Scenario scenario = with_rules("plain", 1, 1);
  scenario.version.buttons = true;
  scenario.version.blue.elasticity = 1.0;
  scenario.version.blue.friction = 0.0;
  scenario.version.blue.shape = "ellipsoid";
  return scenario;
}

TEST(GameTest, AButtonStartsItsVersionAndTheSessionGoesOn) {
  const Scenario scenario = with_buttons();
  HandScript hand(scenario);
  hand.touch(scenario.version.red.button);
  hand.throw_from(0.0);
  hand.touch(scenario.version.blue.button);
  hand.throw_from(0.0);
  const Played played = play(scenario, hand.samples);
  const auto versions = played.of_kind(kind::version);
  ASSERT_EQ(versions.size(), 2u);
  EXPECT_EQ(versions[0]->detail, "red");
  EXPECT_EQ(versions[1]->detail, "blue");
  ASSERT_EQ(played.score.games.size(), 2u);
  EXPECT_EQ(played.score.games[0].version, "red");
  EXPECT_EQ(played.score.games[1].version, "blue");
  EXPECT_TRUE(played.score.games[0].over && played.score.games[1].over);
  EXPECT_EQ(played.session.scenario().material.ball.friction, 0.0);
  EXPECT_EQ(played.session.scenario().collision.shape, "ellipsoid");
  // One clock and one ledger through both.
  EXPECT_EQ(static_cast<std::size_t>(played.session.tick), played.hashes.size());
  EXPECT_EQ(played.session.world.tick, played.session.tick);
  EXPECT_NEAR(engine::balance(played.session.world).energy,
              played.session.world.ledger.sum().energy, 1e-6);
  // To the bit again.
  EXPECT_EQ(play(scenario, hand.samples).hashes, played.hashes);
}

TEST(GameTest, WithButtonsNothingCountsBeforeOneIsTouched) {
  const Scenario scenario = with_buttons();
  HandScript hand(scenario);
  hand.throw_from(0.0);
  const Played played = play(scenario, hand.samples);
  EXPECT_TRUE(played.of_kind(kind::game).empty());
  EXPECT_TRUE(played.of_kind(kind::delivery).empty());
  EXPECT_TRUE(played.score.games.empty());
}

// What the hand does to a rack of six, driven straight, without a device.
class ByHand {
 public:
  explicit ByHand(Scenario scenario) : session_(make_session(std::move(scenario))) {}

  const Stage& stage() const { return *session_.stage; }
  engine::World& world() { return session_.world; }
  Game& game() { return session_.game; }
  engine::BodyId ball() const { return stage().balls.front(); }
  const std::vector<devices::Event>& events() const { return events_; }
  Time now() const { return session_.now(); }

  std::vector<const devices::Event*> of_kind(std::string_view kind) const {
    std::vector<const devices::Event*> found;
    for (const devices::Event& event : events_) {
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
    note_step(s.game, *s.stage, s.world, moment, s.events);
    if (referee(s.game, *s.stage, s.world, moment, held, s.events)) taken_ = true;
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
  std::vector<devices::Event> events_;
  bool taken_ = false;
};

TEST(Referee, WhatTheHandTopplesIsNoBallsAndIsSetAside) {
  ByHand play(with_rules("plain", 2, 2));
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
  for (const devices::Event* e : fallen) EXPECT_EQ(e->detail, "hand");
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
  Scenario before = with_rules("plain", 2, 2);
  before.game.hand_fells = "counted";
  ByHand counted(before);
  counted.carry(*counted.stage().hand, from, Vec3(-side * 1.5, 0.0, 0.0), 0.25);
  counted.put(*counted.stage().hand, kAway.p, Vec3::Zero());
  counted.wait(2.0);
  counted.miss();
  EXPECT_GE(counted.of_kind(kind::delivery).front()->value, 1.0);
  EXPECT_TRUE(counted.of_kind(kind::dead_wood).empty());
}

TEST(Referee, ABallThatIsCarriedThroughTheRackFellsNothing) {
  ByHand play(with_rules("plain", 2, 2));
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

TEST(Referee, ASkittleHeldAsTheBallIsCountedIsTheHandsAndStandsForTheNextFrame) {
  ByHand play(with_rules("plain", 2, 1));
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

// The law of a throw: v / g up, as long down again; it is not counted before it is down.
TEST(Referee, ABallThrownStraightUpIsCountedOnceItIsDown) {
  ByHand play(with_rules("plain", 2, 2));
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
  ByHand play(with_rules("plain", 2, 2));
  for (const double after_s : {0.05, 0.3, 1.0}) {  // a slip of the trigger; a toss
    play.let_fly({-1.0, -1.0, 1.2}, {0.0, 0.0, 0.5 * 9.81 * after_s});
    play.wait(after_s);
    engine::set_kind(play.world(), play.ball(), engine::Kind::driven);
    play.put(play.ball(), {-1.0, -1.0, 1.2}, Vec3::Zero());
    play.wait(2.0, play.ball());
    EXPECT_TRUE(play.of_kind(kind::delivery).empty()) << after_s;
  }
  play.miss();
  EXPECT_EQ(play.of_kind(kind::delivery).front()->detail, "frame 1 ball 1");
  EXPECT_FALSE(play.taken()) << "it stays in the hand";
}

// Beyond the foul line a ball is thrown for good after half a second.
TEST(Referee, ABallTakenBackBeyondTheLineWasNotThrownWithinHalfASecond) {
  for (const double after_s : {0.48, 0.52}) {
    ByHand play(with_rules("plain", 2, 2));
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
  for (const char* ends : {"rest", "slow"}) {
    Scenario scenario = with_rules("plain", 2, 2);
    scenario.game.ends = ends;
    ByHand play(scenario);
    play.let_fly({0.3, 1.0, play.stage().scenario.ball.radius}, Vec3::Zero());
    play.tick();
    const double let_go = seconds(play.now());
    play.until([&] { return !play.of_kind(kind::delivery).empty(); }, 10.0);
    ASSERT_EQ(play.of_kind(kind::delivery).size(), 1u) << ends;
    EXPECT_NEAR(seconds(play.of_kind(kind::delivery).front()->time), let_go + 0.5,
                engine::step_seconds(play.world()) + 1e-6)
        << ends;
  }
}

// Slower than 5 cm/s it tips no skittle. It rolls without slipping here, on one spot.
TEST(Referee, ABallIsAtRestBelowFiveCentimetresASecond) {
  for (const double speed : {0.049, 0.051}) {
    ByHand play(with_rules("plain", 2, 2));
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

TEST(GameTest, AButtonTouchedTooEarlyLeavesTheBallToItsOwnVersion) {
  Scenario scenario = with_rules("plain", 1, 1);
  scenario.version.buttons = true;
  std::vector<double> counted;
  for (const double wait_s : {9.5, 0.1}) {
    HandScript hand(scenario);
    hand.touch(scenario.version.red.button);
    hand.throw_from(0.0, 6.0, wait_s);
    hand.touch(scenario.version.blue.button);
    hand.stay(Vec3(-1.2, -1.0, 1.0), 0.5);
    const Played played = play(scenario, hand.samples);
    ASSERT_EQ(played.of_kind(kind::version).size(), 2u);
    ASSERT_EQ(played.of_kind(kind::delivery).size(), 1u) << wait_s;
    counted.push_back(played.of_kind(kind::delivery).front()->value);
    ASSERT_EQ(played.score.games.size(), 2u);
    EXPECT_EQ(played.score.games[0].version, "red");
    EXPECT_TRUE(played.score.games[0].over);
    EXPECT_EQ(points(played.score.games[0]), counted.back());
    EXPECT_EQ(points(played.score.games[1]), 0);
    ASSERT_EQ(played.score.throws.size(), 1u);
    EXPECT_EQ(played.score.throws[0].version, "red");
    EXPECT_EQ(played.score.throws[0].counted, counted.back());
    // What is counted ahead happens when the button is touched.
    Time before{};
    for (const devices::Event& event : played.events) {
      if (event.kind != kind::release) {
        EXPECT_GE(event.time, before) << event.kind;
      }
      before = event.time;
    }
  }
  EXPECT_GT(counted[0], 0.0);
  EXPECT_EQ(counted[1], counted[0]);  // as if nobody had touched it
}

// As trials of before have it, nothing but the ball's return says that the next one is another.
TEST(Referee, TheNextBallStrikesForTheFirstTimeAgain) {
  for (const char* fells : {"counted", "apart"}) {
    Scenario scenario = with_rules("ninepins", 3, 1);
    scenario.game.hand_fells = fells;
    ByHand play(scenario);
    for (std::size_t ball = 1; ball <= 2; ++ball) {
      play.let_fly({0.0, 4.5, 0.11}, {0.0, 6.0, 0.0});
      play.until([&] { return play.of_kind(kind::delivery).size() == ball; }, 12.0);
      EXPECT_EQ(play.of_kind(kind::first_contact).size(), ball) << fells;
      EXPECT_FALSE(play.game().struck) << fells;
      EXPECT_FALSE(play.taken()) << "there is nothing in the hand to be taken";
    }
  }
}

TEST(Referee, ACarriedSkittleThatMeetsABallIsTheHandsAllTheSame) {
  ByHand play(with_rules("plain", 2, 2));
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
  ByHand play(with_rules("plain", 2, 2));
  play.let_fly({0.0, 5.0, 0.11}, {0.0, 6.0, 0.0});
  play.until([&] { return !play.of_kind(kind::first_contact).empty(); }, 2.0);
  ASSERT_EQ(play.of_kind(kind::first_contact).size(), 1u);
  const devices::Event& contact = *play.of_kind(kind::first_contact).front();
  const double mass = play.stage().scenario.ball.mass;
  EXPECT_GT(std::abs(contact.j_W.y()), 0.1 * mass);
  EXPECT_LT(contact.j_W.norm(), 2.0 * mass * 6.0);  // as from a wall
  EXPECT_LT(contact.value, 6.0);                    // it slid on the lane
  EXPECT_GT(contact.value, 4.0);
}

TEST(GameTest, ABallIsTakenAndLetGoWhereItIs) {
  const Scenario scenario = with_rules("plain", 1, 1);
  HandScript hand(scenario);
  hand.throw_from(0.1, 6.0, 0.1);
  const Played played = play(scenario, hand.samples);
  ASSERT_EQ(played.of_kind(kind::grab).size(), 1u);
  EXPECT_LT((played.of_kind(kind::grab).front()->p_W - scenario.ball.home).norm(), 1e-9);
  ASSERT_EQ(played.of_kind(kind::release).size(), 1u);
  const Vec3 there = played.of_kind(kind::release).front()->p_W;
  EXPECT_NEAR(there.x(), 0.1, 1e-6);
  EXPECT_NEAR(there.y(), 0.0, 0.1);  // a tick's way
}

TEST(Foul, ABallLetGoBeyondTheLineIsCountedNotedOrCostsTheBall) {
  for (const std::string rule : {"count", "note", "zero"}) {
    Scenario scenario = with_rules("plain", 1, 2);
    scenario.game.foul = rule;
    for (const double y : {0.2, -0.4}) {
      HandScript hand(scenario);
      hand.throw_from(0.05, 6.0, 9.5, y);
      const Played played = play(scenario, hand.samples);
      const bool noted = rule != "count" && y > 0.0;
      const auto fouls = played.of_kind(kind::foul);
      ASSERT_EQ(fouls.size(), noted ? 1u : 0u) << rule << y;
      if (noted) {
        EXPECT_NEAR(fouls[0]->value, y + 6.0 / 60.0, 0.01);  // a sample after y, evenly on
        EXPECT_THAT(in_words(played.score.games[0]), testing::HasSubstr("foul (frame 1 ball 1)"));
      } else {
        EXPECT_THAT(in_words(played.score.games[0]), testing::Not(testing::HasSubstr("foul")));
      }
      const devices::Event& delivery = *played.of_kind(kind::delivery).front();
      const bool costs = rule == "zero" && y > 0.0;
      ASSERT_FALSE(delivery.bodies.empty());
      EXPECT_EQ(delivery.value, costs ? 0.0 : static_cast<double>(delivery.bodies.size()));
      const Stage& stage = *played.session.stage;
      for (const engine::BodyId skittle : stage.skittles) {
        if (costs) {  // all stand again for the second ball
          EXPECT_LT(
              (played.session.world.states[skittle].X_WB.p - stage.world.states[skittle].X_WB.p)
                  .norm(),
              scenario.game.off_spot);
        }
      }
      ASSERT_EQ(played.score.throws.size(), 1u);
      const devices::ThrowRow& row = played.score.throws[0];
      EXPECT_EQ(row.foul, y > 0.0);
      EXPECT_EQ(row.counted, delivery.value);
      EXPECT_EQ(row.felled_by_ball, static_cast<int>(delivery.bodies.size()));
    }
  }
}

// Oracle: the hand script's own law of motion, and the sheet.
TEST(Throws, AreARowEachWhoseSumsAreTheSheets) {
  const Scenario scenario = with_rules("ten-pin", 3, 2);
  HandScript hand(scenario);
  const std::vector<double> speeds = {5.0, 6.0, 7.0, 6.5};
  for (const double speed : speeds) hand.throw_from(0.02 * speed - 0.1, speed);
  const Played played = play(scenario, hand.samples);
  const Score& score = played.score;
  ASSERT_EQ(score.throws.size(), speeds.size());
  int sum = 0;
  std::size_t struck = 0;
  for (std::size_t i = 0; i < speeds.size(); ++i) {
    const devices::ThrowRow& row = score.throws[i];
    ASSERT_TRUE(row.p_WB && row.v_WB && row.w_WB);
    // The trigger is one sample after the last that is known, and the hand gained speed evenly.
    EXPECT_NEAR(row.v_WB->y(), speeds[i] + speeds[i] / 0.5 / 60.0, 0.01);
    EXPECT_NEAR(row.speed, row.v_WB->norm(), 1e-12);
    EXPECT_NEAR(row.p_WB->x(), 0.02 * speeds[i] - 0.1, 1e-6);
    EXPECT_LT(row.w_WB->norm(), 1e-6);  // the hand did not turn
    sum += row.counted.value_or(0);
    if (!row.entry) continue;
    ++struck;
    EXPECT_GT(*row.entry, row.release);
    EXPECT_LT(std::abs(row.entry_angle_deg.value()), 2.0);
    EXPECT_LE(row.entry_speed.value(), row.speed + 0.2);
  }
  EXPECT_GT(struck, 0u);
  EXPECT_EQ(struck, played.of_kind(kind::first_contact).size());
  EXPECT_EQ(score.release_speed, score.throws[0].speed);
  EXPECT_EQ(score.impact_speed, score.throws[0].entry_speed);
  int in_sheet = 0;
  for (const Frame& frame : score.games.at(0).frames) {
    for (const int roll : frame) in_sheet += roll;
  }
  EXPECT_EQ(sum, in_sheet);
  EXPECT_EQ(score.skittles_down, in_sheet);
}

// The C library's arc tangent is another's; its last digit may differ from machine to machine.
TEST(Throws, EnterAtTheAngleOfTheirVelocityAllAround) {
  for (int degree = -179; degree <= 180; ++degree) {
    const double angle = degree * std::numbers::pi / 180.0;
    devices::Event release, contact;
    release.kind = kind::release;
    contact.kind = kind::first_contact;
    release.bodies = contact.bodies = {"ball"};
    contact.detail = fmt::format(R"({{"velocity_mps":[{},{},0.3]}})", 4.0 * std::sin(angle),
                                 4.0 * std::cos(angle));
    const std::vector<devices::Event> events = {release, contact};
    const Score score = scene::score(events);
    ASSERT_EQ(score.throws.size(), 1u);
    EXPECT_NEAR(score.throws[0].entry_angle_deg.value(), degree, 1e-12);
  }
}

}  // namespace
}  // namespace headpin::scene
