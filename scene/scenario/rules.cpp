#include "scene/scenario/rules.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace headpin::scene {

namespace {

constexpr std::array<Rules, kNames<GameKind>.size()> kRules{{
    {GameKind::one_throw, false, false, false, false},
    {GameKind::plain, true, false, false, false},
    {GameKind::ten_pin, true, false, false, true},
    {GameKind::ninepins, true, true, false, false},
    {GameKind::skittles, true, false, true, false},
}};

int sum(std::span<const int> rolls) {
  return std::accumulate(rolls.begin(), rolls.end(), 0);
}

/// Skittles down since they were last set within the frame.
int down_since_set(const Frame& frame, int rack) {
  int down = 0;
  for (const int roll : frame) down = down == rack ? roll : down + roll;
  return down;
}

/// Sum of the next balls of the game, as far as they have been thrown.
int next_balls(std::span<const Frame> later, int count) {
  int all = 0;
  for (const Frame& frame : later) {
    for (const int roll : frame) {
      if (count-- > 0) all += roll;
    }
  }
  return all;
}

}  // namespace

const Rules& rules_of(GameKind kind) {
  return *std::ranges::find(kRules, kind, &Rules::kind);
}

bool is_over(const Rules& rules, const Frame& frame, int rack, int balls, bool last) {
  const int thrown = static_cast<int>(frame.size());
  const int first = sum(
      std::span(frame).first(std::min<std::size_t>(frame.size(), static_cast<std::size_t>(balls))));
  if (rules.bonuses && last && first >= rack) {
    constexpr int kStrikeAndBonus = 3;
    return thrown == (frame[0] == rack ? std::max(balls + 1, kStrikeAndBonus) : balls + 1);
  }
  if (thrown >= balls) return true;
  return !rules.full_rack && !rules.set_again && thrown > 0 && sum(frame) >= rack;
}

bool is_set_again(const Rules& rules, const Frame& frame, int rack) {
  return rules.full_rack || (!frame.empty() && down_since_set(frame, rack) == rack);
}

int points(const Rules& rules, std::span<const Frame> frames, int rack) {
  int all = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const Frame& frame = frames[i];
    all += sum(frame);
    if (!rules.bonuses || frame.empty()) continue;
    const std::span<const Frame> later = frames.subspan(i + 1);
    if (frame.size() == 1 && frame[0] == rack) all += next_balls(later, 2);
    if (frame.size() == 2 && frame[0] < rack && frame[0] + frame[1] == rack) {
      all += next_balls(later, 1);
    }
  }
  return all;
}

std::string ball_in_words(const Rules& rules, const Frame& frame, std::size_t ball, int rack) {
  const int roll = frame[ball];
  if (rules.bonuses) {
    const Frame before(frame.begin(), frame.begin() + static_cast<std::ptrdiff_t>(ball));
    const int down = before.empty() ? rack : down_since_set(before, rack);
    if (down == rack && roll == rack) return "X";
    if (down < rack && down + roll == rack) return "/";
  }
  return roll == 0 ? "-" : std::to_string(roll);
}

std::string in_words(const Rules& rules, std::span<const Frame> frames, int rack) {
  std::string text;
  for (const Frame& frame : frames) {
    if (frame.empty()) continue;
    if (!text.empty()) text += " | ";
    for (std::size_t ball = 0; ball < frame.size(); ++ball) {
      if (ball > 0) text += ' ';
      text += ball_in_words(rules, frame, ball, rack);
    }
  }
  return text;
}

}  // namespace headpin::scene
