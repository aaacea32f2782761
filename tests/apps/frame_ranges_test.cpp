#include "apps/frame_ranges.h"

#include <gtest/gtest.h>

#include "apps/command.h"

namespace headpin::apps {
namespace {

TEST(FrameRangesTest, HoldBothEndsOfARangeAndSingleFrames) {
  const FrameRanges ranges("10-20,35");
  for (const int inside : {10, 15, 20, 35}) EXPECT_TRUE(ranges.contains(inside, Time{})) << inside;
  for (const int outside : {0, 9, 21, 34, 36})
    EXPECT_FALSE(ranges.contains(outside, Time{})) << outside;
}

TEST(FrameRangesTest, NoneMeansAll) {
  EXPECT_TRUE(FrameRanges().contains(0, Time{}));
  EXPECT_TRUE(FrameRanges().contains(1'000'000, Time{}));
  EXPECT_EQ(FrameRanges().first_not_in({}), std::nullopt);
}

TEST(FrameRangesTest, HoldTheTimesOfASpan) {
  for (const char* text : {"3.9s-4.1s", "3.9-4.1s", "2,3.9s-4.1s"}) {
    const FrameRanges ranges(text);
    for (const double inside : {3.9, 4.0, 4.1}) {
      EXPECT_TRUE(ranges.contains(7, microseconds(inside))) << text;
    }
    for (const double outside : {0.0, 3.899999, 4.100001}) {
      EXPECT_FALSE(ranges.contains(7, microseconds(outside))) << text;
    }
    EXPECT_EQ(ranges.contains(2, Time{}), text[1] == ',');
  }
}

TEST(FrameRangesTest, TellTheFirstFrameThatIsNotThere) {
  const std::vector<std::int64_t> frames = {3, 4, 5, 8};
  EXPECT_EQ(FrameRanges("3-5,8").first_not_in(frames), std::nullopt);
  EXPECT_EQ(FrameRanges("8,4-6").first_not_in(frames), 6);
  EXPECT_EQ(FrameRanges("5-9223372036854775807").first_not_in(frames), 6);
}

TEST(FrameRangesTest, RefuseWhatIsNoList) {
  for (const char* text :
       {"", "a", "1-", "-5", "3-2", "1,,2", "1;2", "1-2-3", "99999999999999999999", "4s", "4s-5",
        "4.1s-3.9s", "-1s-2s", "nans-4s", "1s-infs", "1s-2s-3s"}) {
    EXPECT_THROW(FrameRanges{text}, UsageError) << text;
  }
}

}  // namespace
}  // namespace headpin::apps
