// When each sample was measured, by the estimate of the driver, whatever holds up its polls.

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <csignal>
#include <memory>
#include <mutex>
#include <optional>
#include <random>
#include <thread>
#include <utility>

#include <gtest/gtest.h>
#include <poll.h>
#include <pthread.h>
#include <sched.h>
#include <sys/wait.h>
#include <unistd.h>

#include "devices/fastrak/driver.h"
#include "devices/fastrak/serving.h"
#include "devices/lines/stamped_stream.h"
#include "tests/devices/fastrak_bench.h"

namespace headpin::devices {
namespace {

using namespace std::chrono_literals;
using test::Bench;
using test::tracker;
using test::unit;

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
    Clocks clocks;
    FastrakDriver driver(std::move(owned), clocks);
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
  Clocks clocks;
  FastrakDriver driver(std::move(owned), clocks);
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
    Clocks clocks;
    FastrakDriver driver(std::move(stamped), clocks);
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

}  // namespace
}  // namespace headpin::devices
