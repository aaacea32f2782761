// Clocks of XDF's streams: when one was reset, and how an outlier pulls.

#include "devices/recordings/xdf_clock.h"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace headpin::devices {
namespace {

using testing::ElementsAre;

/// What is noted of offsets whose times and values differ by so much from one to the next.
std::vector<std::string> resets_of(const std::vector<double>& steps,
                                   const std::vector<double>& changes) {
  std::vector<XdfClockOffset> offsets = {{1000.0, 0.0, 0}};
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const XdfClockOffset& last = offsets.back();
    offsets.push_back({last.time + steps[i], last.value + changes[i], i + 1});
  }
  const std::vector<double> times(steps.size() + 1, 1000.0);
  std::vector<std::string> notes;
  synchronised(times, offsets, notes);
  return notes;
}

// pyxdf: both more than 5 s and more than 5 median deviations above the median.
TEST(XdfClock, IsResetWhereTheTimeJumpsBy5sAnd5DeviationsMoreThanUsual) {
  const std::vector<double> changes = {0, 0, 0, 100, 0, 0, 0};
  const auto with_step = [&](double step) {
    return resets_of({5, 5, 5, step, 5, 5, 5}, changes).size();
  };
  EXPECT_EQ(with_step(9), 0u);
  EXPECT_EQ(with_step(10), 0u);
  EXPECT_EQ(with_step(10.5), 1u);
  EXPECT_EQ(with_step(0), 0u);
  EXPECT_EQ(with_step(-0.5), 1u);
  EXPECT_THAT(resets_of({5, 5, 5, 20, 5, 5, 5}, changes),
              ElementsAre("its clock was reset after 1015.000 s"));

  // The median is 5 s, the median deviation 2 s.
  const auto of_deviations = [&](double step) {
    return resets_of({3, 7, 3, step, 5, 3, 7}, changes).size();
  };
  EXPECT_EQ(of_deviations(14), 0u);
  EXPECT_EQ(of_deviations(15), 0u);
  EXPECT_EQ(of_deviations(16), 1u);

  EXPECT_EQ(resets_of({20, 20, 20, 20, 20}, {0, 0, 100, 0, 0}).size(), 0u);
}

// More than 1 s and 10 median deviations.
TEST(XdfClock, IsResetOnlyWhereTheOffsetJumpsToo) {
  const std::vector<double> steps = {5, 5, 5, 100, 5, 5, 5};
  const auto with_change = [&](double change) {
    return resets_of(steps, {0, 0, 0, change, 0, 0, 0}).size();
  };
  EXPECT_EQ(with_change(0), 0u);
  EXPECT_EQ(with_change(1), 0u);
  EXPECT_EQ(with_change(-1.25), 1u);
  // The median is 0.5 s, the median deviation 0.25 s.
  const auto of_deviations = [&](double change) {
    return resets_of(steps, {0.25, 0.75, 0.25, change, 0.5, 0.25, 0.75}).size();
  };
  EXPECT_EQ(of_deviations(3), 0u);
  EXPECT_EQ(of_deviations(3.25), 1u);
}

TEST(XdfClock, TheMedianOfAnEvenNumberIsBetweenTheTwoInTheMiddle) {
  // The median is 6 s, the median deviation 3 s: 30 s are 8 deviations more.
  EXPECT_EQ(resets_of({5, 1, 30, 7}, {0, 0, 100, 0}).size(), 1u);
  EXPECT_EQ(resets_of({5, 1, 21, 7}, {0, 0, 100, 0}).size(), 0u);
  // Of two steps none is above the usual.
  EXPECT_EQ(resets_of({5, 100}, {0, 50}).size(), 0u);
}

// The jump of the samples' times is searched between the offsets that jump, not in a pause behind them.
TEST(XdfClock, TheSamplesOfANewClockBeginAtTheirLargestJump) {
  const std::vector<double> times = {1000, 1001, 1002, 1003, 1004, 1005, 1006, 3, 4, 5000, 5001};
  const std::vector<XdfClockOffset> offsets = {
      {1000, 0, 0}, {1005, 0, 6}, {4, 2000, 8}, {5001, 2000, 11}};
  std::vector<std::string> notes;
  EXPECT_THAT(synchronised(times, offsets, notes),
              ElementsAre(1000, 1001, 1002, 1003, 1004, 1005, 1006, 2003, 2004, 7000, 7001));
}

// Four offsets are 0. Huber's loss lets the fifth, in their middle, pull with the weight of 0.1 ms: the line
// is where the four pull back as much, at 0.1 ms / 4.
TEST(XdfClock, AnOutlierPullsWithATenthOfAMillisecond) {
  for (const double wrong : {0.001, 0.05, 3.0}) {
    const std::vector<XdfClockOffset> offsets = {
        {1000, 0, 0}, {1005, 0, 1}, {1010, wrong, 2}, {1015, 0, 3}, {1020, 0, 4}};
    std::vector<std::string> notes;
    EXPECT_NEAR(synchronised(std::vector{0.0}, offsets, notes)[0], 2.5e-5, 2e-9) << wrong;
  }
}

TEST(XdfClock, OffsetsThatAreNoTimesCountForNothing) {
  const double inf = std::numeric_limits<double>::infinity();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double none : {1e11, -1e11, 1e300, inf, -inf, nan}) {
    const std::vector<XdfClockOffset> offsets = {
        {1000, 3, 0}, {none, 500, 1}, {1005, none, 2}, {1010, 3, 3}};
    std::vector<std::string> notes;
    EXPECT_THAT(synchronised(std::vector{1001.0, 1007.0}, offsets, notes), ElementsAre(1004, 1010))
        << none;
    EXPECT_THAT(notes, ElementsAre());
  }
}

}  // namespace
}  // namespace headpin::devices
