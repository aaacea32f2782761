// A rack of ten as filmed and measured by the USBC, under the response of 1997 and the regulation lane
// as it comes: nothing was fitted. The whole map: ./dev check pins, docs/pins.md.

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "scene/stage/read_scenario.h"
#include "tests/support/strike.h"

namespace headpin::scene {
namespace {

const Stage& regulation_lane() {
  static const Stage stage =
      make_stage(load_scenario(HEADPIN_SOURCE_DIR "/assets/scenarios/regulation-ten-pin.toml"));
  return stage;
}

/// Throws of a board and an angle, as near to them as a good player's.
std::vector<Fallen> throws_of(double board, double angle_deg, int count) {
  std::vector<Fallen> all;
  for (int k = 0; k < count; ++k) {
    Random random(7, static_cast<std::uint64_t>(10 * board), static_cast<std::uint64_t>(k));
    all.push_back(roll(regulation_lane(),
                       {.board = board + random.uniform(-0.25, 0.25),
                        .angle_deg = angle_deg + random.uniform(-1.0, 1.0),
                        .speed = 7.6 + 0.2 * random.normal()},
                       random));
  }
  return all;
}

template <typename Is>
double share(const std::vector<Fallen>& throws, Is is) {
  return static_cast<double>(std::ranges::count_if(throws, is)) /
         static_cast<double>(throws.size());
}

// Best board at the pins: 17.5, of a pocket from 17 to 18 (USBC carry study).
TEST(Pins, ArePocketedAtBoardSeventeenAndAHalf) {
  constexpr int kThrows = 6;
  double strikes = 0.0, boards = 0.0;
  for (double board = 15.0; board <= 20.0; board += 0.5) {
    const double here =
        share(throws_of(board, 6.0, kThrows), [](const Fallen& f) { return f.strike(); });
    strikes += here;
    boards += here * board;
  }
  RecordProperty("pocket", std::to_string(boards / strikes));
  EXPECT_NEAR(boards / strikes, 17.5, 0.5);
  EXPECT_GT(strikes * 0.5, 0.5) << "half a board wide at least";
  EXPECT_LT(strikes * 0.5, 2.0) << "two boards at most";
}

// A flush ball touches 1, 3, 5 and 9 alone, and leaves the deck about board 19 (Ridenour's films).
TEST(Pins, OfAFlushHitMeetTheBallInTheOrderOneThreeFiveNine) {
  const std::vector<Fallen> flush = throws_of(17.5, 5.0, 12);
  const double by_film = share(flush, [](const Fallen& f) {
    return f.touched == std::vector<int>{1, 3, 5, 9};
  });
  double exit = 0.0;
  for (const Fallen& f : flush) exit += f.exit_board / static_cast<double>(flush.size());
  RecordProperty("by_film", std::to_string(by_film));
  RecordProperty("exit", std::to_string(exit));
  EXPECT_GT(by_film, 0.7);
  EXPECT_NEAR(exit, 19.0, 1.0);
}

// Board 16.5 at a high angle: the 3 pin sends the 6 past the 10, which stays (Ridenour's films).
TEST(Pins, OfALightHitLeaveTheTen) {
  const std::vector<Fallen> light = throws_of(16.5, 6.0, 6);
  const double ten = share(light, [](const Fallen& f) { return f.standing == std::vector{10}; });
  RecordProperty("ten", std::to_string(ten));
  EXPECT_GT(ten, 0.6);
}

// Too high, at a small angle: the 4 or the 7 stays, alone or with others, and no strike.
TEST(Pins, OfAHighHitLeaveTheFourOrTheSeven) {
  const std::vector<Fallen> high = throws_of(19.5, 2.0, 6);
  const double left = share(high, [](const Fallen& f) {
    return std::ranges::find(f.standing, 4) != f.standing.end() ||
           std::ranges::find(f.standing, 7) != f.standing.end();
  });
  RecordProperty("four_or_seven", std::to_string(left));
  EXPECT_GT(left, 0.7);
}

}  // namespace
}  // namespace headpin::scene
