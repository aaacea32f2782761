// When a record was measured, and which one it is, by the times at which records arrive.

#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "devices/fastrak/clock.h"
#include "devices/fastrak/codec.h"

namespace headpin::devices {
namespace {

using namespace std::chrono_literals;

constexpr Time kFast{87};  // a byte's time at 115200 baud

/// A clock of a unit's cycles, and the session's clocks.
struct Timed {
  Timed(int stations, Time byte, std::size_t length)
      : clock(stations, byte, length, clocks, cycles) {}
  /// The date of a record, decided so late that nothing is waited for.
  Time date(int turn, const std::vector<Time>& arrivals) {
    const auto measured = clock.measured(turn, arrivals, arrivals.front() + 1s);
    EXPECT_TRUE(measured.has_value());
    return measured.value_or(Time{});
  }
  Clocks clocks;
  ClockId cycles = clocks.add();
  FastrakClock clock;
};

/// A record of the station whose turn a cycle is arrives so long after the cycle begins.
constexpr Time kDelay = 10ms;
Time arrival(std::int64_t cycle) {
  return tick_time(cycle, kFastrakCycleRate) + kDelay;
}

// Manual p. E-4: output begins 3.75 ms after mid-sampling; the first byte has then to come.
TEST(FastrakClockTest, ARecordIsAsOldAsItsSolutionAndItsFirstByte) {
  Timed slow(1, 1042us, 35);
  const std::vector<Time> arrived = {100ms};
  EXPECT_FALSE(slow.clock.measured(0, arrived, 350ms - 1us));  // a quarter of a second to settle
  EXPECT_EQ(slow.clock.measured(0, arrived, 350ms), 100ms - 3750us - 1042us);
}

TEST(FastrakClockTest, EachStartOfAUnitRestartsItsClock) {
  Timed timed(1, kFast, 34);
  timed.date(0, {arrival(0)});
  EXPECT_TRUE(timed.clock.started());
  const FastrakClock next(1, kFast, 34, timed.clocks, timed.cycles);
  EXPECT_FALSE(next.started());
}

// 33 bytes just fit 38400 baud, where the time of a byte is rounded up to 261 us: the last one leaves
// while the next record is written.
TEST(FastrakClockTest, RecordsThatJustFitTheLineComeInEveryCycle) {
  Timed timed(1, 261us, 33);
  for (std::int64_t cycle = 0; cycle < 100; ++cycle) {
    if (cycle % 7 == 3) continue;  // lost
    const Time measured = timed.date(0, {arrival(cycle)});
    ASSERT_EQ(timed.clock.record(), cycle);
    ASSERT_LE(std::chrono::abs(measured - (arrival(cycle) - 3750us - 261us)), 1us) << cycle;
  }
}

TEST(FastrakClockTest, LossesDoNotBendTheDates) {
  for (const int stations : {1, 2, 3, 4}) {
    Timed timed(stations, kFast, 34);
    for (std::int64_t cycle = 0; cycle < 200; ++cycle) {
      if (cycle % 7 == 3 || (cycle >= 50 && cycle < 60)) continue;
      const Time measured = timed.date(static_cast<int>(cycle % stations), {arrival(cycle)});
      ASSERT_EQ(timed.clock.record(), cycle);
      ASSERT_LE(std::chrono::abs(measured - (arrival(cycle) - 3750us - kFast)), 1us) << cycle;
    }
  }
}

// Records that arrive at once were perhaps held up; one that comes a cycle later was not.
TEST(FastrakClockTest, RecordsThatWereHeldUpTogetherWaitForOneThatWasNot) {
  const auto after_a_gap = [] {
    auto timed = std::make_unique<Timed>(1, kFast, 34);
    timed->date(0, {arrival(0)});
    timed->date(0, {arrival(1)});
    return timed;
  };
  const std::vector<Time> at_once = {arrival(8), arrival(8)};
  const auto waiting = after_a_gap();
  EXPECT_FALSE(waiting->clock.measured(0, at_once, at_once[0]));
  EXPECT_FALSE(waiting->clock.measured(0, at_once, at_once[0] + 150ms - 1us));
  EXPECT_TRUE(waiting->clock.measured(0, at_once, at_once[0] + 150ms));
  const auto shown = after_a_gap();
  const std::vector<Time> and_one = {arrival(8), arrival(8), arrival(9)};
  EXPECT_EQ(shown->clock.measured(0, and_one, and_one[2]), arrival(7) - 3750us - kFast);
  EXPECT_EQ(shown->clock.record(), 7);
}

// A compact record on a fast line takes a sixth of a cycle; two that arrive at once are two cycles.
TEST(FastrakClockTest, ADateIsAQuarterOfACycleAfterTheOneBeforeAtLeast) {
  Timed timed(1, kFast, 16);
  const Time first = timed.date(0, {arrival(0)});
  EXPECT_GE(timed.date(0, {arrival(0)}) - first, 2083us);
  EXPECT_EQ(timed.clock.record(), 1);
}

// The line takes 4.5 cycles for a record, so that the unit sends one in every fifth.
TEST(FastrakClockTest, AStationsNextRecordIsATurnLaterHoweverEarlyItComes) {
  Timed timed(4, 1042us, 37);
  timed.date(0, {arrival(0)});
  timed.date(0, {arrival(8)});
  EXPECT_EQ(timed.clock.record(), 4);
}

}  // namespace
}  // namespace headpin::devices
