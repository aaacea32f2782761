// Ticks of a session around the touch of a button, and the loop and the pace that make them.

#include <gmock/gmock.h>

#include "devices/base/sources.h"
#include "scene/play/run.h"
#include "scene/play/session.h"
#include "scene/record/events.h"
#include "tests/scene/session_fixture.h"
#include "tests/scene/with_rules.h"

namespace headpin::scene {
namespace {

using testing::ElementsAre;

/// A game with two buttons and one skittle. The red one is where the hand waits at the ball.
Scenario red_at_the_ball() {
  Scenario scenario = with_rules(GameKind::plain, 1, 1);
  scenario.rack.spots.resize(1);
  scenario.version.buttons = true;
  scenario.version.radius = 0.02;
  scenario.version.red.button = scenario.ball.home - scenario.hand.grip;
  return scenario;
}

/// Advances until an event of a kind came `times` times.
/// @return  all events up to then
std::vector<Event> advance_to(Session& session, devices::Source& source, std::string_view kind,
                              int times, double longest_s = 1.5) {
  std::vector<Event> events;
  while (times > 0 && seconds(session.now()) < longest_s) {
    advance(session, source);
    for (const Event& e : session.events) {
      events.push_back(e);
      if (e.kind == kind) --times;
    }
  }
  EXPECT_EQ(times, 0) << kind;
  return events;
}

std::vector<Event> of_this(const std::vector<Event>& events, std::string_view kind) {
  std::vector<Event> found;
  for (const Event& e : events) {
    if (e.kind == kind) found.push_back(e);
  }
  return found;
}

TEST(SessionTicks, AVersionHasThePlaceOfItsButton) {
  Scenario scenario = red_at_the_ball();
  scenario.version.blue.button = Vec3(0.0, -1.4, 0.25) - scenario.hand.grip;  // on the hand's way
  Session session = make_session(scenario);
  devices::ReplaySource source(test::straight_throw(scenario));
  const auto events = advance_to(session, source, kind::version, 2);
  const auto versions = of_this(events, kind::version);
  ASSERT_EQ(versions.size(), 2u);
  EXPECT_EQ(versions[0].p_W, scenario.version.red.button);
  EXPECT_EQ(versions[1].p_W, scenario.version.blue.button);
  // The ball in the hand was the first version's: the second one's is on its stand.
  EXPECT_EQ(of_this(events, kind::grab).size(), 1u);
  EXPECT_FALSE(session.player.held);
  EXPECT_EQ(session.world.states[session.stage->balls.front()].X_WB.p, scenario.ball.home);
}

// What was let go leaves with its version: nothing of the new one still touches the hand.
TEST(SessionTicks, NothingLeavesTheHandWhereAVersionBegins) {
  Scenario scenario = red_at_the_ball();
  const auto samples = test::straight_throw(scenario);
  int while_leaving = 0;
  for (double ahead = 0.0; ahead < 0.15; ahead += 0.02) {
    scenario.version.blue.button = Vec3(0.0, ahead, 0.25) - scenario.hand.grip;
    Session session = make_session(scenario);
    devices::ReplaySource source(samples);
    bool leaving = false;
    while (session.version != 2 && seconds(session.now()) < 1.0) {
      leaving = session.player.leaving.has_value();
      advance(session, source);
      leaving |= !of_this(session.events, kind::release).empty();
    }
    if (session.version != 2 || !leaving) continue;
    ++while_leaving;
    EXPECT_FALSE(session.player.leaving) << ahead;
  }
  EXPECT_GT(while_leaving, 0);
}

// A grab is no ball on its way: nothing is played ahead for it.
TEST(SessionTicks, AGrabAtTheFirstButtonBeginsOneGame) {
  const Scenario scenario = red_at_the_ball();
  auto samples = test::straight_throw(scenario);
  samples.insert(samples.begin(), devices::MouseSample{.device_time = Time{}, .trigger = true});
  Session session = make_session(scenario);
  devices::ReplaySource source(samples);
  const auto events = advance_to(session, source, kind::version, 1);
  ASSERT_EQ(of_this(events, kind::grab).size(), 1u);
  EXPECT_EQ(of_this(events, kind::grab)[0].tick, of_this(events, kind::version)[0].tick);
  EXPECT_EQ(of_this(events, kind::game).size(), 1u);
  EXPECT_EQ(events.front().kind, kind::grab);
  EXPECT_LT(of_this(events, kind::version)[0].tick, 3);
}

// The ball slows down on the lane; who touches a button then knows no other speed of its entry.
TEST(SessionTicks, ABallThatIsCountedAheadMeetsItsSkittleAtTheSameSpeed) {
  std::vector<double> speeds;
  for (const bool early : {true, false}) {
    Scenario scenario = red_at_the_ball();
    scenario.hand.solid = false;
    if (early) scenario.version.blue.button = Vec3(0.0, 0.12, 0.25) - scenario.hand.grip;
    Session session = make_session(scenario);
    devices::ReplaySource source(test::straight_throw(scenario));
    const auto events = advance_to(session, source, kind::first_contact, 1, 3.0);
    ASSERT_EQ(of_this(events, kind::first_contact).size(), 1u);
    EXPECT_EQ(of_this(events, kind::version).size(), early ? 2u : 1u);
    speeds.push_back(of_this(events, kind::first_contact)[0].value);
    EXPECT_LT(speeds.back(), of_this(events, kind::release)[0].value - 0.1);
  }
  EXPECT_EQ(speeds[0], speeds[1]);
}

TEST(SessionTicks, StatisticsAreTheSumOfAllSteps) {
  const Scenario scenario = red_at_the_ball();
  Session session = make_session(scenario);
  devices::ReplaySource source(test::straight_throw(scenario));
  std::int64_t contacts = 0;
  while (session.tick < 240) {
    advance(session, source);
    contacts += session.world.statistics.contacts;
  }
  EXPECT_EQ(session.statistics.steps, 240);
  EXPECT_GT(contacts, 0);
  EXPECT_EQ(session.statistics.contacts, contacts);
}

TEST(SessionTicks, AHeadHasAPoseAtATimeOnceItWasSeen) {
  Session session = make_session(red_at_the_ball());
  EXPECT_FALSE(head_pose(session, session.now()));
  devices::TrackerSample head;
  head.station = devices::kHeadStation;
  head.X_TS.p = Vec3(1.0, 2.0, 1.7);
  devices::ReplaySource source({head});
  advance(session, source);
  ASSERT_TRUE(head_pose(session, session.now()));
  EXPECT_EQ(head_pose(session, session.now())->p, head.X_TS.p);
}

/// What the loop does, in its order: a tick is waited for before it is made.
struct Counting : Observer, Pace {
  void wait_for(Time tick) override { waited.push_back(tick); }
  void start(const Session& session) override { started.push_back(session.tick); }
  void tick(const Session& session) override {
    ticked.push_back(session.tick);
    EXPECT_EQ(waited.size(), ticked.size());
  }
  std::vector<Time> waited;
  std::vector<std::int64_t> started, ticked;
};

TEST(SessionTicks, AnObserverIsCalledBeforeTheFirstTickAndAfterEachThatIsWaitedFor) {
  Session session = make_session(red_at_the_ball());
  devices::ReplaySource source(std::vector<devices::Sample>{});
  Counting counting;
  Observer* const observers[] = {&counting};
  run(session, source, counting, observers, [](const Session& s) { return s.tick >= 3; });
  EXPECT_THAT(counting.started, ElementsAre(0));
  EXPECT_THAT(counting.ticked, ElementsAre(1, 2, 3));
  EXPECT_THAT(counting.waited,
              ElementsAre(tick_time(1, 240), tick_time(2, 240), tick_time(3, 240)));
}

TEST(SessionTicks, InRealTimeNoTickIsBeforeItIsDue) {
  RealTime pace;
  pace.begin(240);
  for (std::int64_t n = 1; n <= 5; ++n) {
    pace.wait_for(tick_time(n, 240));
    EXPECT_GE(pace.now(), tick_time(n, 240));
  }
}

// A tracker whose clock is ahead of the session's by less than a step of its grid: the session waits for
// it, at most by a hundredth of each tick.
TEST(SessionTicks, InRealTimeTicksFollowTheFirstClock) {
  RealTime pace;
  const RealTime::Clock::time_point idle = pace.at(Time{});
  pace.wait_for(Time{});
  EXPECT_EQ(pace.at(Time{}), idle) << "no clock leads";
  pace.begin(240);
  const devices::ClockId clock = pace.clocks().add();
  const RealTime::Clock::time_point begun = pace.at(Time{});
  pace.clocks().date({.clock = clock, .theirs = Time{1000}, .arrived_us = 13'000.0});
  for (int i = 0; i < 5; ++i) pace.wait_for(Time{});
  const auto longer = std::chrono::duration_cast<Time>(pace.at(Time{}) - begun);
  EXPECT_GT(longer, Time{});
  EXPECT_LE(longer, 5 * tick_time(1, 240) / 100);
}

}  // namespace
}  // namespace headpin::scene
