// An emulated unit at a pseudo-terminal, a driver at the other end, and a clock that the test turns.

#include <algorithm>
#include <array>
#include <filesystem>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/emulated/lcm_feed.h"
#include "devices/emulated/unit.h"
#include "devices/fastrak/driver.h"
#include "tests/support/folder.h"
#include "tests/support/samples_of_log.h"

namespace headpin::devices {
namespace {

using testing::HasSubstr;

constexpr Time kTick{1000};
constexpr Time kSecond{1'000'000};

FastrakEmulatorOptions exact_unit(int stylus = 0) {
  FastrakEmulatorOptions options;
  options.faults.noise = 0.0;
  options.receivers = 1;
  options.stylus = stylus;
  return options;
}

/// A recording of one second: the receiver moves ahead by a metre.
Feed ahead_by_a_metre() {
  Feed feed;
  feed.motion = [](int, Time t) {
    const double moved = std::min(seconds(t), 1.0);
    return FastrakTruth{{Quat::Identity(), Vec3(0.5 + moved, 0.0, 0.0)}};
  };
  feed.recorded = true;
  feed.length = kSecond;
  feed.first.station = 1;
  return feed;
}

/// A unit, its terminal, and a client of it.
struct AtTerminal {
  explicit AtTerminal(FastrakEmulatorOptions options, Feed feed,
                      std::unique_ptr<EmulatedMouse> mouse = nullptr)
      : unit(std::move(options), std::move(feed), std::move(mouse)) {
    connect();
  }
  void connect() {
    driver.reset();
    driver = std::make_unique<FastrakDriver>(open_serial(terminal.name(), 115200), clocks);
  }
  /// Samples of the next `span`, or until there are `enough`. The driver gives the first ones together.
  std::vector<TrackerSample> hear(Time span, std::size_t enough) {
    std::vector<Sample> heard;
    for (const Time end = now + span; now < end && heard.size() < enough;) {
      now += kTick;
      unit.step(now, terminal);
      driver->poll(now, heard);
    }
    std::vector<TrackerSample> samples;
    for (const Sample& sample : heard) samples.push_back(std::get<TrackerSample>(sample));
    return samples;
  }

  Time now{};
  PseudoTerminal terminal;
  Clocks clocks;
  EmulatedUnit unit;
  std::unique_ptr<FastrakDriver> driver;
};

// The motion stands still until a client starts the stream, however long it takes.
TEST(EmulatedUnitTest, ARecordingBeginsWhenAClientStartsTheStreamAndAgainForTheNext) {
  AtTerminal bench(exact_unit(), ahead_by_a_metre());
  for (int client = 0; client < 2; ++client) {
    const std::vector<TrackerSample> samples = bench.hear(60 * kSecond, 60);
    ASSERT_EQ(samples.size(), 60u) << client;
    // 60 records of 120 Hz are half a second; begin_of() may shift the begin by some cycles.
    EXPECT_NEAR(samples.front().X_TS.p.x(), 0.5, 0.1) << client;
    EXPECT_NEAR(samples.back().X_TS.p.x() - samples.front().X_TS.p.x(), 59.0 / 120.0, 0.1);
    bench.connect();
  }
}

TEST(EmulatedUnitTest, ARecordingRestsAtItsEndOrStartsAgain) {
  for (const bool loop : {false, true}) {
    Feed feed = ahead_by_a_metre();
    feed.loop = loop;
    AtTerminal bench(exact_unit(), std::move(feed));
    const std::vector<TrackerSample> samples = bench.hear(60 * kSecond, 180);  // 1.5 s
    ASSERT_EQ(samples.size(), 180u);
    if (loop) {
      EXPECT_NEAR(samples.back().X_TS.p.x(), 1.0, 0.15);
    } else {
      EXPECT_NEAR(samples.back().X_TS.p.x(), 1.5, 1e-6);
    }
  }
}

TEST(EmulatedUnitTest, RewindStartsTheRecordingAgain) {
  AtTerminal bench(exact_unit(), ahead_by_a_metre());
  EXPECT_NEAR(bench.hear(60 * kSecond, 180).back().X_TS.p.x(), 1.5, 1e-6);
  EXPECT_TRUE(bench.unit.obey("rewind", bench.now));
  EXPECT_LT(bench.hear(kSecond, 12).back().X_TS.p.x(), 0.8);
}

TEST(EmulatedUnitTest, PressAndReleaseMoveTheStylusSwitch) {
  Feed feed;
  feed.motion = still_motion;
  AtTerminal bench(exact_unit(1), std::move(feed));
  ASSERT_GE(bench.hear(60 * kSecond, 10).size(), 10u);
  for (const bool down : {true, false}) {
    EXPECT_TRUE(bench.unit.obey(down ? "press" : "release", bench.now));
    EXPECT_EQ((bench.hear(kSecond, 12).back().buttons & 1) != 0, down);
  }
}

/// A line whose client sends a megabyte at once.
class FloodedLine : public ByteStream {
 public:
  std::size_t read(std::span<std::uint8_t> out) override {
    const std::size_t n = std::min(out.size(), std::size_t{1'000'000} - heard);
    std::fill_n(out.begin(), n, std::uint8_t{'c'});
    heard += n;
    return n;
  }
  std::size_t write(Bytes bytes) override { return bytes.size(); }
  bool closed() const override { return false; }

  std::size_t heard = 0;
};

TEST(EmulatedUnitTest, AStepEndsHoweverMuchAClientSends) {
  Feed feed;
  feed.motion = still_motion;
  EmulatedUnit unit(exact_unit(), std::move(feed));
  FloodedLine line;
  unit.step(kTick, line);
  EXPECT_GE(line.heard, 1000u);  // more than a real line brings while a program is held up
  EXPECT_LE(line.heard, 10'000u);
  for (int i = 2; i < 1000; ++i) unit.step(i * kTick, line);
  EXPECT_EQ(line.heard, 1'000'000u);  // nothing is lost
}

/// A line whose client starts the stream and reads nothing, until another one takes its place.
class ReplacedLine : public ByteStream {
 public:
  std::size_t read(std::span<std::uint8_t> out) override {
    if (std::exchange(told, true)) return 0;
    out[0] = 'C';
    return 1;
  }
  std::size_t write(Bytes bytes) override {
    if (!reads) return 0;
    heard += bytes.size();
    return bytes.size();
  }
  bool renewed() override { return std::exchange(is_new, false); }
  bool closed() const override { return false; }

  bool told = false, reads = false, is_new = false;
  std::size_t heard = 0;
};

TEST(EmulatedUnitTest, WhatOneClientLeavesIsNotForTheNext) {
  for (const bool another : {false, true}) {
    Feed feed;
    feed.motion = still_motion;
    EmulatedUnit unit(exact_unit(), std::move(feed));
    ReplacedLine line;
    Time now{};
    while (now < 5 * kSecond) unit.step(now += kTick, line);
    line.reads = true;
    line.is_new = another;
    unit.step(now += kTick, line);
    if (another) {
      EXPECT_LT(line.heard, 100u);  // the record that is just sent
    } else {
      EXPECT_GT(line.heard, 1000u);  // that waited
    }
  }
}

TEST(EmulatedUnitTest, PowerCycleAndFaultsActAtOnce) {
  Feed feed;
  feed.motion = still_motion;
  AtTerminal bench(exact_unit(), std::move(feed));
  ASSERT_GE(bench.hear(60 * kSecond, 10).size(), 10u);
  EXPECT_TRUE(bench.unit.obey("faults dropout=1", bench.now));
  const std::int64_t lost = bench.unit.emulator().statistics().lost;
  bench.hear(kSecond / 10, 1000);
  EXPECT_GT(bench.unit.emulator().statistics().lost, lost);
  EXPECT_TRUE(bench.unit.obey("faults", bench.now));  // none any more
  EXPECT_GE(bench.hear(kSecond, 10).size(), 10u);
  EXPECT_TRUE(bench.unit.obey("power-cycle", bench.now));
  bench.hear(kSecond / 10, 1000);  // what was on the line
  EXPECT_TRUE(bench.hear(kSecond, 1).empty());
}

TEST(EmulatedUnitTest, SaysWhatItCannotObey) {
  Feed feed;
  feed.motion = still_motion;
  EmulatedUnit unit(exact_unit(), std::move(feed));
  const auto refusal = [&](const std::string& line) {
    return complaint([&] { unit.obey(line, Time{}); });
  };
  EXPECT_THROW(unit.obey("press", Time{}), NoSuchButton);
  EXPECT_THROW(unit.obey("left-thumb down", Time{}), NoSuchButton);
  EXPECT_EQ(refusal("dance"),
            "control line 'dance': expected power-cycle, press, release, left-thumb or right-thumb "
            "up or down, rewind, faults SPEC or quit");
  EXPECT_THAT(refusal("faults stuck"), HasSubstr("stuck"));
  EXPECT_EQ(refusal(""), "");
  EXPECT_TRUE(unit.obey("", Time{}));
  EXPECT_FALSE(unit.obey("quit", Time{}));
}

std::vector<MouseSample> mouse_in(const std::filesystem::path& log) {
  std::vector<MouseSample> all;
  for (const Sample& sample : test::samples_of(log.string())) {
    if (const auto* mouse = std::get_if<MouseSample>(&sample)) all.push_back(*mouse);
  }
  return all;
}

TEST(EmulatedUnitTest, ThumbsAndTriggerArePublishedWhenTheyMove) {
  const std::filesystem::path log = fresh_folder("unit") / "mouse.log";
  {
    Feed feed;
    feed.motion = still_motion;
    AtTerminal bench(exact_unit(), std::move(feed),
                     std::make_unique<EmulatedMouse>(LcmUrl("file://" + log.string() + "?mode=w"),
                                                     std::vector<MouseSample>{}));
    for (const char* line : {"left-thumb down", "press", "left-thumb up", "right-thumb down"}) {
      EXPECT_TRUE(bench.unit.obey(line, bench.now));
      bench.hear(10 * kTick, 1000);
    }
    EXPECT_THAT(complaint([&] { bench.unit.obey("left-thumb sideways", bench.now); }),
                HasSubstr("expected up or down"));
  }
  const std::vector<MouseSample> mouse = mouse_in(log);
  ASSERT_EQ(mouse.size(), 4u);
  const auto state = [](const MouseSample& m) {
    return std::array{m.left_thumb, m.right_thumb, m.trigger};
  };
  EXPECT_EQ(state(mouse[0]), (std::array{true, false, false}));
  EXPECT_EQ(state(mouse[1]), (std::array{true, false, true}));
  EXPECT_EQ(state(mouse[2]), (std::array{false, false, true}));
  EXPECT_EQ(state(mouse[3]), (std::array{false, true, true}));
}

// The trigger of a recording goes down at 0.3 s of it. Nothing is published before a client listens.
TEST(EmulatedUnitTest, ARecordedMouseGoesWithTheRecording) {
  const std::filesystem::path log = fresh_folder("unit") / "mouse.log";
  Time heard_from{};
  {
    MouseSample up, down;
    up.device_time = Time{};
    down.device_time = Time{300'000};
    down.trigger = true;
    AtTerminal bench(exact_unit(), ahead_by_a_metre(),
                     std::make_unique<EmulatedMouse>(LcmUrl("file://" + log.string() + "?mode=w"),
                                                     std::vector<MouseSample>{up, down}));
    ASSERT_EQ(bench.hear(60 * kSecond, 120).size(), 120u);
    heard_from = bench.unit.emulator().stream_zero();
    EXPECT_GT(heard_from, Time{});
  }
  const std::vector<MouseSample> mouse = mouse_in(log);
  ASSERT_GT(mouse.size(), 3u);
  for (const MouseSample& sample : mouse) {
    // By the clock of the records, whose zero is the first record of the stream.
    EXPECT_EQ(sample.trigger, sample.device_time >= mouse.front().device_time + Time{300'000});
    EXPECT_LT(sample.device_time, Time{2'000'000});
  }
}

TEST(LcmFeedTest, StationsRestUntilTheirSamplesCome) {
  const std::filesystem::path log = fresh_folder("feed") / "trackers.log";
  TrackerSample sample;
  sample.device_time = Time{1'000'000};
  sample.station = kHandStation;
  sample.X_TS = {Quat::Identity(), Vec3(1.0, 0.25, 0.5)};
  {
    LcmLink link("file://" + log.string() + "?mode=w");
    link.publish(Sample(sample));
    MouseSample mouse;
    mouse.device_time = Time{1'001'000};
    mouse.trigger = true;
    link.publish(Sample(mouse));
  }
  LcmFeed feed("file://" + log.string() + "?speed=0");
  EXPECT_EQ(feed.at(kHandStation).X_TS.p, still_motion(kHandStation, {}).X_TS.p);
  EXPECT_FALSE(feed.at(kHandStation).pressed);
  for (Time now{}; now < kSecond; now += kTick) EXPECT_TRUE(feed.poll(now).empty());
  EXPECT_EQ(feed.at(kHandStation).X_TS.p, sample.X_TS.p);
  EXPECT_TRUE(feed.at(kHandStation).pressed);
  EXPECT_EQ(feed.at(1).X_TS.p, still_motion(1, {}).X_TS.p);
}

// A publisher that sets no status leaves 0. It was sent as the error byte of a record.
TEST(LcmFeedTest, AStatusThatIsNoLetterIsAnError) {
  const std::filesystem::path log = fresh_folder("feed") / "status.log";
  {
    LcmLink link("file://" + log.string() + "?mode=w");
    TrackerSample sample;
    sample.device_time = Time{1'000'000};
    sample.station = kHandStation;
    sample.status = '\0';
    link.publish(Sample(sample));
  }
  LcmFeed feed("file://" + log.string() + "?speed=0");
  for (Time now{}; now < kSecond; now += kTick) feed.poll(now);
  EXPECT_EQ(feed.at(kHandStation).error, 'x');
  EXPECT_EQ(feed.at(1).error, ' ');
}

TEST(LcmFeedTest, TellsWhatItCannotUse) {
  const std::filesystem::path log = fresh_folder("feed") / "odd.log";
  {
    LcmLink link("file://" + log.string() + "?mode=w");
    TrackerSample sample;
    sample.X_TS.p.x() = std::numeric_limits<double>::quiet_NaN();
    link.publish(Sample(sample));
  }
  LcmFeed feed("file://" + log.string() + "?speed=0");
  const std::vector<std::string> faults = feed.poll(kTick);
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_THAT(faults[0], HasSubstr("1 with impossible numbers"));
  EXPECT_TRUE(feed.poll(2 * kTick).empty());
}

TEST(EmulatedUnitTest, TheControlLineOfFaultsIsAWordOfItsOwn) {
  EmulatedUnit unit(exact_unit(), ahead_by_a_metre());
  for (const char* line :
       {"faults", "faults ", "faults   ", "faults   noise=2 ", "faults noise=2"}) {
    EXPECT_TRUE(unit.obey(line, Time{})) << line;
  }
  for (const char* line : {"faultsnoise=3", "faultless"}) {
    EXPECT_THAT(complaint([&] { unit.obey(line, Time{}); }),
                HasSubstr("control line '" + std::string(line) + "': expected power-cycle"));
  }
}

// A unit has four stations. Bit 0 of the buttons is the switch.
TEST(LcmFeedTest, OfFourStationsTakesThePosesAndTheSwitch) {
  const std::filesystem::path log = fresh_folder("feed") / "stations.log";
  {
    LcmLink link("file://" + log.string() + "?mode=w");
    for (const std::int32_t station : {1, 2, 4, 0, 5, 1'000'000, -1'000'000}) {
      TrackerSample sample;
      sample.device_time = Time{1'000'000};
      sample.station = station;
      sample.X_TS.p.x() = 10.0 + station;
      sample.buttons = station == 4 ? 3 : station == 2 ? 2 : 0;
      link.publish(Sample(sample));
    }
  }
  LcmFeed feed("file://" + log.string() + "?speed=0");
  feed.poll(kTick);
  for (const int station : {1, 2, 4}) {
    EXPECT_EQ(feed.at(station).X_TS.p.x(), 10.0 + station);
    EXPECT_EQ(feed.at(station).pressed, station == 4) << station;
  }
  EXPECT_EQ(feed.at(3).X_TS.p, still_motion(3, {}).X_TS.p);
}

}  // namespace
}  // namespace headpin::devices
