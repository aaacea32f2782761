// The score of events that are written by hand: what a sheet marks, and what a throw's row has.

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>

#include "scene/play/game.h"
#include "scene/play/score.h"
#include "scene/record/events.h"
#include "scene/record/trial.h"
#include "scene/scenario/scenario.h"
#include "tests/scene/with_rules.h"

namespace headpin::scene {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::int64_t kTickRate = 240;  // half a second is 120 ticks

/// The events of a session, at ticks.
class Told {
 public:
  explicit Told(GameKind rules = GameKind::plain, int rack = 10) {
    at(0, kind::game, {}, rack, rules);
  }
  Told& at(std::int64_t tick, std::string_view kind, std::vector<std::string> bodies = {"ball"},
           double value = 0.0, Detail detail = {}) {
    Event e;
    e.time = tick_time(tick, kTickRate);
    e.tick = tick;
    e.kind = kind;
    e.bodies = std::move(bodies);
    e.value = value;
    e.detail = std::move(detail);
    events.push_back(std::move(e));
    return *this;
  }
  /// A ball that is let go beyond the foul line.
  Told& foul(std::int64_t tick) { return at(tick, kind::release).at(tick, kind::foul); }
  Told& counted(std::int64_t tick, std::vector<std::string> skittles = {}) {
    const auto value = static_cast<double>(skittles.size());
    return at(tick, kind::delivery, std::move(skittles), value).at(tick, kind::ball_back);
  }
  std::vector<std::string> marks(HandFells fells = HandFells::apart) const {
    Scenario scenario;
    scenario.game.hand_fells = fells;
    return score(events, scenario).games.at(0).marks;
  }
  const ThrowRow& row() { return (rows = score(events).throws).at(0); }

  std::vector<Event> events;
  std::vector<ThrowRow> rows;
};

const std::string kFirst = "foul (frame 1 ball 1)", kSecond = "foul (frame 1 ball 2)";

TEST(ScoreOfEvents, HalfASecondBeginsAnewWithAThrowAfterOneThatWasTakenBackOrCounted) {
  Told back;
  back.foul(240).at(300, kind::grab).foul(400).at(480, kind::grab);
  EXPECT_THAT(back.marks(), IsEmpty());
  Told counted;
  counted.foul(240).counted(700).foul(800).at(860, kind::grab);
  EXPECT_THAT(counted.marks(), ElementsAre(kFirst));
  counted.at(930, kind::grab).foul(931).at(1100, kind::grab);
  EXPECT_THAT(counted.marks(), ElementsAre(kFirst, kSecond)) << "more than half a second";
}

TEST(ScoreOfEvents, HalfASecondIsThatOfTheFirstReleaseOfABallThatIsTakenAndLetGoInOneTick) {
  Told again;
  again.foul(240).at(300, kind::grab).at(300, kind::release).at(380, kind::grab);
  EXPECT_THAT(again.marks(), ElementsAre(kFirst));
  Told fair;
  fair.at(240, kind::release).at(300, kind::grab).at(300, kind::release);
  EXPECT_THAT(fair.marks(), IsEmpty()) << "nor is it a foul then";
}

// The foul that was taken back is none of the next throw, whose grab in the tick of its release shows it.
TEST(ScoreOfEvents, AThrowAfterAFoulThatWasTakenBackIsFair) {
  Told told;
  told.foul(240).at(300, kind::grab).at(400, kind::release);
  told.at(420, kind::grab).at(420, kind::release);
  EXPECT_THAT(told.marks(), IsEmpty());
}

TEST(ScoreOfEvents, AGrabBeforeTheFirstThrowTakesNothingBack) {
  Told told;
  told.at(200, kind::grab).at(200, kind::release).at(200, kind::foul).at(260, kind::grab);
  EXPECT_THAT(told.marks(), IsEmpty());
  Told long_after;
  long_after.at(10, kind::grab).foul(240).at(360, kind::grab);
  EXPECT_THAT(long_after.marks(), ElementsAre(kFirst));
}

TEST(ScoreOfEvents, NoThrowIsTakenBackWhileAnotherBallIsOnItsWay) {
  Told told;
  told.foul(240).at(250, kind::release, {"ball 2"}).at(260, kind::grab, {"ball 2"});
  EXPECT_THAT(told.marks(), ElementsAre(kFirst));
  told.at(270, kind::grab);
  EXPECT_THAT(told.marks(), IsEmpty()) << "both are in the hand again";
}

// As the game has it: it forgets then that a ball struck, unless the hand's skittles are the ball's.
TEST(ScoreOfEvents, AReleaseForgetsThatABallStruckWhereTheHandsSkittlesAreApart) {
  for (const HandFells fells : {HandFells::apart, HandFells::counted}) {
    Told told;
    told.foul(240).at(250, kind::first_contact).at(260, kind::release, {"ball 2"});
    told.at(270, kind::grab, {"ball 2"}).at(280, kind::grab);
    EXPECT_EQ(told.marks(fells).empty(), fells == HandFells::apart);
  }
}

TEST(ScoreOfEvents, ABallThatStruckIsForgottenOnceItIsCounted) {
  Told told;
  told.foul(240).at(250, kind::first_contact).counted(700).foul(800).at(810, kind::grab);
  EXPECT_THAT(told.marks(HandFells::counted), ElementsAre(kFirst));
}

// The first tick of all is a tick: half a second from it is counted by ticks, as from any other.
TEST(ScoreOfEvents, TheTickZeroIsSimulated) {
  for (const std::int64_t grab : {119, 120}) {
    Told told;
    told.foul(0).at(grab, kind::grab);
    for (Event& e : told.events) e.time = grab == 119 ? Time{} : Time{499'000};
    EXPECT_EQ(told.marks().empty(), grab == 119);
  }
}

TEST(ScoreOfEvents, AThrowHasTheTimeOfItsReleaseAndIsAFoulBeyondTheLineNotOnIt) {
  for (const double y : {-0.1, kOnLine, 2.0 * kOnLine}) {
    Released released;
    released.p_WB = Vec3(0.0, y, 0.2);
    Told told;
    told.at(250, kind::release, {"ball"}, 6.0, released);
    EXPECT_EQ(told.row().release, tick_time(250, kTickRate));
    EXPECT_EQ(told.row().foul, y > kOnLine) << y;
  }
}

TEST(ScoreOfEvents, AThrowHasThePathOfItsOwnBall) {
  BallPath own, other;
  own.gutter = 3.0;
  other.gutter = 4.0;
  Told told;
  told.at(240, kind::release).at(300, kind::ball_path, {"ball"}, 0.0, own);
  told.at(310, kind::ball_path, {"ball 2"}, 0.0, other).at(320, kind::ball_path, {}, 0.0, other);
  ASSERT_TRUE(told.row().path);
  EXPECT_EQ(told.row().path->gutter, own.gutter);
}

TEST(ScoreOfEvents, AThrowHasTheSkittlesThatItsBallTouchedBeforeItWasCounted) {
  Told told;
  told.at(240, kind::release);
  told.at(250, kind::first_contact, {"ball", "skittle 3"});
  told.at(251, kind::touch, {"skittle 3", "skittle 6"});
  told.at(252, kind::touch, {"skittle 5", "ball"}).at(253, kind::touch, {"ball", "skittle 3"});
  told.at(254, kind::hand_touch, {"ball", "skittle 7"}).at(255, kind::touch, {"skittle 8"});
  told.counted(700).at(701, kind::touch, {"ball", "skittle 9"});
  EXPECT_THAT(told.row().touched, ElementsAre(3, 5));
}

TEST(ScoreOfEvents, ALeaveIsTheRackWithoutWhatWasRemovedInItsFrame) {
  Told told(GameKind::plain, 4);
  const auto leave = [&] { return score(told.events).throws.back().leave; };
  told.at(240, kind::release).at(250, kind::touch, {"skittle 1", "skittle 2"}, 0.5);
  told.at(700, kind::dead_wood, {"skittle 4"}, 1.0).counted(700, {"skittle 2"});
  EXPECT_EQ(leave(), "1-3");
  // A foul that costs the ball: what it knocked down stands again.
  told.at(800, kind::release).at(1400, kind::delivery, {"skittle 1"}, 0.0);
  EXPECT_EQ(leave(), "1-3");
  told.at(1400, kind::frame, {}, 1.0).at(1500, kind::release).counted(2000, {"skittle 3"});
  EXPECT_EQ(leave(), "1-2-4");
  told.at(2100, kind::game, {}, 4.0, GameKind::plain).at(2200, kind::release).counted(2800);
  EXPECT_EQ(leave(), "1-2-3-4") << "another game";
}

TEST(ScoreOfEvents, AVelocityWithoutALevelPartHasNoDirection) {
  for (const double z : {-1.0, 0.0, 2.0}) EXPECT_EQ(degrees_from_y(Vec3(0.0, 0.0, z)), 0.0);
}

TEST(ScoreOfEvents, AnAngleStaysWithinHalfATurn) {
  for (const double speed : {0.1, 1.0, 3.0, 6.5}) {
    EXPECT_EQ(degrees_from_y(Vec3(0.0, -speed, 0.0)), 180.0);
    EXPECT_EQ(degrees_from_y(Vec3(-0.0, -speed, 0.0)), -180.0);
    EXPECT_EQ(degrees_from_y(Vec3(1e-17, -speed, 0.0)), 180.0);
    EXPECT_LE(degrees_from_y(Vec3(1e-15, -speed, 0.0)), 180.0);
  }
}

// The rules of a trial are those that it has; one without some of its keys is damaged.
TEST(ScoreOfEvents, OfATrialThatLacksAKeyIsByTheRulesOfToday) {
  TrialSummary trial;
  trial.events = Told().foul(240).at(300, kind::grab).events;
  trial.header.scenario = "[game]\nends = \"slow\"\n";
  EXPECT_THAT(score(trial).games.at(0).marks, IsEmpty());
}

// Of a stray ball: no ball has knocked it down, and the next one finds it.
TEST(ScoreOfEvents, ALeaveHasTheSkittlesThatAreSetUpAgainAtOnce) {
  Told told(GameKind::plain, 4);
  told.at(240, kind::release).at(700, kind::set_again, {"skittle 4"}, 1.0);
  told.counted(700, {"skittle 1"});
  EXPECT_EQ(told.row().leave, "2-3-4");
  const std::vector<TableColumn> columns = table_columns();
  const auto leave = std::ranges::find(columns, "leave", &TableColumn::name);
  ASSERT_NE(leave, columns.end());
  EXPECT_THAT(leave->meaning, testing::HasSubstr("set up again at once"));
}

// Of a damaged log, or of a guest who sends what he likes.
TEST(ScoreOfEvents, NumbersOfSkittlesThatCannotBeAreNone) {
  for (const double value : {2e9, 10'001.0, std::nan(""), -1.0, 2.5, 1e300}) {
    Told told(GameKind::plain, 4);
    told.events.front().value = value;
    told.at(240, kind::release).at(700, kind::dead_wood, {"skittle 4"}, value);
    told.at(700, kind::set_again, {"skittle 3"}, value);
    told.at(700, kind::delivery, {"skittle 1"}, value);
    const Score score = headpin::scene::score(told.events);
    ASSERT_EQ(score.games.size(), 1u);
    EXPECT_EQ(score.games[0].rack, 0) << value;
    EXPECT_THAT(score.games[0].frames, ElementsAre(ElementsAre(0)));
    EXPECT_THAT(score.games[0].marks,
                ElementsAre("0 by hand (frame 1 ball 1)", "0 by a stray ball (frame 1 ball 1)"));
    EXPECT_EQ(score.skittles_down, 0);
    EXPECT_EQ(score.felled_by_hand, 0);
    EXPECT_EQ(score.throws.at(0).counted, 0);
    EXPECT_EQ(score.throws.at(0).felled_by_hand, 0);
    EXPECT_EQ(score.throws.at(0).leave, "");
  }
  Event most;
  most.value = 10'000.0;
  EXPECT_EQ(skittles_in(most), 10'000);
}

// What the ball touched in the hand stood in the row of the throw before.
TEST(ScoreOfEvents, ABallThatIsTakenUpAgainTouchesNothingAsAThrow) {
  Told told;
  told.events.clear();  // without a game
  told.at(10, kind::release).at(100, kind::first_contact, {"ball", "skittle 1"}, 5.0);
  told.at(110, kind::touch, {"ball", "skittle 2"}).at(300, kind::grab, {"skittle 8"});
  told.at(305, kind::touch, {"ball", "skittle 3"}).at(310, kind::grab);
  told.at(320, kind::touch, {"ball", "skittle 5"}).at(400, kind::release, {"ball"}, 3.0);
  told.at(500, kind::first_contact, {"ball", "skittle 1"}, 2.0);
  told.at(510, kind::touch, {"skittle 6", "ball"}).at(520, kind::skittle_down, {"skittle 6"});
  const std::vector<ThrowRow> throws = score(told.events).throws;
  ASSERT_EQ(throws.size(), 2u);
  EXPECT_THAT(throws[0].touched, ElementsAre(1, 2, 3));
  EXPECT_THAT(throws[1].touched, ElementsAre(1, 6));
  EXPECT_EQ(throws[1].entry_speed, 2.0);
  EXPECT_EQ(throws[0].felled_by_ball, 0);
  EXPECT_EQ(throws[1].felled_by_ball, 1);
}

// Where the hand's skittles are the ball's, its strike is a first contact: it became the entry of the throw before.
TEST(ScoreOfEvents, AStrikeOfABallInTheHandIsNoEntryOfTheThrowBefore) {
  for (const std::string taken : {"ball", "ball 2"}) {
    Told told;
    told.events.clear();  // without a game
    told.at(10, kind::release, {"ball"}, 6.0).at(300, kind::grab, {taken});
    told.at(320, kind::first_contact, {taken, "skittle 5"}, 1.0, FirstContact{Vec3(1.0, 0.0, 0.0)});
    told.at(400, kind::release, {taken}, 3.0);
    told.at(500, kind::first_contact, {"skittle 1", taken}, 2.0);
    const Score found = score(told.events);
    ASSERT_EQ(found.throws.size(), 2u);
    EXPECT_FALSE(found.throws[0].entry) << taken;
    EXPECT_FALSE(found.throws[0].entry_speed);
    EXPECT_FALSE(found.throws[0].entry_angle_deg);
    EXPECT_FALSE(found.impact_speed);
    EXPECT_EQ(found.throws[1].entry, tick_time(500, kTickRate)) << taken;
    EXPECT_EQ(found.throws[1].entry_speed, 2.0);
  }
}

// The ball of an earlier throw strikes after another one was thrown: it became the entry of the later throw.
TEST(ScoreOfEvents, EachOfTwoBallsOnTheirWayHasItsOwnEntry) {
  Told told;
  told.events.clear();  // without a game
  told.at(10, kind::release, {"ball"}, 6.0).at(50, kind::release, {"ball 2"}, 7.0);
  told.at(100, kind::first_contact, {"ball", "skittle 5"}, 4.0);
  told.at(110, kind::first_contact, {"ball 2", "skittle 1"}, 5.0);
  told.at(200, kind::grab, {"ball 2"}).at(210, kind::first_contact, {"ball 2", "skittle 3"}, 1.0);
  told.at(220, kind::release, {"ball"}, 3.0)
      .at(230, kind::first_contact, {"ball 2", "skittle 2"}, 2.0);
  const std::vector<ThrowRow> throws = score(told.events).throws;
  ASSERT_EQ(throws.size(), 3u);
  EXPECT_EQ(throws[0].entry_speed, 4.0);
  EXPECT_EQ(throws[1].entry_speed, 5.0);
  EXPECT_FALSE(throws[2].entry_speed);
}

// A thrown ball strikes what it touched in the hand, or in a throw before: the pair had touched.
TEST(ScoreOfEvents, APairThatTouchedBeforeAThrowIsCountedOnce) {
  Told told;
  const auto touches = [&] { return score(told.events).touches; };
  told.at(10, kind::touch, {"ball", "skittle 1"}).at(20, kind::release);
  told.at(30, kind::first_contact, {"skittle 1", "ball"});
  EXPECT_EQ(touches(), 1);
  told.at(40, kind::grab).at(50, kind::release).at(60, kind::first_contact, {"ball", "skittle 1"});
  EXPECT_EQ(touches(), 1);
  told.at(70, kind::first_contact, {"ball 2", "skittle 1"});
  told.at(71, kind::first_contact, {"ball", "skittle 2"});
  told.at(72, kind::touch, {"skittle 1", "skittle 2"});
  EXPECT_EQ(touches(), 4) << "other pairs";
  // Bodies that are set up again meet anew.
  told.at(80, kind::ball_back).at(90, kind::first_contact, {"ball", "skittle 1"});
  EXPECT_EQ(touches(), 5);
  told.at(95, kind::first_contact, {"ball 2", "skittle 1"});
  EXPECT_EQ(touches(), 5) << "the other ball was not set up";
  told.counted(100).at(110, kind::first_contact, {"ball 2", "skittle 1"});
  EXPECT_EQ(touches(), 6);
  told.at(120, kind::version, {}).at(130, kind::first_contact, {"ball 2", "skittle 1"});
  EXPECT_EQ(touches(), 7);
}

}  // namespace
}  // namespace headpin::scene
