#include <atomic>
#include <cmath>
#include <csignal>
#include <mutex>
#include <random>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <pthread.h>
#include <sched.h>
#include <sys/wait.h>
#include <unistd.h>

#include "devices/fastrak/driver.h"
#include "devices/fastrak/emulator.h"
#include "devices/fastrak/geometry.h"
#include "devices/lines/lasting_line.h"
#include "devices/lines/stamped_stream.h"
#include "tests/support/folder.h"

namespace headpin::devices {
namespace {

using namespace std::chrono_literals;

#ifdef HEADPIN_SANITIZED
constexpr int kLess = 10;  // sanitizers run the long ones shorter
#else
constexpr int kLess = 1;
#endif

FastrakEmulatorOptions unit(const std::string& faults = "", int receivers = 2) {
  FastrakEmulatorOptions options;
  options.receivers = receivers;
  options.faults = parse_faults(faults);
  options.seed = 7;
  return options;
}

struct Ends {
  std::unique_ptr<ByteStream> unit, host;
};

Ends memory() {
  auto [a, b] = memory_streams();
  return {std::move(a), std::move(b)};
}

// A pseudo-terminal, its far end opened as a serial port.
Ends terminal() {
  auto pty = std::make_unique<PseudoTerminal>();
  auto port = open_serial(pty->name(), 115200);
  return {std::move(pty), std::move(port)};
}

// A unit and a driver at the two ends of a line, and a clock that the test turns.
struct Bench {
  Bench(FastrakEmulatorOptions unit_options, FastrakOptions options, Ends ends = memory(),
        FastrakMotion motion = circling_motion)
      : line(std::move(ends.unit)),
        emulator(listened(std::move(unit_options)), std::move(motion)),
        driver(std::move(ends.host), std::move(options)) {}
  Bench(const Bench&) = delete;
  Bench& operator=(const Bench&) = delete;

  FastrakEmulatorOptions listened(FastrakEmulatorOptions options) {
    options.on_record = [this](const FastrakSent& record) { sent.push_back(record); };
    return options;
  }

  void run(Time span, Time step = 1ms) {
    for (const Time end = now + span; now < end;) {
      now += step;
      if (!emulator.due(now).empty()) {
        serve(emulator, *line, now);
        settle(driver.descriptor());
      } else {
        serve(emulator, *line, now);
      }
      driver.poll(now, samples);
    }
  }

  // A terminal hands bytes on a moment later, outside of the test's clock: wait for it.
  static void settle(int descriptor) {
    if (descriptor < 0) return;
    pollfd state{descriptor, POLLIN, 0};
    ::poll(&state, 1, 100);
  }

  bool run_until_streaming(Time patience = 60s) {
    for (const Time end = now + patience; now < end && !driver.streaming();) run(5ms);
    return driver.streaming();
  }

  std::vector<FastrakSent> sent;
  std::vector<Sample> samples;
  Time now{};
  std::unique_ptr<ByteStream> line;
  FastrakEmulator emulator;
  FastrakDriver driver;
};

const TrackerSample& tracker(const Sample& sample) {
  return std::get<TrackerSample>(sample);
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

/// Every good sample has the true pose at the time of its record.
void expect_true_poses(const Bench& bench) {
  for (std::size_t i = 0; i < bench.samples.size(); ++i) {
    const TrackerSample& s = tracker(bench.samples[i]);
    const Pose truth = circling_motion(s.station, bench.sent[i].measured).X_TS;
    EXPECT_LT((s.X_TS.p - truth.p).norm(), 1e-6);
    EXPECT_LT(s.X_TS.q.angularDistance(truth.q), 1e-6);
    EXPECT_TRUE(s.good());
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

// --- Time ------------------------------------------------------------------------------------

TEST(FastrakDriverTest, TheEstimateIsTheMeasurementsTimeWithinAMillisecond) {
  for (const int receivers : {1, 2, 4}) {
    for (const Time step : {Time{500}, Time{1000}, Time{4000}}) {
      SCOPED_TRACE(std::to_string(receivers) + " receivers, polled every " +
                   std::to_string(step.count()) + " us");
      Bench bench(unit("", receivers), {});
      ASSERT_TRUE(bench.run_until_streaming());
      bench.run(30s, step);
      ASSERT_EQ(bench.sent.size(), bench.samples.size());
      Time worst{};
      for (std::size_t i = 240; i < bench.samples.size(); ++i) {  // after two seconds of listening
        const TrackerSample& s = tracker(bench.samples[i]);
        worst = std::max(worst, std::chrono::abs(s.device_time - bench.sent[i].measured));
        EXPECT_GE(s.host_time, s.device_time);
        EXPECT_GT(s.device_time, device_time(bench.samples[i - 1]));
      }
      EXPECT_LT(worst, step);  // what polling hides is the least that can be known
    }
  }
}

TEST(FastrakDriverTest, LatePollsDoNotBendTheEstimate) {
  std::mt19937 random(8);
  Bench bench(unit(), {});
  ASSERT_TRUE(bench.run_until_streaming());
  bench.run(2s);
  const std::size_t first = bench.samples.size();
  for (int i = 0; i < 500; ++i) {
    const auto late = Time{1000 * (1 + static_cast<int>(random() % 40))};  // up to 40 ms at once
    for (Time t{}; t < late; t += 1ms) serve(bench.emulator, *bench.line, bench.now += 1ms);
    bench.driver.poll(bench.now, bench.samples);
  }
  ASSERT_EQ(bench.sent.size(), bench.samples.size());
  for (std::size_t i = first; i < bench.samples.size(); ++i) {
    EXPECT_LT(std::chrono::abs(device_time(bench.samples[i]) - bench.sent[i].measured), 3ms) << i;
  }
}

/// Whether each sample follows the one before of its station as its record did, to a millisecond,
/// both counted in records of the unit.
void expect_the_units_intervals(const std::vector<FastrakSent>& sent,
                                const std::vector<Sample>& samples) {
  ASSERT_GE(sent.size(), samples.size());
  std::array<std::optional<std::size_t>, kFastrakStations> last;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const TrackerSample& s = tracker(samples[i]);
    auto& before = last[static_cast<std::size_t>(s.station - 1)];
    ASSERT_EQ(s.station, sent[i].station) << i;
    if (before) {
      const Time interval = s.device_time - device_time(samples[*before]);
      const Time units = sent[i].measured - sent[*before].measured;
      EXPECT_LE(std::chrono::abs(interval - units), 1ms)
          << "sample " << i << ": " << interval.count() << " us after the one before, "
          << units.count() << " at the unit";
    }
    before = i;
  }
}

/// Cycles in which the unit said nothing, from the first of so many records to the last.
std::int64_t skipped_cycles(const std::vector<FastrakSent>& sent, std::size_t records) {
  std::int64_t skipped = 0;
  for (std::size_t i = 1; i < records; ++i) {
    skipped += std::llround(seconds(sent[i].measured - sent[i - 1].measured) * 120.0) - 1;
  }
  return skipped;
}

// A session whose ticks stand still for 20 ms each second, and make up for it at once.
TEST(FastrakDriverTest, TicksThatComeLateBendNoIntervalAndLoseNothing) {
  for (const int receivers : {1, 2, 4}) {
    SCOPED_TRACE(std::to_string(receivers) + " receivers");
    std::vector<FastrakSent> sent;
    FastrakEmulatorOptions options = unit("", receivers);
    options.on_record = [&](const FastrakSent& record) { sent.push_back(record); };
    FastrakEmulator emulator(options, circling_motion);
    Time now{};
    auto [line, host] = memory_streams();
    auto owned = std::make_unique<StampedStream>(std::move(host), [&now] { return now; });
    StampedStream& stamped = *owned;
    FastrakDriver driver(std::move(owned));
    std::vector<Sample> samples;
    std::int64_t tick = 0;
    while (now < 60s) {
      now += 1ms;
      serve(emulator, *line, now);
      stamped.listen();
      if (now % 1s < 20ms || (now > 30s && now < 33s)) continue;  // longer than the watchdog
      for (; tick_time(tick, 240) <= now; ++tick) driver.poll(tick_time(tick, 240), samples);
    }
    EXPECT_GT(samples.size(), 6500u);
    EXPECT_EQ(driver.statistics().missed, 0);
    EXPECT_EQ(driver.statistics().skipped_bytes, 0);
    EXPECT_EQ(driver.statistics().restarts, 0);
    expect_the_units_intervals(sent, samples);
  }
}

// The process that plays the unit stands still for 0.7 s of every two; the line takes what it owes.
TEST(FastrakDriverTest, AServerThatIsHeldUpLosesNoRecord) {
  FastrakEmulator emulator(unit("noise=0"), circling_motion);
  Time now{};
  auto [line, host] = memory_streams();
  auto owned = std::make_unique<StampedStream>(std::move(host), [&now] { return now; });
  StampedStream& stamped = *owned;
  FastrakDriver driver(std::move(owned));
  std::vector<Sample> samples;
  for (; now < 30s; now += 1ms) {
    if (now < 5s || now % 2s > 700ms) serve(emulator, *line, now);
    stamped.listen();
    driver.poll(now, samples);
  }
  EXPECT_GT(samples.size(), 2900u);
  EXPECT_EQ(emulator.statistics().dropped, 0);
  EXPECT_EQ(driver.statistics().missed, 0);
  EXPECT_EQ(driver.statistics().restarts, 0);
}

/// A line whose read stands still until it is let go.
class StandingLine : public ByteStream {
 public:
  std::size_t read(std::span<std::uint8_t>) override {
    const std::lock_guard lock(stands);
    return 0;
  }
  std::size_t write(Bytes bytes) override {
    written += bytes.size();
    return bytes.size();
  }
  bool closed() const override { return false; }
  void set_baud(int rate) override { baud = rate; }

  std::mutex stands;
  std::atomic<std::size_t> written{0};
  std::atomic<int> baud{0};
};

// Else a tick would stand still with it.
TEST(StampedStreamTest, NobodyWaitsForALineThatStandsStillButItsListener) {
  auto owned = std::make_unique<StandingLine>();
  StandingLine& line = *owned;
  StampedStream stamped(std::move(owned), [] { return Time{}; });
  std::array<std::uint8_t, 16> bytes{};
  {
    const std::lock_guard lock(line.stands);
    stamped.start();
    EXPECT_EQ(stamped.write(bytes), bytes.size());
    stamped.set_baud(9600);
    EXPECT_EQ(stamped.write(Bytes(bytes).first(4)), 4u);
    EXPECT_EQ(stamped.read(bytes), 0u);
    EXPECT_EQ(stamped.trouble(), "");
    EXPECT_FALSE(stamped.closed());
  }
  while (line.written < 20 || line.baud != 9600) std::this_thread::yield();
}

/// Processes that want all of every core, for as long as this lives.
class Hogs {
 public:
  explicit Hogs(int count) {
    for (int i = 0; i < count; ++i) {
      const pid_t child = fork();
      if (child == 0) {
        while (getppid() != 1) {  // ends with the test, whatever becomes of that
        }
        _exit(0);
      }
      if (child > 0) children_.push_back(child);
    }
  }
  ~Hogs() {
    for (const pid_t child : children_) kill(child, SIGKILL), waitpid(child, nullptr, 0);
  }
  Hogs(const Hogs&) = delete;
  Hogs& operator=(const Hogs&) = delete;

 private:
  std::vector<pid_t> children_;
};

// In real time, over a pseudo-terminal, the unit in a thread of its own, every core taken.
TEST(FastrakDriverTest, NeitherDoesALoadedMachine) {
  const auto start = std::chrono::steady_clock::now();
  const auto clock = [start] {
    return std::chrono::duration_cast<Time>(std::chrono::steady_clock::now() - start);
  };
  std::mutex mutex;
  std::vector<FastrakSent> sent;
  FastrakEmulatorOptions options = unit("noise=0");
  options.on_record = [&](const FastrakSent& record) {
    const std::lock_guard lock(mutex);
    sent.push_back(record);
  };
  PseudoTerminal pty;
  FastrakEmulator emulator(options, circling_motion);
  std::atomic<bool> over{false};
  Time longest_pause{};
  std::thread unit_thread([&] {
    // A unit has a processor of its own; here that takes a right that not everybody has.
    const sched_param first{.sched_priority = 1};
    pthread_setschedparam(pthread_self(), SCHED_FIFO, &first);
    for (Time last{}; !over;) {
      pollfd line{pty.descriptor(), POLLIN, 0};
      ::poll(&line, 1, 1);
      const Time now = clock();
      serve(emulator, pty, now);
      longest_pause = std::max(longest_pause, now - std::exchange(last, now));
    }
  });
  std::vector<Sample> samples;
  FastrakStatistics statistics;
  {
    auto stamped = std::make_unique<StampedStream>(open_serial(pty.name(), 115200), clock);
    stamped->start();
    FastrakDriver driver(std::move(stamped));
    const Hogs hogs(2 * static_cast<int>(std::thread::hardware_concurrency()));
    for (std::int64_t tick = 1; samples.size() < 1000; ++tick) {
      std::this_thread::sleep_until(start + tick_time(tick, 240));
      driver.poll(tick_time(tick, 240), samples);
      ASSERT_LT(clock(), 120s) << driver.activity();
    }
    statistics = driver.statistics();
  }
  over = true;
  unit_thread.join();
  if (longest_pause > 500ms) GTEST_SKIP() << "the unit itself stood still";
  EXPECT_EQ(statistics.restarts, 0);
  EXPECT_EQ(statistics.skipped_bytes, 0);
  EXPECT_EQ(statistics.missed, skipped_cycles(sent, samples.size()));
  expect_the_units_intervals(sent, samples);
}

TEST(FastrakDriverTest, AHoleInTheSequenceIsARecordThatWasLost) {
  Bench bench(unit("dropout=0.1", 2), {});
  ASSERT_TRUE(bench.run_until_streaming());
  bench.run(30s);
  EXPECT_GT(bench.emulator.statistics().lost, 200);
  EXPECT_NEAR(static_cast<double>(bench.driver.statistics().missed),
              static_cast<double>(bench.emulator.statistics().lost), 3.0);  // at both ends
  std::array<std::int64_t, 2> last = {-1, -1};
  std::int64_t holes = 0;
  for (const Sample& sample : bench.samples) {
    const TrackerSample& s = tracker(sample);
    std::int64_t& previous = last[static_cast<std::size_t>(s.station - 1)];
    EXPECT_GT(s.sequence, previous);
    if (previous >= 0) holes += s.sequence - previous - 1;
    previous = s.sequence;
  }
  EXPECT_NEAR(static_cast<double>(holes), static_cast<double>(bench.emulator.statistics().lost),
              4.0);
}

// --- Bringing it up --------------------------------------------------------------------------

TEST(FastrakDriverTest, TakesOverAUnitInWhateverStateItWasLeft) {
  const std::vector<std::string> states = {
      "",
      "C",                                  // streaming in ASCII
      "fuC",                                // in binary, centimetres
      "O1,2,4\rO2,16\rfC",                  // records without an end
      "C\x13",                              // streaming, suspended
      "O1,2,11",                            // a half-typed line
      "XC",                                 // a half-typed line that swallows what follows
      "A1,10,0,0,10,10,0,0,0,0\rB1\rB2\r",  // other frames
      "r1,90,0,0\rI1,50\rI2,50\rC",         // still receivers held back
      "V1,1,1,1\rV2,1,1,1\rQ1,1,1,1\rC",    // envelopes that mark every record
      "l1,0\rl2,0\r",                       // all stations off
      "H1,-1,0,0\rH2,-1,0,0\rx5\rv5\r",     // wrong hemisphere, heavy filters
      "N1,2.5,0,0\rN2,0,3,0\r",             // tip offsets
      "e1,1\ry1\rXa unit\rD",
      "o,N,7,0\rfuC",  // at seven bits, in binary
      "o,E,7,0\rU",    // with parity, in inches
      "fC\x0b"};       // saving a streaming set-up
  for (const std::string& state : states) {
    SCOPED_TRACE(testing::PrintToString(state));
    FastrakOptions options;
    Bench bench(unit("noise=0"), options);
    bench.emulator.receive(Bytes(reinterpret_cast<const std::uint8_t*>(state.data()), state.size()),
                           bench.now);
    for (int ms = 0; ms < 300; ++ms) serve(bench.emulator, *bench.line, bench.now += 1ms);
    ASSERT_TRUE(bench.run_until_streaming());
    bench.sent.clear();
    bench.run(1s);
    ASSERT_GT(bench.samples.size(), 100u);
    expect_true_poses(bench);
  }
}

/// A line on which the driver's commands with a certain beginning are lost, so many times.
class Forgetful : public ByteStream {
 public:
  Forgetful(std::unique_ptr<ByteStream> line, std::string command, int times)
      : line_(std::move(line)), command_(std::move(command)), times_(times) {}
  std::size_t read(std::span<std::uint8_t> out) override { return line_->read(out); }
  std::size_t write(Bytes bytes) override {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (!text.starts_with(command_) || times_ == 0) return line_->write(bytes);
    --times_;
    return bytes.size();
  }
  bool closed() const override { return line_->closed(); }

 private:
  std::unique_ptr<ByteStream> line_;
  std::string command_;
  int times_;
};

// What makes good-looking wrong samples is not believed before it is read back.
TEST(FastrakDriverTest, ASettingThatWasLostIsSetAgain) {
  for (const std::string command : {"u", "H2,", "R1", "N1,", "r1,", "O1,"}) {
    SCOPED_TRACE(command);
    auto [line, host] = memory_streams();
    Bench bench(unit("noise=0"), {},
                {std::move(line), std::make_unique<Forgetful>(std::move(host), command, 1)});
    const std::string left = "H2,-1,0,0\rA1,10,0,0,10,10,0,0,0,0\rN1,2.5,0,0\rr1,90,0,0\r";
    bench.emulator.receive(Bytes(reinterpret_cast<const std::uint8_t*>(left.data()), left.size()),
                           bench.now);
    ASSERT_TRUE(bench.run_until_streaming());
    EXPECT_GT(bench.driver.statistics().attempts, 1);
    bench.sent.clear();
    bench.run(1s);
    ASSERT_GT(bench.samples.size(), 60u);
    expect_true_poses(bench);
  }
}

// A unit that will not widen an envelope flags what is beyond it, so its samples can be used.
TEST(FastrakDriverTest, ASettingThatRecordsShowThemselvesIsOnlyMentioned) {
  auto [line, host] = memory_streams();
  Bench bench(unit("noise=0"), {},
              {std::move(line), std::make_unique<Forgetful>(std::move(host), "V1,", 100)});
  ASSERT_TRUE(bench.run_until_streaming());
  EXPECT_EQ(bench.driver.statistics().attempts, 1);
  EXPECT_THAT(bench.driver.unconfirmed(), testing::ElementsAre("V1: set, and reads otherwise"));
}

TEST(FastrakDriverTest, AUnitThatIsJustStartingUpIsWaitedFor) {
  Bench bench(unit(), {});
  bench.emulator.power_cycle(bench.now);
  EXPECT_TRUE(bench.run_until_streaming(30s));
  EXPECT_GT(bench.now, 10s);
}

TEST(FastrakDriverTest, SilenceIsNoticedAndOvercome) {
  Bench bench(unit("silence=4@10"), {});
  bench.run(30s);
  const auto& s = bench.driver.statistics();
  EXPECT_GE(s.restarts, 1);
  EXPECT_TRUE(bench.driver.streaming());
  // In order, and none twice.
  std::array<std::int64_t, 2> last = {-1, -1};
  for (const Sample& sample : bench.samples) {
    const TrackerSample& t = tracker(sample);
    std::int64_t& previous = last[static_cast<std::size_t>(t.station - 1)];
    EXPECT_GT(t.sequence, previous);
    previous = t.sequence;
  }
  EXPECT_GT(device_time(bench.samples.back()), 29s);
}

TEST(FastrakDriverTest, APowerCycleIsOvercome) {
  Bench bench(unit(), {});
  ASSERT_TRUE(bench.run_until_streaming());
  bench.run(2s);
  bench.emulator.power_cycle(bench.now);
  bench.run(40s);
  EXPECT_TRUE(bench.driver.streaming());
  EXPECT_EQ(bench.driver.statistics().restarts, 1);
  EXPECT_GT(device_time(bench.samples.back()), bench.now - 100ms);
}

TEST(FastrakDriverTest, OnlyWantedStationsStream) {
  FastrakOptions options;
  options.stations = {false, true, false, false};
  Bench bench(unit(), options);
  ASSERT_TRUE(bench.run_until_streaming());
  bench.run(500ms);
  bench.samples.clear();
  bench.run(1s);
  EXPECT_NEAR(static_cast<double>(bench.samples.size()), 120.0, 1.0);  // the rate of one
  for (const Sample& sample : bench.samples) EXPECT_EQ(tracker(sample).station, 2);
}

/// A unit that can be pulled out and put back under the same name.
class Adapter {
 public:
  virtual ~Adapter() = default;
  virtual std::string name() const = 0;
  virtual std::unique_ptr<ByteStream> plug_in() = 0;
};

class Tty : public Adapter {
 public:
  std::string name() const override { return path_; }
  std::unique_ptr<ByteStream> plug_in() override { return std::make_unique<PseudoTerminal>(path_); }

 private:
  std::string path_ = (fresh_folder("unit") / "tty").string();
};

class Ethernet : public Adapter {
 public:
  std::string name() const override { return "tcp:127.0.0.1:" + std::to_string(port_); }
  std::unique_ptr<ByteStream> plug_in() override {
    auto server = std::make_unique<TcpServer>(port_);
    port_ = server->port();
    return server;
  }

 private:
  int port_ = 0;
};

// The unit is switched off and on, or its adapter pulled out and put back: it goes on by itself.
void a_line_that_hangs_up_and_comes_back_goes_on(Adapter& adapter) {
  std::unique_ptr<ByteStream> line = adapter.plug_in();
  auto emulator = std::make_unique<FastrakEmulator>(unit("noise=0"), circling_motion);
  FastrakDriver driver(open_line(adapter.name(), 115200));
  Time now{};
  std::vector<Sample> samples;
  const auto run_until = [&](auto reached) {
    const Time end = now + 60s;
    for (; now < end && !reached(); now += 1ms) {
      if (line) serve(*emulator, *line, now);
      driver.poll(now, samples);
      std::this_thread::sleep_for(100us);  // the line takes its own time
    }
    EXPECT_TRUE(reached()) << driver.activity();
  };
  run_until([&] { return samples.size() >= 100; });
  const std::size_t before = samples.size();
  line.reset();
  run_until([&] { return !driver.streaming() || !driver.trouble().empty(); });
  EXPECT_THAT(driver.activity(), testing::HasSubstr(adapter.name() + " hung up; waiting"));
  EXPECT_FALSE(driver.exhausted());
  emulator = std::make_unique<FastrakEmulator>(unit("noise=0"), circling_motion);  // as new
  now += 5s;
  line = adapter.plug_in();
  run_until([&] { return samples.size() >= before + 100; });
  for (std::size_t i = 1; i < samples.size(); ++i) {
    EXPECT_GT(device_time(samples[i]), device_time(samples[i - 1]));
    EXPECT_GE(tracker(samples[i]).sequence, tracker(samples[i - 1]).sequence);
  }
}

TEST(FastrakDriverTest, ASerialLineThatHangsUpAndComesBackGoesOn) {
  Tty tty;
  a_line_that_hangs_up_and_comes_back_goes_on(tty);
}

TEST(FastrakDriverTest, SoDoesOneBehindAnEthernetAdapter) {
  Ethernet ethernet;
  a_line_that_hangs_up_and_comes_back_goes_on(ethernet);
}

TEST(FastrakDriverTest, ALineThatCannotBeOpenedIsNamed) {
  for (const char* name :
       {"tcp:", "tcp:localhost", "tcp:localhost:0", "tcp:localhost:x", "tcp::1"}) {
    EXPECT_THROW(open_line(name, 115200), std::invalid_argument) << name;
  }
  EXPECT_THROW(open_line("/nowhere/tty", 115200), std::runtime_error);
  EXPECT_THROW(open_line("tcp:127.0.0.1:1", 115200), std::runtime_error);
}

TEST(FastrakDriverTest, NobodyAtTheOtherEndIsNoFailure) {
  auto [here, there] = memory_streams();
  FastrakDriver driver(std::move(here), {});
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
    FastrakDriver driver(std::move(memory_streams().first), options);
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
  FastrakDriver driver(std::move(here), {});
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

}  // namespace
}  // namespace headpin::devices
