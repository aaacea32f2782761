// A session's clock held to a tracker's: whole steps of a grid, whatever the two are off and drift by.

#include "devices/base/genlock.h"

#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "devices/base/clock_offset.h"

namespace headpin::devices {
namespace {

using namespace std::chrono_literals;

constexpr std::int64_t kRate = 240;

/// What a session makes of a tracker of 60 Hz whose clock is another one.
struct Heard {
  double most_off_us = 0.0;   ///< stamps of the last ten seconds, from when it was measured
  double longest_tick = 0.0;  ///< of its nominal length
  double shortest_tick = 1e9;
  std::int64_t other_steps = 0;  ///< between samples, of another length than the tracker's
  double offset_us = 0.0;        ///< at the end
};

/// @param phase_us  of the tracker's clock against the machine's at the start
/// @param drift     how much faster it is
Heard listen(double phase_us, double drift, Time length) {
  Genlock genlock(kRate);
  ClockOffset clock;
  Heard heard;
  const Time tick = tick_time(1, kRate);
  double behind_us = 0.0;
  std::int64_t sent = 0;
  Time before{};
  for (std::int64_t n = 1; tick_time(n, kRate) < length; ++n) {
    const Time now = tick_time(n, kRate);
    const double stretch_us = genlock.stretch_us(tick);
    behind_us += stretch_us;
    const double lasts = (static_cast<double>(tick.count()) + stretch_us) / 4166.0;
    heard.longest_tick = std::max(heard.longest_tick, lasts);
    heard.shortest_tick = std::min(heard.shortest_tick, lasts);
    const double machine_us = static_cast<double>(now.count()) + behind_us;
    for (;; ++sent) {
      const auto theirs = static_cast<double>(tick_time(sent, 60).count());
      const double measured_us = theirs / (1.0 + drift) + phase_us;  // on the machine's clock
      const double late_us = 200.0 + 700.0 * std::abs(std::sin(static_cast<double>(sent)));
      if (measured_us + late_us > machine_us) break;
      const double seen_us = measured_us + late_us - behind_us;
      const double estimated_us = clock.carry_over(theirs, seen_us) - theirs;
      heard.offset_us = genlock.follow(estimated_us);
      const Time stamp = tick_time(sent, 60) + Time{std::llround(heard.offset_us)};
      if (sent > 0 && stamp - before != tick_time(sent, 60) - tick_time(sent - 1, 60)) {
        ++heard.other_steps;
      }
      before = stamp;
      if (now > length - 10s) {
        heard.most_off_us =
            std::max(heard.most_off_us,
                     std::abs(static_cast<double>(stamp.count()) - (measured_us - behind_us)));
      }
    }
  }
  return heard;
}

TEST(Genlock, StampsAreWholeStepsOfTheGridAndTrueToAMillisecond) {
  for (const double phase_us : {0.0, 100.0, 3000.0, 6249.0, 9000.0, 12499.0, 98765.0}) {
    for (const double drift : {0.0, 5e-5, -5e-5}) {
      const Heard heard = listen(phase_us, drift, 60s);
      EXPECT_EQ(std::fmod(heard.offset_us, 12500.0), 0.0) << phase_us << ' ' << drift;
      EXPECT_EQ(heard.other_steps, 0) << phase_us << ' ' << drift;
      EXPECT_LT(heard.most_off_us, 1000.0) << phase_us << ' ' << drift;
      EXPECT_LE(heard.longest_tick, 1.0101) << phase_us << ' ' << drift;
      EXPECT_GE(heard.shortest_tick, 0.9989) << phase_us << ' ' << drift;
    }
  }
}

TEST(Genlock, AnotherClockKeepsItsOwnOffsetUnlessItIsTheSame) {
  Genlock genlock(kRate);
  EXPECT_EQ(genlock.same_or_own(777.0), 777.0);  // there is no reference yet
  EXPECT_EQ(genlock.follow(30'400.0), 25'000.0);
  EXPECT_EQ(genlock.same_or_own(30'400.0), 25'000.0);  // the same clock: 5.4 ms above the grid too
  EXPECT_EQ(genlock.same_or_own(26'300.0), 25'000.0);
  EXPECT_EQ(genlock.same_or_own(22'000.0), 22'000.0);
  EXPECT_EQ(genlock.same_or_own(700'400.0), 700'400.0);
  EXPECT_EQ(genlock.follow(30'900.0), 25'000.0);  // moves only when it jumps
  EXPECT_EQ(genlock.follow(1'030'900.0), 1'025'000.0);
}

TEST(Genlock, ItsGridIsTheLeastOfWholeTicksThatIsWholeMicroseconds) {
  for (const std::int64_t rate : {120, 240, 250, 960, 1000}) {
    Genlock genlock(rate);
    const double step =
        genlock.follow(5e6 + 1e6 / static_cast<double>(std::gcd(1'000'000, rate)) - 1e-3);
    const Time offset{std::llround(step)};
    const std::int64_t ticks = offset.count() * rate / 1'000'000;
    EXPECT_EQ(tick_time(ticks, rate), offset) << rate;
    EXPECT_EQ(ticks * 1'000'000 % rate, 0) << rate;
  }
}

TEST(Genlock, WhereThatWouldBeLongItIsATick) {
  for (const std::int64_t rate : {7, 60, 90, 144}) {
    Genlock genlock(rate);
    const double tick_us = 1e6 / static_cast<double>(rate);
    const double steps = genlock.follow(41.9 * tick_us) / tick_us;
    EXPECT_NEAR(steps, 41.0, 1e-9) << rate;
  }
}

TEST(Genlock, AClockIsSetAnewByMoreThanFifteenMillisecondsOrAStepOfTheGrid) {
  Genlock fine(kRate), coarse(120);  // steps of 12.5 and 25 ms
  for (const double estimated_us : {0.0, 15e3, -15e3}) EXPECT_EQ(fine.follow(estimated_us), 0.0);
  EXPECT_EQ(fine.follow(15'001.0), 12'500.0);
  for (const double estimated_us : {0.0, 25e3, -25e3}) EXPECT_EQ(coarse.follow(estimated_us), 0.0);
  EXPECT_EQ(coarse.follow(25'001.0), 25'000.0);
}

TEST(Genlock, AClockThatIsOffByFiveMillisecondsIsAnother) {
  Genlock genlock(kRate);
  genlock.follow(25'000.0);
  for (const double off_us : {-4'999.0, 4'999.0}) {
    EXPECT_EQ(genlock.same_or_own(25'000.0 + off_us), 25'000.0);
  }
  for (const double off_us : {-5'000.0, 5'000.0}) {
    EXPECT_EQ(genlock.same_or_own(25'000.0 + off_us), 25'000.0 + off_us);
  }
}

}  // namespace
}  // namespace headpin::devices
