// Sources by their names, and what they say of themselves.

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/base/sources.h"
#include "devices/emulated/unit.h"
#include "devices/live/source.h"
#include "devices/log/event_log.h"
#include "devices/log/sample_messages.h"
#include "tests/support/folder.h"

namespace headpin::devices {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// A log of what a test publishes, and the source that plays it.
class PlayedLog {
 public:
  void add(std::int64_t us, const TrackerSample& sample) {
    std::vector<std::uint8_t> message;
    encode(sample, message);
    add(us, message);
  }
  void add(std::int64_t us, const std::vector<std::uint8_t>& message) {
    append({.number = number_++, .time = Time{us}, .channel = kTrackerChannel, .data = message},
           bytes_);
  }
  LiveSource& play() {
    spit(folder_ / "a.log", {bytes_.begin(), bytes_.end()});
    opened_ = *open_device("lcm:file://" + (folder_ / "a.log").string(), clocks_, {});
    EXPECT_EQ(opened_.recording, (folder_ / "a.log").string());
    return *opened_.source;
  }

 private:
  const std::filesystem::path folder_ = fresh_folder("played");
  std::vector<std::uint8_t> bytes_;
  std::int64_t number_ = 0;
  Clocks clocks_;
  OpenSource opened_;
};

TrackerSample at_station(std::int32_t station, std::int64_t us) {
  TrackerSample sample;
  sample.station = station;
  sample.device_time = Time{us};
  return sample;
}

void poll_at(LiveSource& source, std::int64_t us) {
  std::vector<Sample> samples;
  source.poll(Time{us}, samples);
}

TEST(LiveLcmStatus, TellsTheAgeAndTheDelayOfTheNewestSampleInMilliseconds) {
  PlayedLog log;
  log.add(0, at_station(2, 500'000));
  log.add(35'000, at_station(2, 510'000));  // 25 ms late
  LiveSource& source = log.play();
  poll_at(source, 1'000'000);
  EXPECT_EQ(source.status(Time{1'040'000}).line,
            "LCM 0 lost on the way, 0 dropped, station 2 40 ms old, came 0 ms late");
  EXPECT_EQ(source.status(Time{993'000}).line,
            "LCM 0 lost on the way, 0 dropped, station 2 7 ms ahead of the session's clock");
  poll_at(source, 1'035'000);
  EXPECT_THAT(source.status(Time{1'060'000}).line, HasSubstr("50 ms old, came 25 ms late"));
}

TEST(LiveLcmStatus, OfThisMomentASampleIsZeroMillisecondsOld) {
  PlayedLog log;
  log.add(0, at_station(1, 500'000));
  LiveSource& source = log.play();
  poll_at(source, 1'000'000);
  EXPECT_THAT(source.status(Time{1'000'000}).line, HasSubstr("station 1 0 ms old"));
}

TEST(LiveLcmStatus, CountsTheMessagesThatCannotBeUsedByTheirReasons) {
  PlayedLog log;
  log.add(0, at_station(1, 0));
  log.add(1, std::vector<std::uint8_t>(5));
  TrackerSample far = at_station(1, 2), foreign = at_station(1, 3);
  far.X_TS.p.x() = 1e9;
  foreign.frame = "W";
  for (int i = 0; i < 2; ++i) log.add(2, far);
  for (int i = 0; i < 4; ++i) log.add(3, foreign);
  LiveSource& source = log.play();
  for (const std::int64_t us : {0, 1000}) poll_at(source, us);
  const SourceStatus status = source.status(Time{1000});
  EXPECT_EQ(status.faults.at(0).count, 7);
  EXPECT_EQ(status.faults.at(0).what,
            "messages that cannot be used: 1 of another type or size than TRACKER's and MOUSE3D's, "
            "2 with impossible numbers, 4 in another frame than \"T\"");
  EXPECT_THAT(status.counts,
              testing::IsSupersetOf({std::pair<std::string, std::int64_t>{"undecodable", 1},
                                     {"implausible", 2},
                                     {"foreign", 4},
                                     {"dropped_samples", 0}}));
}

// In a log publishers have no address: one whose clock is a second behind is another one.
TEST(LiveLcmStatus, NamesTheStationsThatHaveMoreThanOnePublisher) {
  PlayedLog log;
  for (const std::int32_t station : {1, 2, 3}) log.add(0, at_station(station, 10'000'000));
  for (const std::int32_t station : {2, 3, 3}) log.add(0, at_station(station, 9'000'000));
  LiveSource& source = log.play();
  for (const std::int64_t us : {0, 1000}) poll_at(source, us);
  const SourceFault fault = source.status(Time{1000}).faults.at(1);
  EXPECT_EQ(fault.count, 3);
  EXPECT_EQ(fault.what,
            "right hand has more than one publisher: 1 samples left out; left hand has more than "
            "one publisher: 2 samples left out");
}

// The first of each kind at once, further ones every ten seconds.
TEST(FaultNewsTest, AreToldAtOnceAndThenEveryTenSeconds) {
  constexpr Time kOneSecond{1'000'000};
  FaultNews news;
  std::vector<SourceFault> faults = {{0, "a"}, {0, "b"}};
  EXPECT_THAT(news.take(faults, kOneSecond), ElementsAre());
  faults[1].count = 1;
  EXPECT_THAT(news.take(faults, kOneSecond + Time{1}), ElementsAre("b"));  // silence delays nothing
  EXPECT_THAT(news.take(faults, 5 * kOneSecond), ElementsAre());
  faults[0].count = 2;
  faults[1].count = 5;
  EXPECT_THAT(news.take(faults, 11 * kOneSecond), ElementsAre());
  EXPECT_THAT(news.take(faults, 11 * kOneSecond + Time{1}), ElementsAre("a", "b"));
  EXPECT_THAT(news.take(faults, 30 * kOneSecond), ElementsAre());  // the same
  faults[0].count = 3;
  EXPECT_THAT(news.take(faults, 30 * kOneSecond), ElementsAre("a"));
  faults[1].count = 6;
  EXPECT_THAT(news.take(faults, 31 * kOneSecond), ElementsAre());
  EXPECT_THAT(news.take_rest(faults), ElementsAre("b"));
}

TEST(LiveFastrakTest, WithoutAClockItsSamplesArriveWhenItIsPolled) {
  FastrakEmulatorOptions options;
  options.faults.noise = 0.0;
  options.receivers = 1;
  Feed feed;
  feed.motion = still_motion;
  EmulatedUnit unit(options, std::move(feed));
  PseudoTerminal terminal;
  Clocks clocks;
  const OpenSource opened = *open_device("fastrak:" + terminal.name(), clocks, {});
  EXPECT_TRUE(opened.has_stylus);
  EXPECT_EQ(opened.recording, "");
  opened.source->start();
  std::vector<Sample> samples;
  for (Time now{1000}; now < Time{60'000'000} && samples.size() < 100; now += Time{1000}) {
    const std::size_t before = samples.size();
    unit.step(now, terminal);
    opened.source->poll(now, samples);
    for (std::size_t i = before; i < samples.size(); ++i) {
      EXPECT_LE(arrival(samples[i]), now);
    }
  }
  ASSERT_GE(samples.size(), 100u);
  EXPECT_NEAR(std::get<TrackerSample>(samples.back()).X_TS.p.x(), 0.4, 1e-3);
  const SourceStatus status = opened.source->status({});
  EXPECT_THAT(status.line, HasSubstr("0 records missed"));
  EXPECT_EQ(status.trouble, "");
}

TEST(OpenDevice, TakesTheNamesOfDevicesAlone) {
  Clocks clocks;
  EXPECT_FALSE(open_device("trial.lcmlog", clocks, {}));
  EXPECT_FALSE(open_device("", clocks, {}));
  EXPECT_THAT(complaint([&] { open_device("fastrak:", clocks, {}); }),
              HasSubstr("fastrak: expected the name of a serial port or tcp:HOST:PORT"));
}

}  // namespace
}  // namespace headpin::devices
