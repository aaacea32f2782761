// Which tables hold two recordings, by the order of their rows.

#include "devices/recordings/table_order.h"

#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace headpin::devices {
namespace {

std::vector<double> at_rate(double begin_s, std::size_t rows, double step_s) {
  std::vector<double> times;
  for (std::size_t i = 0; i < rows; ++i) times.push_back(begin_s + step_s * static_cast<double>(i));
  return times;
}

/// Sixty bursts at 45 Hz, each of some rows that are 0.3 ms apart; they come early or late by up to a fifth.
std::vector<double> in_bursts(double begin_s, std::size_t rows_of_each) {
  std::vector<double> times;
  for (std::size_t burst = 0; burst < 60; ++burst) {
    const double off = 0.2 * (static_cast<double>(91 * burst % 11) / 5.0 - 1.0);
    const double at = begin_s + 0.0223 * (static_cast<double>(burst) + off);
    for (std::size_t i = 0; i < rows_of_each; ++i)
      times.push_back(at + 3e-4 * static_cast<double>(i));
  }
  return times;
}

std::vector<double> then(std::vector<double> first, const std::vector<double>& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

using Row = std::optional<std::size_t>;

// Only steps inside a burst counted as rows that follow each other, and two recordings were mixed.
TEST(TableOrder, OfBurstsThatComeAgainIsThatOfTwoRecordings) {
  for (const std::size_t rows : {1u, 2u, 3u, 4u, 6u, 8u}) {
    const std::vector<double> first = in_bursts(5.0, rows);
    EXPECT_EQ(starts_again(then(first, in_bursts(5.005, rows))), Row(first.size())) << rows;
    EXPECT_EQ(starts_again(then(first, in_bursts(5.0 + 60 * 0.0223, rows))), Row()) << rows;
    const auto part = [&](std::size_t from, std::size_t to) {
      const auto row = [&](std::size_t burst) {
        return first.begin() + static_cast<std::ptrdiff_t>(rows * burst);
      };
      return std::vector<double>(row(from), row(to));
    };
    const std::vector<double> blocks = then(then(part(0, 5), part(45, 60)), part(5, 45));
    EXPECT_EQ(starts_again(blocks), Row()) << rows;
  }
}

// Recordings below 10 Hz were always mixed.
TEST(TableOrder, OfASlowRecordingThatComesAgainIsThatOfTwo) {
  for (const double step_s : {0.02, 0.12, 0.2, 0.5, 1.0}) {
    const std::vector<double> first = at_rate(0.0, 60, step_s);
    EXPECT_EQ(starts_again(then(first, at_rate(0.3 * step_s, 60, step_s))), Row(60u)) << step_s;
    EXPECT_EQ(starts_again(then(first, at_rate(60.0 * step_s, 60, step_s))), Row()) << step_s;
    EXPECT_EQ(starts_again(then(at_rate(20.0 * step_s, 40, step_s), at_rate(0.0, 20, step_s))),
              Row())
        << step_s;
  }
  // Of two rates.
  EXPECT_EQ(starts_again(then(at_rate(0.0, 60, 0.2), at_rate(0.3, 600, 0.01))), Row(60u));
  EXPECT_EQ(starts_again(then(at_rate(0.0, 600, 0.01), at_rate(0.3, 20, 0.2))), Row(600u));
}

// Rows that are seldom or in disorder are no slow recording.
TEST(TableOrder, OfLateRowsAndOfRowsInTurnsIsThatOfOneRecording) {
  std::vector<double> arrived, later, last;
  const std::vector<double> all = at_rate(8.0, 200, 0.02);
  for (std::size_t i = 0; i < all.size(); ++i)
    (i % 7 == 3 ? later : i % 7 == 5 ? last : arrived).push_back(all[i]);
  EXPECT_EQ(starts_again(then(then(arrived, later), last)), Row());
  for (const std::size_t blocks : {2u, 3u, 5u, 8u}) {
    std::vector<double> turns;
    for (std::size_t i = 0; i < 60 * blocks; ++i) {
      turns.push_back(3.0 * static_cast<double>(i % blocks) +
                      0.02 * static_cast<double>(i / blocks));
    }
    EXPECT_EQ(starts_again(turns), Row()) << blocks;
  }
}

// Two gaps close to each other were taken for bursts, and their rows for a second recording.
TEST(TableOrder, OfTwoGapsWhoseRowsComeLaterIsThatOfOneRecording) {
  for (const double step_s : {0.001, 0.002, 0.005}) {
    for (const std::size_t gap : {12u, 20u, 30u}) {
      for (const std::size_t apart : {3u, 8u, 15u}) {
        const std::vector<double> all = at_rate(3.0, 3000, step_s);
        std::vector<double> arrived, late;
        for (std::size_t i = 0; i < all.size(); ++i) {
          const bool lost = (i >= 1000 && i < 1000 + gap) ||
                            (i >= 1000 + gap + apart && i < 1000 + 2 * gap + apart);
          (lost ? late : arrived).push_back(all[i]);
        }
        const auto after = arrived.begin() + 1000 + static_cast<std::ptrdiff_t>(1.0 / step_s);
        arrived.insert(after, late.begin(), late.end());
        EXPECT_EQ(starts_again(arrived), Row()) << step_s << ' ' << gap << ' ' << apart;
      }
    }
  }
}

// A gap is no place where rows follow each other, but the row before it and the one behind it are.
TEST(TableOrder, OfFiveRowsThatLieAmongOthersIsThatOfTwoRecordings) {
  const std::vector<double> first = then(at_rate(0.0, 50, 0.02), at_rate(3.0, 50, 0.02));
  const auto rows = [&](std::size_t from, std::size_t to) {
    return std::vector<double>(first.begin() + static_cast<std::ptrdiff_t>(from),
                               first.begin() + static_cast<std::ptrdiff_t>(to));
  };
  EXPECT_EQ(starts_again(then(first, rows(45, 50))), Row(100u));  // to the one before the gap
  EXPECT_EQ(starts_again(then(first, rows(50, 55))), Row(100u));
  EXPECT_EQ(starts_again(then(first, rows(46, 50))), Row());
  EXPECT_EQ(starts_again(then(first, at_rate(1.5, 5, 0.02))), Row());
  EXPECT_EQ(starts_again(then(first, at_rate(0.002, 5, 0.004))), Row(100u));  // between two rows
  // Rows behind those that were given do not count.
  const std::vector<double> longer = then(first, rows(40, 50));
  EXPECT_EQ(starts_again(std::span(longer).first(104)), Row());
  EXPECT_EQ(starts_again(std::span(longer).first(105)), Row(100u));
}

TEST(TableOrder, StepsBackByMoreThanHalfASecond) {
  const std::vector<double> first = at_rate(0.0, 100, 1.0 / 64.0);
  // The third last is row 97, at 97/64 s.
  EXPECT_EQ(starts_again(then(first, at_rate(65.0 / 64.0, 20, 1.0 / 64.0))), Row());
  EXPECT_EQ(starts_again(then(first, at_rate(64.0 / 64.0, 20, 1.0 / 64.0))), Row(100u));
}

TEST(TableOrder, OfRowsThatShareTheirTimesIsThatOfTwoRecordings) {
  const auto each_twice = [](const std::vector<double>& times) {
    std::vector<double> twice;
    for (const double time : times) twice.insert(twice.end(), 2, time);
    return twice;
  };
  const std::vector<double> first = each_twice(at_rate(0.0, 60, 0.02));
  EXPECT_EQ(starts_again(then(first, each_twice(at_rate(0.005, 60, 0.02)))), Row(120u));
  EXPECT_EQ(starts_again(then(first, each_twice(at_rate(1.2, 60, 0.02)))), Row());
  // A slow one, in which each sixth row has the time of the one above it.
  std::vector<double> slow;
  for (int i = 0; i < 60; ++i) slow.insert(slow.end(), i % 5 == 4 ? 2 : 1, 0.2 * i);
  EXPECT_EQ(starts_again(then(slow, at_rate(0.06, 20, 0.2))), Row(slow.size()));
}

// Twenty rows say that a recording is slow, also where one in ten is earlier than the one above it.
TEST(TableOrder, OfASlowRecordingIsSaidByTwentyRows) {
  const auto again = [](std::vector<double> first) {
    return starts_again(then(first, at_rate(0.06, 10, 0.2)));
  };
  EXPECT_EQ(again(at_rate(0.0, 20, 0.2)), Row(20u));
  EXPECT_EQ(again(at_rate(0.0, 19, 0.2)), Row());
  std::vector<double> late = at_rate(0.0, 20, 0.2);
  std::swap(late[12], late[13]);
  std::swap(late[16], late[17]);
  EXPECT_EQ(again(late), Row(20u));
  std::swap(late[8], late[9]);
  EXPECT_EQ(again(late), Row());
  // By the lower quartile of its steps, wherever the short ones stand.
  for (std::size_t row = 1; row < 59; ++row) {
    std::vector<double> early = at_rate(0.0, 60, 0.2);
    early[row] -= 0.15;
    EXPECT_EQ(again(early), Row(60u)) << row;
  }
}

// The lower quartile of steps, not the one that stands there.
TEST(TableOrder, OfRowsOfWhichOthersAreMissingIsThatOfTwoRecordings) {
  std::vector<double> first;
  for (const double time : at_rate(0.0, 200, 0.01)) {
    const long row = std::lround(time / 0.01);
    if (row % 8 < 5) first.push_back(time);  // steps of 10, 10, 10, 10 and 40 ms
  }
  EXPECT_EQ(starts_again(then(first, at_rate(0.002, 20, 0.01))), Row(first.size()));
  std::vector<double> late;
  for (int i = 0; i < 25; ++i) late.insert(late.end(), {0.08 * i + 0.05, 0.08 * i + 0.06});
  EXPECT_EQ(starts_again(then(first, late)), Row());
}

// Rows that are lost again and again and come later were taken for a second recording, were they bursts.
TEST(TableOrder, OfSeveralRowsBetweenGapsIsThatOfBurstsOnlyWhereGapsAreLongAndMany) {
  const auto without = [](int of, int from, bool lost) {
    std::vector<double> times;
    for (int i = 0; i < 3000; ++i) {
      if ((i % of >= from) == lost) times.push_back(3.0 + 0.001 * i);
    }
    return times;
  };
  EXPECT_EQ(starts_again(then(without(8, 5, false), without(8, 5, true))), Row());  // short gaps
  EXPECT_EQ(starts_again(then(without(24, 10, false), without(24, 10, true))), Row());  // few
  EXPECT_EQ(starts_again(then(without(24, 6, false), without(24, 6, true))),
            Row(without(24, 6, false).size()));
}

// Five gaps say that rows come in bursts, also when the first recording was shorter than sixty rows there.
TEST(TableOrder, OfBurstsOfEightRowsIsSaidByFiveGaps) {
  std::vector<double> first;
  for (int burst = 0; burst < 60; ++burst) {
    for (int i = 0; i < 8; ++i) first.push_back(0.02 * burst + 3e-4 * i);
  }
  const std::vector<double> fourth = {0.065, 0.067, 0.069, 0.071, 0.073};
  const std::vector<double> fifth = {0.085, 0.087, 0.089, 0.091, 0.093};
  EXPECT_EQ(starts_again(then(first, fourth)), Row());
  EXPECT_EQ(starts_again(then(first, fifth)), Row(first.size()));
}

/// Rows with one at `time_s` in the place of the one that is missing between them.
bool is_stray_at(double time_s, std::vector<double> above, const std::vector<double>& below) {
  const std::size_t row = above.size();
  above.push_back(time_s);
  return is_stray(then(std::move(above), below), row);
}

TEST(StrayRow, HasTwoRowsAboveAndTwoBelow) {
  std::vector<double> times = at_rate(1.0, 40, 0.02);
  times[17] = 9.0;
  const std::span<const double> all = times;
  EXPECT_TRUE(is_stray(all, 17));
  EXPECT_FALSE(is_stray(all, 16));
  EXPECT_TRUE(is_stray(all.subspan(15), 2));
  EXPECT_FALSE(is_stray(all.subspan(16), 1));
  EXPECT_FALSE(is_stray(all.subspan(17), 0));
  EXPECT_TRUE(is_stray(all.first(20), 17));
  EXPECT_FALSE(is_stray(all.first(19), 17));
  EXPECT_FALSE(is_stray(all.first(18), 17));
}

TEST(StrayRow, IsMoreThanHalfASecondFromThoseAroundIt) {
  EXPECT_TRUE(is_stray_at(9.0, {0.92, 1.0}, {1.16, 1.24}));
  EXPECT_TRUE(is_stray_at(0.49, {0.92, 1.0}, {1.16, 1.24}));
  EXPECT_FALSE(is_stray_at(0.55, {0.92, 1.0}, {1.16, 1.24}));  // 0.45 s and 0.61 s
  EXPECT_FALSE(is_stray_at(1.61, {0.92, 1.0}, {1.16, 1.24}));
  const double step = 1.0 / 64.0;
  EXPECT_FALSE(is_stray_at(1.0 - 0.5, {1.0 - step, 1.0}, {1.0 + 2 * step, 1.0 + 3 * step}));
  EXPECT_TRUE(is_stray_at(1.0 - 0.51, {1.0 - step, 1.0}, {1.0 + 2 * step, 1.0 + 3 * step}));
}

TEST(StrayRow, IsWhereOneRowIsMissing) {
  // Longer than one and a half of the steps on both sides, and below 0.2 s.
  EXPECT_FALSE(is_stray_at(9.0, {0.94, 1.0}, {1.04, 1.06}));
  EXPECT_FALSE(is_stray_at(9.0, {0.98, 1.0}, {1.04, 1.10}));
  EXPECT_TRUE(is_stray_at(9.0, {0.98, 1.0}, {1.04, 1.06}));
  const double step = 1.0 / 32.0;
  EXPECT_FALSE(is_stray_at(9.0, {1.0 - step, 1.0}, {1.0 + 1.5 * step, 1.0 + 2.5 * step}));
  EXPECT_FALSE(is_stray_at(9.0, {1.0, 1.0}, {1.1, 1.1}));
  EXPECT_FALSE(is_stray_at(9.0, {-0.1, 0.0}, {0.2, 0.3}));
  EXPECT_TRUE(is_stray_at(9.0, {-0.1, 0.0}, {0.19, 0.29}));
}

// Fewer than twenty rows were always merged with those of a second recording.
TEST(TableOrder, OfAFewEvenRowsIsSaidByTwentyInOrderBelow) {
  for (const double step_s : {0.12, 0.2, 1.0}) {
    for (const std::size_t rows : {9u, 12u, 19u}) {
      const std::vector<double> first = at_rate(0.0, rows, step_s);
      const auto again = [&](const std::vector<double>& second) {
        return starts_again(then(first, second));
      };
      EXPECT_EQ(again(at_rate(0.3 * step_s, 20, step_s)), Row(rows)) << step_s;
      EXPECT_EQ(again(at_rate(0.3 * step_s, 40, step_s)), Row(rows)) << step_s;
      EXPECT_EQ(again(at_rate(0.0, 300, 0.02)), Row(rows)) << step_s;
      EXPECT_EQ(again(at_rate(0.3 * step_s, 19, step_s)), Row()) << step_s;
      EXPECT_EQ(again(at_rate(-40.0 * step_s, 40, step_s)), Row()) << step_s;  // earlier rows
      std::vector<double> disorder = at_rate(0.3 * step_s, 40, step_s);
      std::swap(disorder[17], disorder[18]);
      EXPECT_EQ(again(disorder), Row()) << step_s;
    }
  }
  const auto then_second = [](const std::vector<double>& first) {
    return starts_again(then(first, at_rate(0.06, 40, 0.2)));
  };
  EXPECT_EQ(then_second(at_rate(0.0, 6, 0.2)), Row(6u));
  EXPECT_EQ(then_second(at_rate(0.0, 5, 0.2)), Row());  // too few
  EXPECT_EQ(then_second({0.0, 0.2, 0.4, 0.69, 0.89, 1.09, 1.29}), Row(7u));
  EXPECT_EQ(then_second({0.0, 0.2, 0.4, 0.71, 0.91, 1.11, 1.31}), Row());  // with a gap
  // Rows of nineteen blocks in turns are as even.
  std::vector<double> turns;
  for (int i = 0; i < 19 * 40; ++i) turns.push_back(i % 19 + 0.02 * (i / 19));
  EXPECT_EQ(starts_again(turns), Row());
}

// Where rows stand twice, as those of two objects do, half of the steps are 0, and none was found to be slow.
TEST(TableOrder, OfRowsThatStandTwiceIsSaidByAsManyTimes) {
  const auto twice = [](std::vector<double> times) {
    for (std::size_t i = times.size(); i-- > 0;) {
      times.insert(times.begin() + static_cast<std::ptrdiff_t>(i), times[i]);
    }
    return times;
  };
  for (const double step_s : {0.12, 0.2, 1.0}) {
    for (const std::size_t rows : {10u, 19u, 20u, 40u}) {
      const std::vector<double> first = twice(at_rate(0.0, rows, step_s));
      const auto again = [&](std::size_t below) {
        return starts_again(then(first, twice(at_rate(0.3 * step_s, below, step_s))));
      };
      EXPECT_EQ(again(20), Row(2 * rows)) << step_s << ' ' << rows;
      EXPECT_EQ(again(19), rows < 20 ? Row() : Row(2 * rows)) << step_s << ' ' << rows;
    }
  }
  const auto then_second = [&](std::size_t rows) {
    return starts_again(then(twice(at_rate(0.0, rows, 0.2)), twice(at_rate(0.06, 40, 0.2))));
  };
  EXPECT_EQ(then_second(6), Row(12u));
  EXPECT_EQ(then_second(5), Row());
}

}  // namespace
}  // namespace headpin::devices
