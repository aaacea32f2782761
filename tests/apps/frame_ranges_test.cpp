#include "apps/frame_ranges.h"

#include <gtest/gtest.h>

#include "apps/command.h"

namespace headpin::apps {
namespace {

TEST(FrameRangesTest, HoldBothEndsOfARangeAndSingleFrames) {
  const FrameRanges ranges("10-20,35");
  for (const int inside : {10, 15, 20, 35}) EXPECT_TRUE(ranges.contains(inside)) << inside;
  for (const int outside : {0, 9, 21, 34, 36}) EXPECT_FALSE(ranges.contains(outside)) << outside;
  EXPECT_EQ(ranges.count_below(100), 12);
  EXPECT_EQ(ranges.count_below(15), 5);
}

TEST(FrameRangesTest, NoneMeansAll) {
  EXPECT_EQ(FrameRanges().count_below(7), 7);
}

TEST(FrameRangesTest, RefuseWhatIsNoList) {
  for (const char* text :
       {"", "a", "1-", "-5", "3-2", "1,,2", "1;2", "1-2-3", "99999999999999999999"}) {
    EXPECT_THROW(FrameRanges{text}, UsageError) << text;
  }
}

}  // namespace
}  // namespace headpin::apps
