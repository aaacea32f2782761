#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <tuple>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "scene/stage/read_scenario.h"
#include "tests/support/strike.h"

// How the pins fall: which boards and angles strike, what stays, and where the ball leaves the deck,
// on the regulation lane, under both responses.
//
//   pins_check [THROWS [CSV]]   of each board and angle; 200 if not said
//
// Prints the tables of docs/pins.md, and writes every cell to the CSV file.
namespace {

using namespace headpin;
using namespace headpin::scene;

constexpr double kLowBoard = 15.0, kHighBoard = 20.0;
constexpr int kBoardsOfMap = 11;  // in halves
constexpr std::array kAngles{0.0, 2.0, 4.0, 6.0, 8.0};
constexpr int kCells = kBoardsOfMap * static_cast<int>(kAngles.size());
constexpr double kSpeed = 7.6, kSpeedOff = 0.2;  // good players at the pins: 7.2 to 8.0 m/s

struct Condition {
  std::string_view response;
  double elasticity, friction;  // of every object; those of a pair multiply
};

/// As the scenario comes, and with what the USBC's manual has for ball and pin: 0.67.
constexpr std::array kConditions{Condition{"paper", 0.7, 0.7}, Condition{"paper", 0.8185, 0.7},
                                 Condition{"coulomb", 0.7, 0.7}, Condition{"coulomb", 0.8185, 0.3}};

/// What happened to the throws of a board and an angle.
struct Cell {
  double board = 0.0, angle = 0.0;
  int throws = 0, strikes = 0, flush = 0, left_deck = 0;
  double down = 0.0, exit_board = 0.0;  // sums
  std::map<std::string, int> leaves;

  void add(const Fallen& fallen) {
    ++throws;
    down += 10.0 - static_cast<double>(fallen.standing.size());
    strikes += fallen.strike() ? 1 : 0;
    flush += touches_flush(fallen.touched) ? 1 : 0;
    if (!fallen.strike()) ++leaves[fmt::format("{}", fmt::join(fallen.standing, "-"))];
    if (fallen.exit_board == 0.0) return;
    ++left_deck;
    exit_board += fallen.exit_board;
  }
  double share(int count) const { return 100.0 * count / throws; }
  double mean_exit() const { return exit_board / left_deck; }

 private:
  /// 1, 3, 5 and 9, and no other.
  static bool touches_flush(std::vector<int> touched) {
    std::sort(touched.begin(), touched.end());
    return touched == std::vector<int>{1, 3, 5, 9};
  }
};

using Map = std::vector<Cell>;

Stage stage_of(const Condition& condition) {
  Scenario scenario = load_scenario(HEADPIN_SOURCE_DIR "/assets/scenarios/regulation-ten-pin.toml");
  scenario.collision.response = condition.response;
  set_elasticity(scenario, condition.elasticity);
  set_friction(scenario, condition.friction);
  return make_stage(scenario);
}

/// The throws of a cell: boards and angles within it, speeds as those of good players.
void throw_all(const Stage& stage, std::uint64_t number, int throws, Cell& cell) {
  for (int k = 0; k < throws; ++k) {
    Random random(1, number, static_cast<std::uint64_t>(k));
    const Rolling rolling{.board = cell.board + random.uniform(-0.25, 0.25),
                          .angle_deg = cell.angle + random.uniform(-1.0, 1.0),
                          .speed = kSpeed + kSpeedOff * random.normal()};
    cell.add(roll(stage, rolling, random));
  }
}

/// The same whatever the number of threads.
Map map_of(const Condition& condition, int throws) {
  const Stage stage = stage_of(condition);
  Map map(kCells);
  std::atomic<int> next = 0;
  const auto work = [&] {
    for (int i = next++; i < kCells; i = next++) {
      Cell& cell = map[static_cast<std::size_t>(i)];
      cell.board = kLowBoard + 0.5 * (i % kBoardsOfMap);
      cell.angle = kAngles[static_cast<std::size_t>(i / kBoardsOfMap)];
      throw_all(stage, static_cast<std::uint64_t>(i), throws, cell);
    }
  };
  std::vector<std::thread> threads;
  for (unsigned k = 0; k < std::max(1u, std::thread::hardware_concurrency()); ++k) {
    threads.emplace_back(work);
  }
  for (std::thread& thread : threads) thread.join();
  return map;
}

void print_strikes(const Map& map) {
  std::printf("| strikes, %% | board 15 |");
  for (int b = 1; b < kBoardsOfMap; ++b) std::printf(" %g |", kLowBoard + 0.5 * b);
  std::printf("\n|---|");
  for (int b = 0; b < kBoardsOfMap; ++b) std::printf("---|");
  for (std::size_t a = 0; a < kAngles.size(); ++a) {
    std::printf("\n| %g degrees |", kAngles[a]);
    for (std::size_t b = 0; b < kBoardsOfMap; ++b) {
      const Cell& cell = map[a * kBoardsOfMap + b];
      std::printf(" %.0f |", cell.share(cell.strikes));
    }
  }
  std::printf("\n\n");
}

/// "10 (52 %), 7 (3 %)": the most frequent first.
std::string leaves_in_words(const Cell& cell, std::size_t most) {
  std::vector<std::pair<int, std::string>> sorted;
  for (const auto& [name, count] : cell.leaves) sorted.emplace_back(-count, name);
  std::sort(sorted.begin(), sorted.end());
  std::vector<std::string> words;
  for (std::size_t i = 0; i < std::min(most, sorted.size()); ++i) {
    const double share = cell.share(-sorted[i].first);
    words.push_back(share < 1.0 ? fmt::format("{} (< 1 %)", sorted[i].second)
                                : fmt::format("{} ({:.0f} %)", sorted[i].second, share));
  }
  return words.empty() ? "-" : fmt::format("{}", fmt::join(words, ", "));
}

void print_hits(const Map& map) {
  const auto cell_at = [&](double board, double angle) -> const Cell& {
    const auto found = std::find_if(map.begin(), map.end(), [&](const Cell& cell) {
      return cell.board == board && cell.angle == angle;
    });
    return *found;
  };
  std::printf(
      "| hit | strikes | touches 1, 3, 5, 9 alone | leaves the deck at board | stays |\n"
      "|---|---|---|---|---|\n");
  for (const auto& [name, board, angle] : {std::tuple{"flush: 17.5 at 6 degrees", 17.5, 6.0},
                                           {"17.5 at 4 degrees", 17.5, 4.0},
                                           {"light: 16.5 at 6 degrees", 16.5, 6.0},
                                           {"high: 19 at 4 degrees", 19.0, 4.0},
                                           {"high: 19.5 at 2 degrees", 19.5, 2.0}}) {
    const Cell& cell = cell_at(board, angle);
    std::printf("| %s | %.0f %% | %.0f %% | %.1f | %s |\n", name, cell.share(cell.strikes),
                cell.share(cell.flush), cell.mean_exit(), leaves_in_words(cell, 3).c_str());
  }
  double strikes = 0.0, throws = 0.0;
  for (const Cell& cell : map) {
    if (cell.board < 17.0 || cell.board > 18.0 || cell.angle < 4.0 || cell.angle > 6.0) continue;
    strikes += cell.strikes;
    throws += cell.throws;
  }
  std::printf("\nCarry, boards 17 to 18 at 4 to 6 degrees: %.0f %%.\n\n", 100.0 * strikes / throws);
}

void write_csv(std::FILE* file, const Condition& condition, const Map& map) {
  for (const Cell& cell : map) {
    std::fprintf(file, "%s,%g,%g,%g,%g,%d,%d,%g,%d,%.3f,", condition.response.data(),
                 condition.elasticity, condition.friction, cell.board, cell.angle, cell.throws,
                 cell.strikes, cell.down / cell.throws, cell.flush, cell.mean_exit());
    for (const auto& [name, count] : cell.leaves) std::fprintf(file, "%s:%d ", name.c_str(), count);
    std::fprintf(file, "\n");
  }
}

int check_all(int throws, const char* path) {
  std::FILE* file = path ? std::fopen(path, "w") : nullptr;
  if (path && !file) throw std::runtime_error(std::string(path) + ": cannot be written");
  if (file) {
    std::fprintf(file,
                 "response,elasticity,friction,board,angle_deg,throws,strikes,mean_down,flush,"
                 "exit_board,leaves\n");
  }
  for (const Condition& condition : kConditions) {
    std::printf("### Response %s, elasticity %g, friction %g: %.2f and %.2f for a pair\n\n",
                condition.response.data(), condition.elasticity, condition.friction,
                condition.elasticity * condition.elasticity,
                condition.friction * condition.friction);
    const Map map = map_of(condition, throws);
    print_strikes(map);
    print_hits(map);
    std::fflush(stdout);
    if (file) write_csv(file, condition, map);
  }
  if (file && std::fclose(file) != 0) {
    throw std::runtime_error(std::string(path) + ": cannot be written");
  }
  return 0;
}

}  // namespace

int main(int count, char** arguments) {
  char* end = nullptr;
  const long throws = count > 1 ? std::strtol(arguments[1], &end, 10) : 200;
  if (count > 3 || throws < 1 || throws > 100'000 || (end != nullptr && *end != '\0')) {
    std::fprintf(stderr, "usage: pins_check [THROWS, 1 to 100000 [CSV]]\n");
    return 2;
  }
  try {
    return check_all(static_cast<int>(throws), count > 2 ? arguments[2] : nullptr);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "pins_check: %s\n", error.what());
    return 1;
  }
}
