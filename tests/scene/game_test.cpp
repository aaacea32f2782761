// Whole games: what is counted, swept, set again; two versions and their buttons.

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>

#include "devices/base/sources.h"
#include "scene/play/run.h"
#include "scene/play/score.h"
#include "scene/record/events.h"
#include "tests/scene/with_rules.h"
#include "tests/support/hand_script.h"

namespace headpin::scene {
namespace {

struct Played : Observer {
  void tick(const Session& now) override {
    for (const Event& event : now.events) {
      events.push_back(event);
      score.add(event, now.scenario());
    }
    hashes.push_back(engine::state_hash(now.world));
  }
  std::vector<const Event*> of_kind(std::string_view kind) const {
    std::vector<const Event*> found;
    for (const Event& event : events) {
      if (event.kind == kind) found.push_back(&event);
    }
    return found;
  }
  Session session;
  std::vector<Event> events;
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

TEST(GameTest, BallsComeBackSkittlesAreSweptAndSetAgainAndItEnds) {
  const Scenario scenario = with_rules(GameKind::plain, 2, 2);
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
  for (const Event* delivery : deliveries) {
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
  const Scenario scenario = with_rules(GameKind::ninepins, 3, 1);
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
  Scenario scenario = with_rules(GameKind::plain, 1, 1);
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
  Scenario scenario = with_rules(GameKind::plain, 1, 1);
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
  Scenario scenario = with_rules(GameKind::plain, 1, 1);
  scenario.version.buttons = true;
  scenario.version.blue.elasticity = 1.0;
  scenario.version.blue.friction = 0.0;
  scenario.version.blue.shape = SkittleShape::ellipsoid;
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
  EXPECT_EQ(versions[0]->detail.text(), "red");
  EXPECT_EQ(versions[1]->detail.text(), "blue");
  ASSERT_EQ(played.score.games.size(), 2u);
  EXPECT_EQ(played.score.games[0].version, "red");
  EXPECT_EQ(played.score.games[1].version, "blue");
  EXPECT_TRUE(played.score.games[0].over && played.score.games[1].over);
  EXPECT_EQ(played.session.scenario().material.ball.friction, 0.0);
  EXPECT_EQ(played.session.scenario().collision.shape, SkittleShape::ellipsoid);
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

TEST(GameTest, AButtonTouchedTooEarlyLeavesTheBallToItsOwnVersion) {
  Scenario scenario = with_rules(GameKind::plain, 1, 1);
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
    for (const Event& event : played.events) {
      if (event.kind != kind::release) {
        EXPECT_GE(event.time, before) << event.kind;
      }
      before = event.time;
    }
  }
  EXPECT_GT(counted[0], 0.0);
  EXPECT_EQ(counted[1], counted[0]);  // as if nobody had touched it
}

TEST(GameTest, ABallIsTakenAndLetGoWhereItIs) {
  const Scenario scenario = with_rules(GameKind::plain, 1, 1);
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
  for (const FoulBall rule : {FoulBall::count, FoulBall::note, FoulBall::zero}) {
    Scenario scenario = with_rules(GameKind::plain, 1, 2);
    scenario.game.foul = rule;
    for (const double y : {0.2, -0.4}) {
      HandScript hand(scenario);
      hand.throw_from(0.05, 6.0, 9.5, y);
      const Played played = play(scenario, hand.samples);
      const bool noted = rule != FoulBall::count && y > 0.0;
      const auto fouls = played.of_kind(kind::foul);
      ASSERT_EQ(fouls.size(), noted ? 1u : 0u) << name_of(rule) << y;
      if (noted) {
        EXPECT_NEAR(fouls[0]->value, y, 0.01);  // the next sample jumps up, and is left out
        EXPECT_THAT(in_words(played.score.games[0]), testing::HasSubstr("foul (frame 1 ball 1)"));
      } else {
        EXPECT_THAT(in_words(played.score.games[0]), testing::Not(testing::HasSubstr("foul")));
      }
      const Event& delivery = *played.of_kind(kind::delivery).front();
      const bool costs = rule == FoulBall::zero && y > 0.0;
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
      const ThrowRow& row = played.score.throws[0];
      EXPECT_EQ(row.foul, y > 0.0);
      EXPECT_EQ(row.counted, delivery.value);
      EXPECT_EQ(row.felled_by_ball, static_cast<int>(delivery.bodies.size()));
    }
  }
}

// Oracle: the hand script's own law of motion, and the sheet.
TEST(Throws, AreARowEachWhoseSumsAreTheSheets) {
  const Scenario scenario = with_rules(GameKind::ten_pin, 3, 2);
  HandScript hand(scenario);
  const std::vector<double> speeds = {5.0, 6.0, 7.0, 6.5};
  for (const double speed : speeds) hand.throw_from(0.02 * speed - 0.1, speed);
  const Played played = play(scenario, hand.samples);
  const Score& score = played.score;
  ASSERT_EQ(score.throws.size(), speeds.size());
  int sum = 0;
  std::size_t struck = 0;
  for (std::size_t i = 0; i < speeds.size(); ++i) {
    const ThrowRow& row = score.throws[i];
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
    Event release, contact;
    release.kind = kind::release;
    contact.kind = kind::first_contact;
    release.bodies = contact.bodies = {"ball"};
    contact.detail = FirstContact{Vec3(4.0 * std::sin(angle), 4.0 * std::cos(angle), 0.3)};
    const std::vector<Event> events = {release, contact};
    const Score score = scene::score(events);
    ASSERT_EQ(score.throws.size(), 1u);
    EXPECT_NEAR(score.throws[0].entry_angle_deg.value(), degree, 1e-12);
  }
}

}  // namespace
}  // namespace headpin::scene
