// What the game notes of a step, from contacts, states and releases that are put there by hand.

#include <cmath>

#include <gmock/gmock.h>

#include "scene/play/game.h"
#include "scene/record/events.h"
#include "tests/scene/with_rules.h"

namespace headpin::scene {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// A game whose world is where a test puts it: no step moves it.
struct Still {
  explicit Still(Scenario scenario = with_rules(GameKind::plain, 2, 2))
      : stage(make_stage(scenario)), world(stage.world), game(make_game(stage)) {
    engine::set_kind(world, ball, engine::Kind::free);
    put(ball, {0.0, 1.0, 0.5});
  }
  void put(engine::BodyId body, const Vec3& p_W, const Vec3& v_W = Vec3::Zero()) {
    engine::set_state(world, body, {{Quat::Identity(), p_W}, v_W, Vec3::Zero()});
  }
  void meet(engine::BodyId a, engine::BodyId b, bool first = true) {
    engine::ContactEvent contact;
    contact.a = a;
    contact.b = b;
    contact.first = first;
    world.events.push_back(contact);
  }
  void let_go(const Detail& detail = {}, const Vec3& p_W = Vec3::Zero()) {
    Event e;
    e.kind = kind::release;
    e.bodies = {world.bodies[ball].name};
    e.p_W = p_W;
    e.detail = detail;
    events.push_back(std::move(e));
  }
  /// @return  the kinds of its events
  std::vector<std::string> note() {
    note_velocities(game, world);
    note_step(game, {stage, world, {tick_time(++ticks, 240), ticks}, events});
    std::vector<std::string> kinds;
    for (const Event& e : events) kinds.push_back(e.kind);
    noted = std::move(events);
    events.clear();
    world.events.clear();
    return kinds;
  }
  const BallPath& path() const { return game.watched->watch.path; }

  Stage stage;
  engine::World world;
  Game game;
  std::vector<Event> events, noted;
  std::int64_t ticks = 0;
  engine::BodyId ball = stage.balls.front(), hand = *stage.hand, lane = stage.lane;
  engine::BodyId one = stage.skittles[0], two = stage.skittles[1], three = stage.skittles[2];
};

TEST(NoteStep, TouchesAreTheFirstOnesOfBallsAndSkittles) {
  Still still;
  still.meet(still.hand, still.lane);
  still.meet(still.one, still.lane, false);
  still.meet(still.lane, still.ball, false);
  EXPECT_THAT(still.note(), IsEmpty());
  still.meet(still.lane, still.ball);
  still.meet(still.one, still.lane);
  still.meet(still.ball, still.hand);
  EXPECT_THAT(still.note(), ElementsAre(kind::ball_touch, kind::touch, kind::hand_touch));
}

TEST(NoteStep, ASkittleKeepsItsCauseAgainstOneThatFollows) {
  Still still;
  still.game.moved_by[still.one] = By::ball;
  still.game.moved_by[still.two] = By::hand;
  still.meet(still.one, still.two);
  still.note();
  EXPECT_EQ(still.game.moved_by[still.one], By::ball);
  EXPECT_EQ(still.game.moved_by[still.two], By::hand);
  // One in the hand is the hand's, and so is what it meets, also as it meets a ball near its spot.
  engine::set_kind(still.world, still.two, engine::Kind::driven);
  still.meet(still.two, still.one);
  still.meet(still.two, still.ball);
  still.note();
  EXPECT_EQ(still.game.moved_by[still.one], By::hand);
  EXPECT_EQ(still.game.moved_by[still.two], By::hand);
}

TEST(NoteStep, ASkittleThatIsDownKeepsItsCauseInTheHand) {
  Still still;
  still.game.down[still.one] = 1;
  still.game.moved_by[still.one] = By::ball;
  still.game.swept[still.two] = 1;
  still.game.moved_by[still.two] = By::stray_ball;
  for (const engine::BodyId skittle : {still.one, still.two, still.three}) {
    engine::set_kind(still.world, skittle, engine::Kind::driven);
  }
  still.note();
  EXPECT_EQ(still.game.moved_by[still.one], By::ball);
  EXPECT_EQ(still.game.moved_by[still.two], By::stray_ball);
  EXPECT_EQ(still.game.moved_by[still.three], By::hand);
}

// Causes are noted for either of the two keys.
TEST(NoteStep, CausesAreNotedForTheHandAloneAndForStrayBallsAlone) {
  for (const bool hand_apart : {true, false}) {
    Scenario scenario = with_rules(GameKind::plain, 2, 2);
    scenario.game.hand_fells = hand_apart ? HandFells::apart : HandFells::counted;
    scenario.game.stray_fells = hand_apart ? StrayFells::counted : StrayFells::apart;
    Still still(scenario);
    still.game.stray[still.ball] = 1;
    still.meet(still.hand, still.one);
    still.meet(still.ball, still.two);
    const Quat lies = rotation(Vec3(1.5, 0.0, 0.0));
    for (const engine::BodyId skittle : {still.one, still.two}) {
      const Vec3 p_W = still.world.states[skittle].X_WB.p;
      engine::set_state(still.world, skittle, {{lies, p_W}, Vec3::Zero(), Vec3::Zero()});
    }
    still.note();
    EXPECT_EQ(still.game.moved_by[still.one], By::hand);
    std::vector<By> causes;
    for (const Event& e : still.noted) {
      if (e.kind == kind::skittle_down) causes.push_back(e.detail.value_or(By::nobody));
    }
    // Where the hand's skittles are the ball's, only a stray ball's fall names its cause.
    EXPECT_THAT(causes, ElementsAre(hand_apart ? By::hand : By::nobody, By::stray_ball));
  }
}

TEST(NoteStep, ABallIsStrayBesideTheLaneBetweenFoulLineAndHeadPin) {
  const Scenario scenario = with_rules(GameKind::plain, 2, 2);
  const double half = 0.5 * scenario.lane.width, head_pin = scenario.lane.head_pin;
  const double low = scenario.ball.radius;
  const auto stray = [&](const Vec3& p_W) {
    Still still;
    still.put(still.ball, p_W, {0.0, 3.0, 0.0});
    still.note();
    return still.game.stray[still.ball] == 1;
  };
  EXPECT_TRUE(stray({half + 1e-9, 1.0, low}));
  EXPECT_TRUE(stray({-half - 1e-9, 1.0, low}));
  EXPECT_FALSE(stray({half, 1.0, low})) << "on its edge";
  EXPECT_FALSE(stray({half + 0.1, 0.0, low})) << "on the approach";
  EXPECT_FALSE(stray({half + 0.1, head_pin, low})) << "beside the head pin";
}

TEST(NoteStep, ABallIsStrayThatComesBackFromBehindTheLastRow) {
  const RoomMeasures room = room_measures(with_rules(GameKind::plain, 2, 2));
  const double last_row = room.head_pin + room.spots.back().y();
  ASSERT_GT(last_row, room.head_pin);
  const auto stray = [&](double y, double v) {
    Still still;
    still.put(still.ball, {0.0, y, 0.11}, {0.0, v, 0.0});
    still.note();
    return still.game.stray[still.ball] == 1;
  };
  EXPECT_TRUE(stray(last_row + 1e-9, -1.0));
  EXPECT_FALSE(stray(last_row, -1.0)) << "on the last row";
  EXPECT_FALSE(stray(room.head_pin - 0.01, -1.0)) << "before the skittles";
  EXPECT_FALSE(stray(last_row + 0.1, 0.0)) << "at rest";
  EXPECT_FALSE(stray(last_row + 0.1, 1.0)) << "on its way ahead";
}

TEST(NoteStep, AFoulIsAReleaseBeyondTheLineNotOnItAndHasThePlace) {
  for (const double y : {kOnLine, 2.0 * kOnLine, 0.3}) {
    Released released;
    released.p_WB = Vec3(0.1, y, 0.2);
    Still still;
    still.let_go(released, {7.0, 7.0, 7.0});
    still.note();
    std::vector<const Event*> fouls;
    for (const Event& e : still.noted) {
      if (e.kind == kind::foul) fouls.push_back(&e);
    }
    ASSERT_EQ(fouls.size(), y > kOnLine ? 1u : 0u) << y;
    if (fouls.empty()) continue;
    EXPECT_EQ(fouls[0]->p_W, *released.p_WB);
    EXPECT_EQ(fouls[0]->value, y);
  }
}

// Place, velocity and spin of the release are its event's where it has all three; else the ball's at the tick.
TEST(NoteStep, APathBeginsAtTheReleaseAsItsEventTellsIt) {
  for (int told = 0; told < 8; ++told) {
    Released released;
    if (told & 1) released.p_WB = Vec3(0.2, -0.1, 0.3);
    if (told & 2) released.v_WB = Vec3(0.0, 7.0, 0.0);
    if (told & 4) released.w_WB = Vec3(-9.0, 0.0, 0.0);
    Still still;
    still.put(still.ball, {0.1, 0.1, 0.3}, {0.0, 5.0, 0.0});
    const engine::State now = still.world.states[still.ball];
    still.let_go(released);
    still.note();
    engine::State at = now;
    if (told == 7) at = {{now.X_WB.q, *released.p_WB}, *released.v_WB, *released.w_WB};
    EXPECT_EQ(still.path().release, delivered(still.stage.room, at)) << told;
  }
}

TEST(NoteStep, AnotherReleaseEndsTheWayOfTheBallBefore) {
  Still still;
  still.let_go();
  still.put(still.ball, {0.0, 0.5, 0.5});
  EXPECT_THAT(still.note(), ElementsAre(kind::release));
  still.let_go();
  still.put(still.ball, {0.2, 0.5, 0.5});
  EXPECT_THAT(still.note(), testing::Contains(kind::ball_path));
  ASSERT_TRUE(still.game.watched);
  EXPECT_EQ(still.path().release.board, board_at(still.stage.room, 0.2));
}

// Gravity takes a part of a tick's speed in the tick of the release, and all of it later: a ball near the
// lane that gains less is held up by it.
TEST(NoteStep, ABallNearTheLaneFallsForAPartOfTheTickOfItsRelease) {
  Still still;
  const double near = still.stage.scenario.ball.radius + 5e-4;
  const double gained = engine::step_seconds(still.world) * still.stage.scenario.collision.gravity;
  Released released;
  released.p_WB = Vec3(0.0, 0.5, near);
  released.v_WB = Vec3(0.0, 3.0, 0.0);
  released.w_WB = Vec3::Zero();
  still.put(still.ball, *released.p_WB, {0.0, 3.0, -0.5 * gained});
  still.let_go(released);
  still.note();
  EXPECT_FALSE(still.path().loft_end) << "it falls";
  still.put(still.ball, {0.0, 0.51, near}, {0.0, 3.0, -1.5 * gained});
  still.note();
  EXPECT_FALSE(still.path().loft_end) << "it falls";
  still.put(still.ball, {0.0, 0.52, near}, {0.0, 3.0, -1.5 * gained});
  still.note();
  EXPECT_TRUE(still.path().loft_end) << "it is held up";
}

/// A ball that was let go, on its way over the lane.
Still on_its_way() {
  Still still;
  still.put(still.ball, {0.0, 1.0, 0.2}, {0.0, 3.0, 0.0});
  still.let_go();
  still.note();
  return still;
}

TEST(NoteStep, ABallEntersWithTheSkittleThatItMeets) {
  for (const bool ball_first : {true, false}) {
    Still still = on_its_way();
    still.put(still.ball, {0.0, 5.0, 0.2}, {0.0, 2.0, 0.0});
    still.meet(still.one, still.two);
    still.meet(still.lane, still.ball);
    still.meet(still.ball, still.lane);
    still.note();
    EXPECT_FALSE(still.path().entry) << "skittles meet, and the ball meets the lane";
    ball_first ? still.meet(still.ball, still.one) : still.meet(still.one, still.ball);
    still.note();
    ASSERT_TRUE(still.path().entry);
    EXPECT_EQ(still.path().entry->speed, 2.0);
    still.put(still.ball, {0.0, 5.1, 0.2}, {0.0, 1.0, 0.0});
    still.note();
    still.meet(still.ball, still.two);
    still.note();
    EXPECT_EQ(still.path().entry->speed, 2.0) << "a later skittle is none to enter with";
  }
}

// Between two pins: it passes the head pin's spot, which counts until it meets a skittle behind.
TEST(NoteStep, ABallThatPassedTheHeadPinEntersWithItsFirstSkittleAllTheSame) {
  for (const bool ball_first : {true, false}) {
    Still still = on_its_way();
    still.put(still.ball, {0.2, still.stage.room.head_pin + 0.1, 0.2}, {0.0, 2.0, 0.0});
    still.note();
    ASSERT_TRUE(still.path().entry);
    EXPECT_EQ(still.path().entry->speed, 3.0);
    still.meet(still.one, still.two);
    still.note();
    EXPECT_EQ(still.path().entry->speed, 3.0);
    ball_first ? still.meet(still.ball, still.two) : still.meet(still.two, still.ball);
    still.note();
    EXPECT_EQ(still.path().entry->speed, 2.0);
  }
}

TEST(NoteStep, ABallHasRingsOfTheLaneThatItTouchesBeforeTheSkittles) {
  Scenario scenario = with_rules(GameKind::plain, 2, 2);
  scenario.ball.rings = true;
  const auto rings = [&](double z, bool enters) {
    Still still(scenario);
    still.let_go();
    still.put(still.ball, {0.0, 1.0, 0.5});
    still.note();
    if (enters) still.meet(still.ball, still.one);
    still.note();
    for (int i = 0; i < 300; ++i) {  // five revolutions on one spot
      engine::set_state(still.world, still.ball,
                        {{rotation(Vec3(-0.1 * i, 0.0, 0.0)), Vec3(0.0, 1.0, z)},
                         Vec3(0.0, 1.0, 0.0),
                         Vec3(-24.0, 0.0, 0.0)});
      still.note();
    }
    return still.game.ringed->rings.size();
  };
  EXPECT_EQ(rings(scenario.ball.radius, false), 4u);
  EXPECT_EQ(rings(0.5, false), 0u) << "in the air";
  EXPECT_EQ(rings(scenario.ball.radius, true), 0u) << "among the skittles";
}

TEST(NoteStep, APathHasItsFlareInMillimetresAndTheBallsPlace) {
  Still still = on_its_way();
  still.game.watched->rings.flare = 0.0625;
  const auto path = ball_path_so_far(still.game, still.world, {});
  ASSERT_TRUE(path);
  EXPECT_EQ(path->p_W, Vec3(0.0, 1.0, 0.2));
  ASSERT_TRUE(path->detail.get_if<BallPath>());
  EXPECT_EQ(path->detail.get_if<BallPath>()->flare_mm, 62.5);
}

TEST(NoteStep, ASkittleIsOffItsSpotFurtherAwayThanTheScenarioSays) {
  Scenario scenario = with_rules(GameKind::plain, 2, 2);
  scenario.game.off_spot = 0.25;
  Still still(scenario);
  const Vec3 spot = still.stage.world.states[still.one].X_WB.p;
  ASSERT_EQ(spot.x(), 0.0);
  still.put(still.one, spot + Vec3(0.25, 0.0, 0.5));
  EXPECT_FALSE(is_off_spot(still.world, still.stage, still.one));
  still.put(still.one, spot + Vec3(0.2500001, 0.0, 0.0));
  EXPECT_TRUE(is_off_spot(still.world, still.stage, still.one));
}

}  // namespace
}  // namespace headpin::scene
