// What the referee does at a tick, with bodies that are put there by hand and that no step moves.

#include <gmock/gmock.h>

#include "devices/base/sources.h"
#include "scene/play/referee.h"
#include "scene/play/session.h"
#include "scene/record/events.h"
#include "tests/scene/with_rules.h"

namespace headpin::scene {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

using Names = std::vector<std::string>;

/// A game of few skittles, refereed tick by tick.
struct Refereed {
  explicit Refereed(Scenario scenario)
      : stage(make_stage(scenario)), world(stage.world), game(make_game(stage)) {}

  const engine::State& at(engine::BodyId body) const { return world.states[body]; }
  void put(engine::BodyId body, const Vec3& p_W, const Vec3& v_W = Vec3::Zero()) {
    engine::set_state(world, body, {{Quat::Identity(), p_W}, v_W, Vec3::Zero()});
  }
  /// The ball lies on the lane, or is there with a velocity.
  void let_go(const Vec3& p_W = {0.3, 1.0, 0.11}, const Vec3& v_W = Vec3::Zero()) {
    engine::set_kind(world, ball, engine::Kind::free);
    put(ball, p_W, v_W);
  }
  void take(engine::BodyId body) { engine::set_kind(world, body, engine::Kind::driven); }
  void fell(std::size_t i, By by) {
    put(stage.skittles[i], {-1.5, 2.0 + 0.5 * static_cast<double>(i), stage.skittle_centre});
    game.moved_by[stage.skittles[i]] = by;
  }
  bool tick(std::optional<engine::BodyId> held = {}) {
    std::vector<Event> now;
    ++ticks;
    const bool from_hand = referee(game, {stage, world, {tick_time(ticks, 240), ticks}, now}, held);
    events.insert(events.end(), now.begin(), now.end());
    return from_hand;
  }
  /// Ticks until there is an event of a kind since then; at most for `longest`.
  /// @return  how many
  int until(std::string_view kind, int longest, std::optional<engine::BodyId> held = {}) {
    events.clear();
    for (int i = 1; i <= longest; ++i) {
      taken |= tick(held);
      if (!of_kind(kind).empty()) return i;
    }
    return longest + 1;
  }
  /// Counts a ball that is laid down beside the skittles.
  void lay_down() {
    let_go();
    EXPECT_LE(until(kind::delivery, 200), 200);
  }
  std::vector<const Event*> of_kind(std::string_view kind) const {
    std::vector<const Event*> found;
    for (const Event& event : events) {
      if (event.kind == kind) found.push_back(&event);
    }
    return found;
  }
  Names kinds() const {
    Names all;
    for (const Event& event : events) all.push_back(event.kind);
    return all;
  }

  Stage stage;
  engine::World world;
  Game game;
  std::vector<Event> events;
  std::int64_t ticks = 0;
  bool taken = false;
  engine::BodyId ball = stage.balls.front(), skittle = stage.skittles.front();
};

Scenario of_skittles(std::size_t count, GameKind kind = GameKind::plain, int frames = 2,
                     int balls = 2) {
  Scenario scenario = with_rules(kind, frames, balls);
  scenario.rack.spots.resize(count);
  return scenario;
}

TEST(RefereeTicks, ASkittleThatTheHandCarriesDelaysNoBall) {
  Refereed play(of_skittles(2));
  play.take(play.skittle);
  play.put(play.skittle, {-1.0, -0.5, 1.0}, {2.0, 0.0, 0.0});
  play.let_go();
  EXPECT_EQ(play.until(kind::delivery, 300, play.skittle), 121);  // half a second after the first
}

// On its way for ever, where the ball comes back after 8 s at the latest.
TEST(RefereeTicks, ABallThatLeftTheRoomIsOverAndOneInTheRoomIsNot) {
  const Room room = of_skittles(1).room;
  const double x = 0.5 * room.width, far = 1e-3;
  const auto counted = [](const Vec3& p_W) {
    Refereed play(of_skittles(1));
    play.let_go(p_W, {1.0, 1.0, 1.0});
    return play.until(kind::delivery, 200) <= 200;
  };
  for (const Vec3& beyond :
       {Vec3(x + far, 1.0, 0.3), Vec3(-x - far, 1.0, 0.3), Vec3(0.0, room.ahead + far, 0.3),
        Vec3(0.0, -room.behind - far, 0.3), Vec3(0.0, 1.0, -1.0 - far)}) {
    EXPECT_TRUE(counted(beyond)) << beyond.transpose();
  }
  for (const Vec3& inside : {Vec3(x, 1.0, 0.3), Vec3(-x, 1.0, 0.3), Vec3(0.0, room.ahead, 0.3),
                             Vec3(0.0, -room.behind, 0.3), Vec3(0.0, 1.0, -1.0)}) {
    EXPECT_FALSE(counted(inside)) << inside.transpose();
  }
}

// As at the top of a flight, again and again: each time it is slow for less than it must be.
TEST(RefereeTicks, RestsThatAreTooShortAddUpToNone) {
  Refereed play(of_skittles(1));
  for (int i = 0; i < 600; ++i) {
    const bool slow = i / 12 % 2 == 0;  // 50 ms
    play.let_go({0.3, 1.0, 0.5}, {0.0, 0.0, slow ? 0.0 : 1.0});
    play.tick();
  }
  EXPECT_THAT(play.of_kind(kind::delivery), IsEmpty());
}

// Half a second is less than a body must rest where it falls so slowly.
TEST(RefereeTicks, EveryBallMustRestAnewBeforeItIsCounted) {
  Scenario scenario = of_skittles(1, GameKind::plain, 1, 3);
  scenario.collision.gravity = 0.1;
  Refereed play(scenario);
  play.let_go();
  const int first = play.until(kind::delivery, 1000);
  EXPECT_NEAR(first, 240 * (4.0 * 0.05 / 0.1 + 0.1), 2.0);
  play.until(kind::game, 240);  // nothing is thrown
  play.let_go();
  EXPECT_EQ(play.until(kind::delivery, 1000), first);
}

TEST(RefereeTicks, ASkittleWithoutAKnownCauseIsTheBallsThatStruck) {
  for (const bool struck : {true, false}) {
    Refereed play(of_skittles(2));
    play.tick();
    play.fell(0, By::nobody);
    play.game.struck = struck;
    play.lay_down();
    EXPECT_EQ(play.of_kind(kind::delivery)[0]->value, struck ? 1.0 : 0.0);
    EXPECT_EQ(play.of_kind(kind::dead_wood).size(), struck ? 0u : 1u);
  }
}

TEST(RefereeTicks, ACountTellsTheWayTheBallOfTheFrameAndWhereTheBallIs) {
  Refereed play(of_skittles(3));
  play.lay_down();
  play.fell(1, By::hand);
  play.fell(2, By::stray_ball);
  play.let_go();
  play.game.watched =
      WatchedBall{play.ball, watch_ball(play.stage.room, play.at(play.ball)), {}, {}};
  play.until(kind::delivery, 200);
  EXPECT_THAT(play.kinds(), ElementsAre(kind::ball_path, kind::dead_wood, kind::set_again,
                                        kind::delivery, kind::ball_back, kind::frame));
  EXPECT_FALSE(play.game.watched);
  for (const auto kind : {kind::dead_wood, kind::set_again, kind::delivery}) {
    EXPECT_EQ(play.of_kind(kind)[0]->detail.text(), "frame 1 ball 2") << kind;
  }
  EXPECT_EQ(play.of_kind(kind::ball_back)[0]->p_W, play.stage.scenario.ball.home);
}

TEST(RefereeTicks, TheNextBallOfAFrameHasNotStruckAndIsNoFoul) {
  Refereed play(of_skittles(2));
  play.tick();
  play.game.foul = play.game.struck = true;
  play.lay_down();
  EXPECT_FALSE(play.game.struck);
  play.lay_down();
  EXPECT_THAT(play.game.fouls, ElementsAre(1, 0));
}

TEST(RefereeTicks, AFoulEndsWithABallThatIsTakenBack) {
  Refereed play(of_skittles(2));
  play.let_go({0.0, 0.2, 1.0});
  play.game.foul = true;
  play.tick();
  play.take(play.ball);
  play.tick();
  ASSERT_FALSE(play.game.thrown);
  play.lay_down();
  EXPECT_THAT(play.game.fouls, ElementsAre(0));
}

TEST(RefereeTicks, ABallOnTheFoulLineIsNotBeyondIt) {
  for (const double y : {0.0, 1e-9}) {
    Refereed play(of_skittles(2));
    play.let_go({0.0, y, 1.0}, {0.0, 0.0, 1.0});
    play.until(kind::delivery, 240);
    play.take(play.ball);
    EXPECT_EQ(play.until(kind::delivery, 240) <= 240, y > 0.0) << y;
  }
}

// Seven by the ball and three by the hand: no spare, so the last frame has no bonus. A strike has two.
TEST(RefereeTicks, AFrameWithoutSkittlesIsOverUnlessABonusIsToCome) {
  for (const int frames : {1, 2}) {
    Refereed play(of_skittles(10, GameKind::ten_pin, frames));
    play.tick();
    for (std::size_t i = 0; i < 10; ++i) play.fell(i, i < 7 ? By::ball : By::hand);
    play.lay_down();
    EXPECT_EQ(play.of_kind(kind::frame).size(), 1u) << frames;
    EXPECT_EQ(play.game.over, frames == 1);
  }
  Refereed strike(of_skittles(10, GameKind::ten_pin, 1));
  strike.tick();
  for (std::size_t i = 0; i < 10; ++i) strike.fell(i, By::ball);
  strike.lay_down();
  EXPECT_FALSE(strike.game.over);
  EXPECT_THAT(strike.of_kind(kind::frame), IsEmpty());
  EXPECT_EQ(strike.at(strike.skittle).X_WB.p, strike.stage.world.states[strike.skittle].X_WB.p);
}

TEST(RefereeTicks, AtTheEndOfTheGameNothingIsTakenFromTheHand) {
  Refereed play(of_skittles(2, GameKind::plain, 1, 1));
  play.take(play.skittle);
  play.put(play.skittle, {-1.0, -0.5, 1.0});
  play.let_go();
  play.until(kind::game_over, 200, play.skittle);
  ASSERT_TRUE(play.game.over);
  EXPECT_FALSE(play.taken);
  // When the hand lets go of what was counted in it, it is put away.
  play.game.over = false;
  engine::set_kind(play.world, play.skittle, engine::Kind::free);
  play.tick();
  EXPECT_GT(play.at(play.skittle).X_WB.p.y(), play.stage.scenario.room.ahead);
}

TEST(RefereeTicks, ASkittleThatStandsOnItsSpotAgainHasNoCause) {
  Refereed play(of_skittles(2));
  play.game.moved_by[play.skittle] = By::ball;
  play.game.down[play.skittle] = 1;
  const engine::BodyId carried = play.stage.skittles[1];
  play.take(carried);
  play.game.moved_by[carried] = By::hand;
  engine::put_to_sleep(play.world, play.skittle);
  play.tick(carried);
  EXPECT_EQ(play.game.moved_by[play.skittle], By::nobody);
  EXPECT_EQ(play.game.down[play.skittle], 0);
  EXPECT_EQ(play.game.moved_by[carried], By::hand);
}

// By the rules of before, a skittle in the hand stays there where its fall counts; all others are set.
TEST(RefereeTicks, OlderRulesSetAllSkittlesButTheOneInTheHand) {
  for (const HandFells fells : {HandFells::apart, HandFells::counted}) {
    Scenario scenario = of_skittles(3, GameKind::plain, 2, 1);
    scenario.collision.rules = 11;
    scenario.game.hand_fells = fells;
    Refereed play(scenario);
    const engine::BodyId held = play.stage.skittles[2];
    play.tick();
    play.fell(0, By::ball);
    play.fell(1, By::ball);
    play.take(held);
    play.put(held, {-1.0, -0.5, 1.0});
    play.let_go();
    play.until(kind::delivery, 200, held);
    for (const engine::BodyId skittle : play.stage.skittles) {
      const bool stands = skittle != held || fells == HandFells::apart;
      EXPECT_EQ(play.game.swept[skittle], stands ? 0 : 1) << name_of(fells);
    }
    EXPECT_EQ(play.taken, fells == HandFells::apart);
  }
}

// The hand has a skittle as the next frame begins: it is empty at that tick, and grabs anew later.
TEST(RefereeTicks, ASessionsHandIsEmptyOnceItsSkittleIsSet) {
  Session session = make_session(of_skittles(1, GameKind::plain, 2, 1));
  const Stage& stage = *session.stage;
  const engine::BodyId skittle = stage.skittles.front(), ball = stage.balls.front();
  std::vector<devices::Sample> samples;
  for (int i = 0; i <= 90; ++i) {
    devices::TrackerSample hand;
    hand.device_time = tick_time(i, 60);
    hand.sequence = i;
    hand.station = devices::kHandStation;
    hand.X_TS.p = stage.world.states[skittle].X_WB.p - stage.scenario.hand.grip;
    samples.emplace_back(hand);
  }
  samples.emplace_back(devices::MouseSample{.device_time = Time{100'000}, .trigger = true});
  devices::ReplaySource source(samples);
  while (session.now() < Time{200'000}) advance(session, source);
  ASSERT_TRUE(session.player.held);
  EXPECT_EQ(session.player.held->body, skittle);
  engine::set_kind(session.world, ball, engine::Kind::free);
  engine::set_state(
      session.world, ball,
      {{Quat::Identity(), Vec3(0.3, 1.0, stage.scenario.ball.radius)}, Vec3::Zero(), Vec3::Zero()});
  while (session.game.frames.size() < 2 && session.now() < Time{1'200'000}) {
    ASSERT_TRUE(session.player.held);
    advance(session, source);
  }
  ASSERT_EQ(session.game.frames.size(), 2u);
  EXPECT_FALSE(session.player.held);
  EXPECT_EQ(session.player.grip_changed, session.now());
}

}  // namespace
}  // namespace headpin::scene
