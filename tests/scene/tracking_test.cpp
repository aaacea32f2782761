// Head and hand that are not seen for a while.

#include "scene/play/tracking.h"

#include <functional>

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

std::vector<Event> events_of(std::vector<devices::Sample> all) {
  Session session = make_session(Scenario{});
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

}  // namespace
}  // namespace headpin::scene
