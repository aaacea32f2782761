#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <random>

#include <gtest/gtest.h>
#include <poll.h>

#include "devices/fastrak/driver.h"
#include "devices/fastrak/geometry.h"
#include "devices/fastrak/serving.h"
#include "tests/devices/fastrak_bench.h"

namespace headpin::devices {
namespace {

using namespace std::chrono_literals;
using test::Bench;
using test::Ends;
using test::kLess;
using test::memory;
using test::tracker;
using test::unit;

// A pseudo-terminal, its far end opened as a serial port.
Ends terminal() {
  auto pty = std::make_unique<PseudoTerminal>();
  auto port = open_serial(pty->name(), 115200);
  return {std::move(pty), std::move(port)};
}

// What a record of the unit says, computed apart from the driver.
Pose expected_pose(const FastrakRecord& r, const FastrakOptions& options) {
  const auto has = [&](int item) {
    return std::find(options.items.begin(), options.items.end(), item) != options.items.end();
  };
  Pose X;
  X.p = r.position * (options.centimetres ? 0.01 : 0.0254);
  if (has(11) || has(61)) {
    X.q = Quat(r.quaternion[0], r.quaternion[1], r.quaternion[2], r.quaternion[3]).normalized();
  } else if (has(4) || has(54)) {
    X.q = from_angles_deg(r.angles_deg).normalized();
  } else {
    X.q = Quat(r.attitude).normalized();
  }
  return X;
}

struct Tally {
  std::size_t missing = 0;        // good records that did not arrive
  std::size_t unmatched = 0;      // samples that are no record, in order
  std::size_t refused_bytes = 0;  // of damaged records that were not taken
};

// Walks both in order: every undamaged record must be the next sample; a damaged one may be.
Tally compare(const std::vector<FastrakSent>& sent, const std::vector<Sample>& samples,
              const FastrakOptions& options) {
  Tally tally;
  const FastrakFormat format{options.items, options.binary, options.centimetres};
  std::size_t next = 0;
  for (const FastrakSent& record : sent) {
    const auto decoded = decode_record(record.bytes, format);
    bool same = false;
    if (decoded && next < samples.size()) {
      const TrackerSample& s = tracker(samples[next]);
      const Pose X = expected_pose(*decoded, options);
      same = s.station == decoded->station && s.status == decoded->error && s.X_TS.p == X.p &&
             s.X_TS.q.coeffs() == X.q.coeffs() && s.buttons == (decoded->pressed ? 1 : 0);
    }
    if (same) {
      ++next;
    } else if (record.damaged) {
      tally.refused_bytes += record.bytes.size();
    } else {
      ++tally.missing;
    }
  }
  tally.unmatched = samples.size() - next;
  return tally;
}

struct Setting {
  std::vector<int> items;
  bool binary, centimetres;
};

std::vector<Setting> all_settings() {
  std::vector<Setting> settings;
  for (const auto& items : {std::vector<int>{2, 11, 16, 1},
                            {2, 4, 1},
                            {2, 11, 0},
                            {52, 61, 50},
                            {2, 5, 6, 7, 66, 51}}) {
    for (const bool binary : {false, true}) {
      for (const bool centimetres : {false, true}) settings.push_back({items, binary, centimetres});
    }
  }
  return settings;
}

const std::vector<std::string> kFaultSpecs = {"",
                                              "noise=20",
                                              "dropout=0.1",
                                              "garbage=0.2",
                                              "damage=0.1",
                                              "garbage=0.2,damage=0.1,dropout=0.1",
                                              "slow=9600",
                                              "metal=0.1",
                                              "stuck=1@2-4",
                                              "unplug=2@4",
                                              "deaf=2"};

void every_good_record_arrives_once(Ends (*line)(), Time span) {
  for (const Setting& setting : all_settings()) {
    for (const std::string& faults : kFaultSpecs) {
      SCOPED_TRACE(faults + (setting.binary ? " binary" : " ascii") +
                   (setting.centimetres ? " cm " : " in ") + testing::PrintToString(setting.items));
      FastrakOptions options;
      options.items = setting.items;
      options.binary = setting.binary;
      options.centimetres = setting.centimetres;
      options.start_up = 11s;
      Bench bench(unit(faults), options, line());
      ASSERT_TRUE(bench.run_until_streaming());
      bench.run(span);
      bench.emulator.set_faults(parse_faults("noise=0"));
      bench.emulator.receive(Bytes(reinterpret_cast<const std::uint8_t*>("c"), 1), bench.now);
      bench.run(1200ms);  // the last ones, and the decision on what is left

      const Tally tally = compare(bench.sent, bench.samples, options);
      EXPECT_EQ(tally.missing, 0u);
      EXPECT_EQ(tally.unmatched, 0u);
      const auto& s = bench.driver.statistics();
      EXPECT_EQ(static_cast<std::size_t>(s.skipped_bytes),
                static_cast<std::size_t>(bench.emulator.statistics().garbage_bytes) +
                    tally.refused_bytes);
      EXPECT_EQ(s.restarts, 0);
      EXPECT_GT(bench.samples.size(), 0u);
    }
  }
}

TEST(FastrakDriverTest, EveryGoodRecordArrivesOnceInOrderToTheLastBit) {
  every_good_record_arrives_once(memory, 20s / kLess);
}

TEST(FastrakDriverTest, SoItDoesOverAPseudoTerminal) {
  every_good_record_arrives_once(terminal, 2s / kLess);
}

TEST(FastrakDriverTest, AnHourOfStreamingLosesNothing) {
  FastrakOptions options;
  Bench bench(unit("garbage=0.02,damage=0.01,dropout=0.005", 4), options);
  ASSERT_TRUE(bench.run_until_streaming());
  for (int minute = 0; minute < 60 / kLess; ++minute) {
    bench.run(1min, Time{2000});
  }
  bench.emulator.receive(Bytes(reinterpret_cast<const std::uint8_t*>("c"), 1), bench.now);
  bench.run(400ms);
  const Tally tally = compare(bench.sent, bench.samples, options);
  EXPECT_EQ(tally.missing, 0u);
  EXPECT_EQ(tally.unmatched, 0u);
  const auto& s = bench.driver.statistics();
  EXPECT_EQ(
      static_cast<std::size_t>(s.skipped_bytes),
      static_cast<std::size_t>(bench.emulator.statistics().garbage_bytes) + tally.refused_bytes);
  EXPECT_GT(s.records, 425'000 / kLess);
  EXPECT_EQ(s.restarts, 0);
}

// Ten minutes of the wall clock, for those who ask for it (--gtest_also_run_disabled_tests).
TEST(FastrakDriverTest, DISABLED_TenMinutesInRealTimeOverAPseudoTerminal) {
  Bench bench(unit("garbage=0.02,damage=0.01,dropout=0.005"), {}, terminal());
  const auto start = std::chrono::steady_clock::now();
  while (bench.now < 10min) {
    pollfd state{bench.driver.descriptor(), POLLIN, 0};
    ::poll(&state, 1, 1);
    bench.now = std::chrono::duration_cast<Time>(std::chrono::steady_clock::now() - start);
    serve(bench.emulator, *bench.line, bench.now);
    bench.driver.poll(bench.now, bench.samples);
  }
  const auto& s = bench.driver.statistics();
  std::printf("%lld records, %lld skipped bytes, %lld missed cycles, %lld restarts\n",
              static_cast<long long>(s.records), static_cast<long long>(s.skipped_bytes),
              static_cast<long long>(s.missed), static_cast<long long>(s.restarts));
  bench.emulator.receive(Bytes(reinterpret_cast<const std::uint8_t*>("c"), 1), bench.now);
  bench.run(400ms);
  const Tally tally = compare(bench.sent, bench.samples, {});
  EXPECT_EQ(tally.missing, 0u);
  EXPECT_EQ(tally.unmatched, 0u);
  EXPECT_EQ(
      static_cast<std::size_t>(s.skipped_bytes),
      static_cast<std::size_t>(bench.emulator.statistics().garbage_bytes) + tally.refused_bytes);
  EXPECT_EQ(s.restarts, 0);
  EXPECT_GT(s.records, 70'000);
}

/// Holes in the numbers of the stations' samples.
std::int64_t holes_of(const std::vector<Sample>& samples) {
  std::array<std::int64_t, kFastrakStations> last{};
  last.fill(-1);
  std::int64_t holes = 0;
  for (const Sample& sample : samples) {
    const TrackerSample& s = tracker(sample);
    std::int64_t& previous = last[static_cast<std::size_t>(s.station - 1)];
    EXPECT_GT(s.sequence, previous);
    if (previous >= 0) holes += s.sequence - previous - 1;
    previous = s.sequence;
  }
  return holes;
}

TEST(FastrakDriverTest, AHoleInTheSequenceIsARecordThatWasLost) {
  Bench bench(unit("dropout=0.1", 2), {});
  ASSERT_TRUE(bench.run_until_streaming());
  bench.run(30s);
  EXPECT_GT(bench.emulator.statistics().lost, 200);
  EXPECT_NEAR(static_cast<double>(bench.driver.statistics().missed),
              static_cast<double>(bench.emulator.statistics().lost), 3.0);  // at both ends
  EXPECT_NEAR(static_cast<double>(holes_of(bench.samples)),
              static_cast<double>(bench.emulator.statistics().lost), 4.0);
}

TEST(FastrakDriverTest, NobodyAtTheOtherEndIsNoFailure) {
  auto [here, there] = memory_streams();
  Clocks clocks;
  FastrakDriver driver(std::move(here), clocks);
  std::vector<Sample> samples;
  for (Time now{}; now < 120s; now += 10ms) driver.poll(now, samples);
  EXPECT_TRUE(samples.empty());
  EXPECT_GT(driver.statistics().attempts, 10);
  EXPECT_FALSE(driver.exhausted());
  there.reset();
  EXPECT_TRUE(driver.exhausted());
}

TEST(FastrakDriverTest, AListThatCannotBeReadIsRefused) {
  const auto with = [](std::vector<int> items) {
    FastrakOptions options;
    options.items = std::move(items);
    Clocks clocks;
    FastrakDriver driver(std::move(memory_streams().first), clocks, options);
  };
  EXPECT_THROW(with({}), std::invalid_argument);
  EXPECT_THROW(with({2, 1}), std::invalid_argument);          // no orientation
  EXPECT_THROW(with({11, 1}), std::invalid_argument);         // no position
  EXPECT_THROW(with({2, 11}), std::invalid_argument);         // no end
  EXPECT_THROW(with({2, 11, 40, 1}), std::invalid_argument);  // no such item
  EXPECT_NO_THROW(with({2, 5, 6, 7, 0}));
}

TEST(FastrakDriverTest, AnyBytesFromTheLineLeaveItAlive) {
  std::mt19937 random(9);
  auto [here, there] = memory_streams();
  Clocks clocks;
  FastrakDriver driver(std::move(here), clocks);
  std::vector<Sample> samples;
  const std::string status = encode_status({}), on = encode_active(1, {true, true, false, false});
  const std::string list = encode_list(1, std::vector<int>{2, 11, 16, 1});
  for (Time now{}; now < 600s / kLess; now += 10ms) {
    std::string noise;
    switch (random() % 8) {
      case 0:
        noise = status;
        break;
      case 1:
        noise = on;
        break;
      case 2:
        noise = list;
        break;
      case 3:
        noise = "22O 21116 1\r\n";
        break;
      case 4:
        for (int i = 0; i < 50; ++i) noise += static_cast<char>(random());
        break;
      default:
        break;
    }
    there->write(Bytes(reinterpret_cast<const std::uint8_t*>(noise.data()), noise.size()));
    std::array<std::uint8_t, 256> said{};
    while (there->read(said) > 0) {
    }
    driver.poll(now, samples);
  }
  EXPECT_TRUE(samples.empty());
}

// --- Hemisphere ------------------------------------------------------------------------------

/// The head stays ahead of the transmitter; the hand begins there and circles all around it.
FastrakTruth around_the_transmitter(int station, Time time) {
  FastrakTruth truth = circling_motion(station, time);
  if (station == kHandStation) truth.X_TS.p.x() -= 0.4;
  return truth;
}

// The field of a dipole is the same at r and -r, so only a set hemisphere tells them apart.
TEST(FastrakDriverTest, APositionIsRightInTheHemisphereOfItsStationAndFlippedInTheOther) {
  for (const char* hemisphere : {"1,0,0", "2:-1,0,0", "2:0.003,0.004,0", "2:0,0,0"}) {
    SCOPED_TRACE(hemisphere);
    FastrakOptions options;
    read_zenith(hemisphere, options.zenith);
    Bench bench(unit("noise=0"), options, memory(), around_the_transmitter);
    ASSERT_TRUE(bench.run_until_streaming());
    bench.run(8s);
    ASSERT_EQ(bench.sent.size(), bench.samples.size());
    int flipped = 0;
    for (std::size_t i = 0; i < bench.samples.size(); ++i) {
      const TrackerSample& s = tracker(bench.samples[i]);
      const Vec3 truth = around_the_transmitter(s.station, bench.sent[i].measured).X_TS.p;
      const Vec3& zenith = options.zenith[static_cast<std::size_t>(s.station - 1)];
      const bool outside = zenith.dot(truth) < 0.0;
      EXPECT_LT((s.X_TS.p - (outside ? Vec3(-truth) : truth)).norm(), 1e-6) << i;
      flipped += outside;
    }
    EXPECT_EQ(flipped == 0, options.zenith[1].isZero());  // as the unit follows the hand
  }
}

TEST(FastrakDriverTest, HemispheresAreReadForOneStationOrAll) {
  FastrakZeniths zeniths = zeniths_ahead();
  read_zenith("3:0,-1,2.5e-1", zeniths);
  EXPECT_EQ(zeniths[2], Vec3(0.0, -1.0, 0.25));
  EXPECT_EQ(zeniths[1], Vec3::UnitX());
  read_zenith("0,0,1", zeniths);
  for (const Vec3& zenith : zeniths) EXPECT_EQ(zenith, Vec3::UnitZ());
  for (const char* wrong : {"", "1,0", "1,0,0,0", "1,0,0 ", "5:1,0,0", "0:1,0,0", "12:1,0,0",
                            ":1,0,0", "1:", "x,0,0", "nan,0,0", "inf,0,0", "1,,0"}) {
    EXPECT_THROW(read_zenith(wrong, zeniths), std::invalid_argument) << wrong;
  }
  EXPECT_EQ(zeniths[0], Vec3::UnitZ());
}

// --- Slow lines ------------------------------------------------------------------------------

// Each cycle that a slow line leaves out was counted as a missed record, and as a lost sample.
TEST(FastrakDriverTest, WhatASlowLineCannotCarryIsNotMissed) {
  for (const int baud : {9600, 19200, 38400}) {
    for (const int receivers : {1, 2, 4}) {
      SCOPED_TRACE(std::to_string(baud) + " baud, " + std::to_string(receivers) + " receivers");
      FastrakEmulatorOptions emulated = unit("noise=0", receivers);
      emulated.baud = baud;
      FastrakOptions options;
      options.baud = baud;
      Bench bench(emulated, options);
      ASSERT_TRUE(bench.run_until_streaming());
      bench.run(20s);
      EXPECT_GT(bench.samples.size(), 300u);
      EXPECT_EQ(bench.driver.statistics().missed, 0);
      EXPECT_EQ(holes_of(bench.samples), 0);
    }
  }
}

TEST(FastrakClockTest, NumbersTheRecordsThatASlowLineCarries) {
  const Time byte{1'042};  // at 9600 baud: 35 bytes take more than four cycles, and so five
  for (const int stations : {1, 2, 4}) {
    Clocks clocks;
    FastrakClock clock(stations, byte, 35, clocks, clocks.add());
    for (std::int64_t number = 0; number < 200; ++number) {
      if (number % 7 == 3 || (number >= 50 && number < 60)) continue;  // lost on the line
      const std::array<Time, 1> arrived = {tick_time(5 * number, kFastrakCycleRate) + 10ms};
      const auto turn = static_cast<int>(number % stations);
      ASSERT_TRUE(clock.measured(turn, arrived, arrived[0] + 1s));
      ASSERT_EQ(clock.record(), number) << stations << " stations";
    }
  }
}

// A lost record took no time on the line, so that the next one came a cycle later and none was missed.
TEST(FastrakDriverTest, WhatIsLostOnASlowLineIsMissed) {
  for (const int baud : {9600, 19200, 38400}) {
    for (const int receivers : {1, 2, 4}) {
      SCOPED_TRACE(std::to_string(baud) + " baud, " + std::to_string(receivers) + " receivers");
      FastrakEmulatorOptions emulated = unit("noise=0,dropout=0.1", receivers);
      emulated.baud = baud;
      FastrakOptions options;
      options.baud = baud;
      Bench bench(emulated, options);
      ASSERT_TRUE(bench.run_until_streaming());
      bench.run(60s);
      EXPECT_GT(bench.emulator.statistics().lost, 80);
      EXPECT_NEAR(static_cast<double>(bench.driver.statistics().missed),
                  static_cast<double>(bench.emulator.statistics().lost), 5.0);  // at both ends
    }
  }
}

}  // namespace
}  // namespace headpin::devices
