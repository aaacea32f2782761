#include "apps/frame_ranges.h"

#include <gtest/gtest.h>

#include "apps/command.h"

namespace headpin::apps {
namespace {

TEST(FrameRangesTest, HoldBothEndsOfARangeAndSingleFrames) {
  const FrameRanges ranges("10-20,35");
  for (const int inside : {10, 15, 20, 35}) EXPECT_TRUE(ranges.contains(inside)) << inside;
  for (const int outside : {0, 9, 21, 34, 36}) EXPECT_FALSE(ranges.contains(outside)) << outside;
}

TEST(FrameRangesTest, NoneMeansAll) {
  EXPECT_TRUE(FrameRanges().contains(0));
  EXPECT_TRUE(FrameRanges().contains(1'000'000));
  EXPECT_EQ(FrameRanges().first_not_in({}), std::nullopt);
}

TEST(FrameRangesTest, TellTheFirstFrameThatIsNotThere) {
  const std::vector<std::int64_t> frames = {3, 4, 5, 8};
  EXPECT_EQ(FrameRanges("3-5,8").first_not_in(frames), std::nullopt);
  EXPECT_EQ(FrameRanges("8,4-6").first_not_in(frames), 6);
  EXPECT_EQ(FrameRanges("5-9223372036854775807").first_not_in(frames), 6);
}

TEST(FrameRangesTest, RefuseWhatIsNoList) {
  for (const char* text :
       {"", "a", "1-", "-5", "3-2", "1,,2", "1;2", "1-2-3", "99999999999999999999"}) {
    EXPECT_THROW(FrameRanges{text}, UsageError) << text;
  }
}

}  // namespace
}  // namespace headpin::apps
