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

}  // namespace
}  // namespace headpin::devices
