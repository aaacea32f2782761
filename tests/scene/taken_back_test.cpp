// A ball that is in the hand again soon: referee and score sheet say the same of its foul.

#include <algorithm>

#include <gmock/gmock.h>

#include "devices/base/sources.h"
#include "scene/play/score.h"
#include "scene/play/session.h"
#include "scene/record/events.h"
#include "scene/record/trial.h"
#include "tests/scene/with_rules.h"

namespace headpin::scene {
namespace {

const std::string kFoul = "foul (frame 1 ball 1)";

Scenario with_fouls(BallEnds ends) {
  Scenario scenario = with_rules(GameKind::plain, 2, 2);
  scenario.game.foul = FoulBall::zero;
  scenario.game.ends = ends;
  scenario.hand.release_at = ReleaseAt::trigger;
  scenario.hand.solid = false;
  scenario.collision.gravity = 0.0;  // what a still hand lets go stays where it is
  return scenario;
}

/// A hand that takes the ball, lets it go at 2 s beyond the foul line, and takes it again.
/// @param slips  when the trigger is down for 1 ms before
std::vector<devices::Sample> caught_at(const Scenario& scenario, Time again,
                                       const std::vector<Time>& slips = {}) {
  std::vector<devices::Sample> samples;
  for (int i = 0; i <= 300; ++i) {
    devices::TrackerSample hand;
    hand.device_time = tick_time(i, 60);
    hand.sequence = i;
    hand.station = devices::kHandStation;
    hand.X_TS.p = (i < 30 ? scenario.ball.home : Vec3(0.0, 0.3, 1.2)) - scenario.hand.grip;
    samples.emplace_back(hand);
  }
  const auto trigger = [&](Time time, bool down) {
    samples.emplace_back(devices::MouseSample{.device_time = time, .trigger = down});
  };
  trigger(Time{100'000}, true);
  trigger(Time{2'000'000}, false);
  for (const Time slip : slips) {
    trigger(slip, true);
    trigger(slip + Time{1000}, false);
  }
  trigger(again, true);
  return samples;
}

struct FoulVerdict {
  bool of_referee = false, on_sheet = false;
};

FoulVerdict verdict(const Scenario& scenario, Time again, const std::vector<Time>& slips = {}) {
  Session session = make_session(scenario);
  devices::ReplaySource source(caught_at(scenario, again, slips));
  std::vector<Event> events;
  while (session.now() < Time{4'500'000}) {
    advance(session, source);
    events.insert(events.end(), session.events.begin(), session.events.end());
  }
  const auto times = static_cast<std::ptrdiff_t>(slips.size());
  EXPECT_EQ(std::ranges::count(events, kind::foul, &Event::kind), 1 + times);
  // A ball that was counted is brought back before the hand closes again.
  EXPECT_GE(std::ranges::count(events, kind::grab, &Event::kind), 1 + times);
  const std::vector<std::string> marks = score(events, scenario).games.at(0).marks;
  return {session.game.fouls == std::vector<std::uint8_t>{1},
          std::ranges::count(marks, kFoul) == 1};
}

TEST(TakenBack, AFoulIsOnTheSheetExactlyWhereItCostsTheBall) {
  const Scenario scenario = with_fouls(BallEnds::rest);
  int fouls = 0, taken_back = 0;
  for (Time after{490'000}; after <= Time{510'000}; after += Time{1000}) {
    const FoulVerdict one = verdict(scenario, Time{2'000'000} + after);
    EXPECT_EQ(one.on_sheet, one.of_referee) << after.count() << " us after the release";
    ++(one.of_referee ? fouls : taken_back);
  }
  EXPECT_GT(fouls, 0);
  EXPECT_GT(taken_back, 0);
}

TEST(TakenBack, NoBallIsWhereBallsEndOnceTheyAreSlow) {
  const FoulVerdict one = verdict(with_fouls(BallEnds::slow), Time{2'200'000});
  EXPECT_TRUE(one.of_referee);
  EXPECT_TRUE(one.on_sheet);
}

// Caught 0.6 s after the first release, 0.3 s after the last.
TEST(TakenBack, NoBallIsThatIsLetGoAgainInTheSameTick) {
  const FoulVerdict one = verdict(with_fouls(BallEnds::rest), Time{2'600'000}, {Time{2'301'000}});
  EXPECT_TRUE(one.of_referee);
  EXPECT_TRUE(one.on_sheet);
}

std::vector<Event> foul_and_grab(std::int64_t grab_tick) {
  std::vector<Event> events(3);
  events[0].kind = kind::game;
  events[0].detail = Detail::read(kind::game, "plain");
  events[1].kind = kind::foul;
  events[1].tick = 240;
  events[1].time = tick_time(240, 240);
  events[2].kind = kind::grab;
  events[2].tick = grab_tick;
  events[2].time = tick_time(grab_tick, 240) - Time{3000};
  events[1].bodies = events[2].bodies = {"ball"};
  return events;
}

// The game decides at ticks, and the hand closes before one.
TEST(TakenBack, HalfASecondIsCountedFromTickToTick) {
  EXPECT_THAT(score(foul_and_grab(359)).games.at(0).marks, testing::IsEmpty());
  EXPECT_THAT(score(foul_and_grab(360)).games.at(0).marks, testing::ElementsAre(kFoul));
}

TEST(TakenBack, ATrialIsScoredByItsOwnScenario) {
  TrialSummary trial;
  trial.events = foul_and_grab(300);
  const auto marks = [&](BallEnds ends) {
    trial.header.scenario = to_toml(with_fouls(ends));
    return score(trial).games.at(0).marks;
  };
  EXPECT_THAT(marks(BallEnds::rest), testing::IsEmpty());
  EXPECT_THAT(marks(BallEnds::slow), testing::ElementsAre(kFoul));
  trial.header.scenario = "no scenario";
  EXPECT_THAT(score(trial).games.at(0).marks, testing::IsEmpty());
}

TEST(TakenBack, ASecondFoulBeforeTheBallIsCountedIsNoSecondMark) {
  std::vector<Event> events = foul_and_grab(400);
  events.push_back(events[1]);
  events.back().tick = 420;
  events.back().time = tick_time(420, 240);
  EXPECT_THAT(score(events).games.at(0).marks, testing::ElementsAre(kFoul));
}

TEST(TakenBack, AReleaseInTheTickOfTheGrabLeavesTheFoul) {
  for (const std::int64_t later : {0, 1}) {
    std::vector<Event> events = foul_and_grab(300);
    events.push_back(events.back());
    events.back().kind = kind::release;
    events.back().tick += later;
    const auto marks = score(events).games.at(0).marks;
    EXPECT_EQ(std::ranges::count(marks, kFoul), later == 0 ? 1 : 0) << later;
  }
}

}  // namespace
}  // namespace headpin::scene
