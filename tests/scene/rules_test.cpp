#include "scene/scenario/rules.h"

#include <gmock/gmock.h>

namespace headpin::scene {
namespace {

const Rules& kTenPin = rules_of(GameKind::ten_pin);

/// Plays rolls by the rules as far as they go, setting skittles as those say.
std::vector<Frame> play(const Rules& rules, const std::vector<int>& rolls, int rack, int balls,
                        std::size_t count) {
  std::vector<Frame> frames(1);
  for (const int roll : rolls) {
    frames.back().push_back(roll);
    const bool last = frames.size() == count;
    if (!is_over(rules, frames.back(), rack, balls, last)) continue;
    if (last) break;
    frames.emplace_back();
  }
  return frames;
}

int ten_pin(const std::vector<int>& rolls) {
  return points(kTenPin, play(kTenPin, rolls, 10, 2, 10), 10);
}

TEST(Rules, TenPinCountsStrikesAndSpares) {
  EXPECT_EQ(ten_pin(std::vector<int>(12, 10)), 300);
  EXPECT_EQ(ten_pin(std::vector<int>(21, 5)), 150);
  EXPECT_EQ(ten_pin(std::vector<int>(20, 4)), 80);
  EXPECT_EQ(ten_pin(std::vector<int>(20, 0)), 0);
  // 20, 39, 48, 66, 74, 84, 90, 120, 148, 167 after the frames.
  const std::vector<int> mixed = {10, 7, 3, 9, 0, 10, 0, 8, 8, 2, 0, 6, 10, 10, 10, 8, 1};
  EXPECT_EQ(ten_pin(mixed), 167);
  EXPECT_EQ(in_words(kTenPin, play(kTenPin, mixed, 10, 2, 10), 10),
            "X | 7 / | 9 - | X | - 8 | 8 / | - 6 | X | X | X 8 1");
  // What is still to come counts for nothing yet.
  EXPECT_EQ(ten_pin({10}), 10);
  EXPECT_EQ(ten_pin({10, 3}), 16);
  EXPECT_EQ(ten_pin({10, 3, 4}), 24);
}

TEST(Rules, TheLastFrameOfTenPinIsPlayedOut) {
  const auto over = [](const Frame& frame) { return is_over(kTenPin, frame, 10, 2, true); };
  EXPECT_FALSE(over({10}));
  EXPECT_FALSE(over({10, 3}));
  EXPECT_TRUE(over({10, 3, 6}));
  EXPECT_FALSE(over({4, 6}));
  EXPECT_TRUE(over({4, 6, 10}));
  EXPECT_TRUE(over({4, 5}));
  const auto over_by_one_ball = [](const Frame& frame) {
    return is_over(kTenPin, frame, 10, 1, true);
  };
  EXPECT_TRUE(over_by_one_ball({9}));
  EXPECT_FALSE(over_by_one_ball({10, 10}));  // a strike has two bonus balls in any frame
  EXPECT_TRUE(over_by_one_ball({10, 10, 10}));
  EXPECT_TRUE(is_set_again(kTenPin, {10}, 10));
  EXPECT_FALSE(is_set_again(kTenPin, {10, 3}, 10));
  EXPECT_TRUE(is_set_again(kTenPin, {4, 6}, 10));
  EXPECT_FALSE(is_set_again(kTenPin, {4}, 10));
}

TEST(Rules, NinepinsHasAllBeforeEveryBallAndSkittlesWhenNoneIsLeft) {
  const Rules& ninepins = rules_of(GameKind::ninepins);
  EXPECT_TRUE(is_set_again(ninepins, {4}, 9));
  EXPECT_FALSE(is_over(ninepins, {9}, 9, 2, false));
  EXPECT_EQ(points(ninepins, std::vector<Frame>{{9, 9}, {4, 5}}, 9), 27);
  const Rules& skittles = rules_of(GameKind::skittles);
  EXPECT_FALSE(is_set_again(skittles, {4}, 9));
  EXPECT_TRUE(is_set_again(skittles, {4, 5}, 9));
  EXPECT_FALSE(is_over(skittles, {9, 9}, 9, 3, false));
  EXPECT_TRUE(is_over(skittles, {9, 9, 9}, 9, 3, true));
  EXPECT_EQ(points(skittles, std::vector<Frame>{{9, 9, 9}}, 9), 27);
  EXPECT_EQ(in_words(skittles, std::vector<Frame>{{9, 0, 3}, {}}, 9), "9 - 3");
}

TEST(Rules, AreTheOnesOfEachName) {
  EXPECT_EQ(value_named<GameKind>("ten-pin"), GameKind::ten_pin);
  EXPECT_EQ(value_named<GameKind>("cricket"), std::nullopt);
  for (const auto& [kind, name] : kNames<GameKind>) EXPECT_EQ(rules_of(kind).kind, kind) << name;
}

}  // namespace
}  // namespace headpin::scene
