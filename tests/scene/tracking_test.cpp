// Head and hand that are not seen for a while.

#include "scene/play/tracking.h"

#include <functional>
#include <numbers>

#include <gtest/gtest.h>

#include "devices/base/sources.h"
#include "scene/play/session.h"
#include "scene/record/events.h"

namespace headpin::scene {
namespace {

/// Head and hand at 60 Hz each for 3 s; `change` may spoil a sample or say that it is not sent.
std::vector<devices::Sample> samples(const std::function<bool(devices::TrackerSample&)>& change) {
  std::vector<devices::Sample> all;
  for (int i = 0; i < 360; ++i) {
    devices::TrackerSample sample;
    sample.device_time = tick_time(i, 120);
    sample.sequence = i / 2;
    sample.station = i % 2 == 0 ? devices::kHeadStation : devices::kHandStation;
    sample.X_TS.p = Vec3(i % 2 == 0 ? 0.0 : 0.3, -1.0, 1.5);
    if (change(sample)) all.emplace_back(sample);
  }
  return all;
}

std::vector<Event> events_of(std::vector<devices::Sample> all, const Scenario& scenario = {}) {
  Session session = make_session(scenario);
  devices::ReplaySource source(std::move(all));
  std::vector<Event> events;
  while (session.now() < Time{2'900'000}) {
    advance(session, source);
    for (const Event& event : session.events) {
      if (event.kind == kind::tracking_lost || event.kind == kind::tracking_back) {
        events.push_back(event);
      }
    }
  }
  return events;
}

bool within(const devices::TrackerSample& sample, double from_s, double to_s) {
  const double t = seconds(sample.device_time);
  return from_s < t && t < to_s;
}

TEST(Tracking, OfAReceiverThatIsPulledOutIsLostAndBack) {
  const auto events = events_of(samples([](devices::TrackerSample& sample) {
    return sample.station != devices::kHandStation || !within(sample, 1.0, 1.6);
  }));
  ASSERT_EQ(events.size(), 2u);
  EXPECT_EQ(events[0].kind, kind::tracking_lost);
  EXPECT_EQ(events[0].detail.text(), "hand");
  EXPECT_GT(events[0].value, 0.25);
  EXPECT_LT(events[0].value, 0.26);
  EXPECT_EQ(events[1].kind, kind::tracking_back);
  EXPECT_EQ(events[1].detail.text(), "hand");
  // The hand's samples are half a period behind the head's: 0.992 s is the last, 1.608 s the next.
  EXPECT_NEAR(events[1].value, 0.6167, 1e-4);
  const double delay_s = static_cast<double>(Scenario{}.rig.delay_s);
  EXPECT_NEAR(seconds(events[0].time), 0.9917 + 0.25 + delay_s, 0.01);
  EXPECT_NEAR(seconds(events[1].time), 1.6083 + delay_s, 0.01);
}

TEST(Tracking, OfAHeadOutOfReachIsLost) {
  const auto events = events_of(samples([](devices::TrackerSample& sample) {
    if (sample.station == devices::kHeadStation && within(sample, 2.0, 9.0)) {
      sample.status = 'I';
    }
    return true;
  }));
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].kind, kind::tracking_lost);
  EXPECT_EQ(events[0].detail.text(), "head");
}

TEST(Tracking, IsNotLostInAShortHoleAndBeforeTheFirstSample) {
  const auto events = events_of(samples([](devices::TrackerSample& sample) {
    return sample.station == devices::kHandStation ? within(sample, 1.5, 9.0)
                                                   : !within(sample, 1.0, 1.23);
  }));
  EXPECT_TRUE(events.empty());
}

/// The hand's positions are estimated, and wrong, from 1.0 to 1.6 s.
bool estimates_hand(devices::TrackerSample& sample) {
  sample.position_estimated = sample.station == devices::kHandStation && within(sample, 1.0, 1.6);
  if (sample.position_estimated) sample.X_TS.p = Vec3(0.0, 5.0, 0.5);
  return true;
}

/// X_WH, or nothing, after a time.
std::optional<Pose> hand_after(const Scenario& scenario, Time time) {
  Session session = make_session(scenario);
  devices::ReplaySource source(samples(estimates_hand));
  while (session.now() < time) advance(session, source);
  return hand_pose(session);
}

TEST(Tracking, OfAHandWhosePlaceIsEstimatedIsLost) {
  const auto events = events_of(samples(estimates_hand));
  ASSERT_EQ(events.size(), 2u);
  EXPECT_EQ(events[0].kind, kind::tracking_lost);
  EXPECT_NEAR(events[1].value, 0.6167, 1e-4);
  const std::optional<Pose> X_WH = hand_after(Scenario{}, Time{1'550'000});
  ASSERT_TRUE(X_WH);  // it stays
  EXPECT_NEAR((X_WH->p - hand_after(Scenario{}, Time{900'000})->p).norm(), 0.0, 1e-12);
}

TEST(Tracking, OfAHandMayBeAwayAfterAShorterTime) {
  Scenario scenario;
  scenario.rig.away_after_s = 0.1;
  const auto events = events_of(samples(estimates_hand), scenario);
  ASSERT_EQ(events.size(), 2u);
  EXPECT_GT(events[0].value, 0.1);
  EXPECT_LT(events[0].value, 0.105);
  const Time last{991'667}, delay = microseconds(scenario.rig.delay_s);
  EXPECT_TRUE(hand_after(scenario, last + delay + Time{95'000}));
  EXPECT_FALSE(hand_after(scenario, last + delay + Time{110'000}));
  EXPECT_TRUE(hand_after(scenario, Time{1'608'334} + delay + Time{10'000}));
}

// The player walks to where the hand, if it were there, would touch the button.
TEST(Tracking, OfAHandThatIsAwayBeginsNoVersion) {
  Scenario scenario;
  scenario.version.buttons = true;
  scenario.version.red.button = Vec3(0.3, 0.0, 1.5);
  for (const double away_after_s : {0.0, 0.1}) {
    scenario.rig.away_after_s = away_after_s;
    std::vector<devices::Sample> all = samples([&](devices::TrackerSample& sample) {
      sample.X_TS.q = Quat(Eigen::AngleAxisd(0.5 * std::numbers::pi, Vec3::UnitX()));  // ahead
      return sample.station == devices::kHeadStation || !within(sample, 0.5, 2.9);
    });
    all.emplace_back(devices::MouseSample{.device_time = Time{1'000'000}, .left_thumb = true});
    Session session = make_session(scenario);
    devices::ReplaySource source(std::move(all));
    while (session.now() < Time{2'800'000}) advance(session, source);
    ASSERT_GT(session.player.walk.p_WP.y(), 1.1);
    EXPECT_EQ(session.version_begun, away_after_s == 0.0);
  }
}

TEST(Tracking, OfAHandThatIsAwayTakesNothingAndKeepsWhatItHolds) {
  Scenario scenario;
  scenario.rig.away_after_s = 0.1;
  const Vec3 home = scenario.ball.home - scenario.hand.grip;
  const auto play = [&](double pressed_s) {
    std::vector<devices::Sample> all = samples([&](devices::TrackerSample& sample) {
      sample.position_estimated =
          sample.station == devices::kHandStation && within(sample, 1.0, 1.6);
      if (sample.station == devices::kHandStation) sample.X_TS.p = home;
      return true;
    });
    all.emplace_back(devices::MouseSample{.device_time = microseconds(pressed_s), .trigger = true});
    Session session = make_session(scenario);
    devices::ReplaySource source(std::move(all));
    while (session.now() < Time{1'550'000}) advance(session, source);
    return session;
  };
  EXPECT_FALSE(play(1.3).player.held);
  const Session held = play(0.5);
  ASSERT_TRUE(held.player.held);
  EXPECT_FALSE(hand_pose(held));
  EXPECT_NEAR((held.world.states[held.player.held->body].X_WB.p - scenario.ball.home).norm(), 0.0,
              0.01);
}

}  // namespace
}  // namespace headpin::scene
