#include "devices/base/sequence_count.h"

#include <algorithm>
#include <random>
#include <set>
#include <vector>

#include <gtest/gtest.h>

namespace headpin::devices {
namespace {

Time measured(std::int64_t number) {
  return Time{8'333 * number};
}

TEST(SequenceCount, CountsWhatDidNotCome) {
  SequenceCount count;
  for (const std::int64_t number : {5, 6, 9, 10}) count.take(number, measured(number));
  EXPECT_EQ(count.lost(), 2);
  EXPECT_EQ(count.repeated(), 0);
}

// A network may repeat datagrams and let one overtake another: nothing is lost by that.
TEST(SequenceCount, NeitherRepeatsNorDetoursAreLosses) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<std::int64_t> sent;
    std::set<std::int64_t> kept;
    for (std::int64_t number = 0; number < 500; ++number) {
      const bool inner = number > 0 && number < 499;  // the ends tell what there was
      if (inner && random() % 5 == 0) continue;
      kept.insert(number);
      sent.push_back(number);
      if (random() % 3 == 0) sent.push_back(number);
    }
    for (std::size_t i = 1; i + 4 < sent.size(); i += 4) {
      std::shuffle(sent.begin() + static_cast<std::ptrdiff_t>(i),
                   sent.begin() + static_cast<std::ptrdiff_t>(i + 3), random);
    }
    SequenceCount count;
    std::int64_t told = 0;
    for (const std::int64_t number : sent) told += count.take(number, measured(number));
    EXPECT_EQ(count.lost(), 500 - static_cast<std::int64_t>(kept.size())) << trial;
    EXPECT_EQ(told, count.lost());
    EXPECT_EQ(count.repeated(), static_cast<std::int64_t>(sent.size() - kept.size())) << trial;
  }
}

TEST(SequenceCount, WhoStartsAgainNumbersFromTheStart) {
  SequenceCount count;
  for (int number = 0; number < 100; ++number) count.take(number, measured(number));
  for (int number = 0; number < 50; ++number) {
    if (number != 20) count.take(number, measured(200 + number));
  }
  EXPECT_EQ(count.lost(), 1);
  EXPECT_EQ(count.repeated(), 0);
}

TEST(SequenceCount, WhoDoesNotNumberLosesNothing) {
  SequenceCount count;
  for (int i = 0; i < 100; ++i) count.take(0, measured(i));
  EXPECT_EQ(count.lost(), 0);
  EXPECT_EQ(count.repeated(), 0);
}

// 4 is overtaken by all that follow, of which none is lost in the end.
TEST(SequenceCount, ALateSampleIsKnownHoweverManyOvertookIt) {
  SequenceCount count;
  count.take(3, measured(3));
  for (std::int64_t number = 5; number < 500; ++number) {
    const std::int64_t swapped = number % 4 == 2   ? number + 1
                                 : number % 4 == 3 ? number - 1
                                                   : number;
    count.take(swapped, measured(swapped));
  }
  EXPECT_EQ(count.lost(), 1);
  EXPECT_EQ(count.take(4, measured(4)), -1);
  EXPECT_EQ(count.lost(), 0);
  EXPECT_EQ(count.repeated(), 0);
}

TEST(SequenceCount, TheGapsOfTheLastSixtyFourAreSearchedForALateSample) {
  for (const int gaps : {64, 65}) {
    SequenceCount count;
    for (int i = 0; i <= gaps; ++i) count.take(2 * i, measured(2 * i));
    EXPECT_EQ(count.lost(), gaps);
    EXPECT_EQ(count.take(1, measured(1)), gaps == 64 ? -1 : 0);
    EXPECT_EQ(count.take(3, measured(3)), -1);
  }
}

// What was missing of one numbering is not what comes twice of the next.
TEST(SequenceCount, ANewNumberingForgetsTheGapsOfTheOldOne) {
  for (const std::int64_t first : {1, 9}) {  // 9 is also the last number of the old one
    SequenceCount count;
    for (const std::int64_t number : {0, 1, 9}) count.take(number, measured(number));
    EXPECT_EQ(count.lost(), 7);
    for (std::int64_t number = first; number < 20; ++number) {
      count.take(number, measured(100 + number));
    }
    EXPECT_EQ(count.take(5, measured(105)), 0) << first;
    EXPECT_EQ(count.lost(), 7) << first;
    EXPECT_EQ(count.repeated(), 1) << first;
  }
  SequenceCount count;
  for (const std::int64_t number : {0, 1, 9}) count.take(number, measured(number));
  count.begin_anew();
  EXPECT_EQ(count.take(20, measured(20)), 0);
  EXPECT_EQ(count.take(5, measured(5)), 0);
  EXPECT_EQ(count.lost(), 7);
}

}  // namespace
}  // namespace headpin::devices
