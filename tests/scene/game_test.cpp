// Whole games: what is counted, swept, set again; two versions and their buttons.

#include <gmock/gmock.h>

#include "devices/sources.h"
#include "scene/events.h"
#include "scene/run.h"
#include "scene/score.h"
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

}  // namespace
}  // namespace headpin::scene
