// Which tables hold two recordings, by the order of their rows.

#include "devices/recordings/table_order.h"

#include <cstddef>
#include <optional>
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

}  // namespace
}  // namespace headpin::devices
