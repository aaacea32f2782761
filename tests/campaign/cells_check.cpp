#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <optional>
#include <string>
#include <vector>

#include "devices/base/sources.h"
#include "devices/recordings/motion_files.h"
#include "scene/people/arm_model.h"
#include "scene/people/throw.h"
#include "scene/people/throw_checks.h"
#include "scene/play/run.h"
#include "scene/record/events.h"

// Whether each cell of Table 1 (Uno & Slater 1997) is a game: how many throws reach the skittles of
// the paper's room, and how many fall.
//
//   cells_check [PLAYERS [RECORDING]]   seeds 1 to PLAYERS; 200 if not said. RECORDING is a throw of
//                                       the motion catalogue, thrown in every cell too.
//
// Prints the table of docs/cells.md. Exit code 1 when a cell is no game.
namespace {

using namespace headpin;
using namespace headpin::scene;

/// One row of the table, as the paper names it: EFS.
struct Cell {
  int e, f, s;
};

Scenario scenario_of(const Cell& cell) {
  Scenario scenario;
  set_elasticity(scenario.material, cell.e ? 0.7 : 1.0);
  set_friction(scenario.material, cell.f ? 0.7 : 0.0);
  scenario.collision.shape = cell.s ? SkittleShape::parts : SkittleShape::ellipsoid;
  scenario.game.rules =
      GameKind::plain;  // a delivery is counted at rest, or ball_back_s after the release
  scenario.game.frames = 1;
  scenario.game.balls = 1;
  return scenario;
}

struct Outcome {
  bool reached = false;
  int down = 0;
};

Outcome play(const Scenario& scenario, const std::vector<devices::Sample>& samples) {
  Session session = make_session(scenario);
  devices::ReplaySource source(samples);
  Outcome outcome;
  while (!session.game.over && session.now() < Time{30'000'000}) {
    advance(session, source);
    for (const scene::Event& event : session.events) {
      if (event.kind == kind::first_contact) outcome.reached = true;
      if (event.kind == kind::delivery) outcome.down = static_cast<int>(event.value);
    }
  }
  return outcome;
}

Outcome throw_once(Scenario scenario, std::uint64_t seed, std::optional<double> height) {
  const ThrowMotion motion({.seed = seed, .height = height}, scenario.hand);
  set_up(scenario, motion);
  return play(scenario, sense(motion, scenario.rig, seed));
}

/// Throws of one kind, by all players of a cell.
struct Throws {
  int count = 0, reached = 0;
  int down = 0;

  void add(const Outcome& outcome) {
    ++count;
    reached += outcome.reached ? 1 : 0;
    down += outcome.down;
  }
  double share() const { return 100.0 * reached / count; }
  double mean() const { return static_cast<double>(down) / count; }
};

constexpr double kLaidDown = 0.14;  // height of the ball's centre, 3 cm above the lane [m]
constexpr int kBalls = 4;           // of a player who adapts

/// Where a player lets go who missed so many times: first as he stands, then ever lower.
std::optional<double> height_after(int misses) {
  if (misses == 0) return {};
  return kLaidDown + 0.13 * (kBalls - 1 - misses);
}

struct Row {
  Throws standing, laid_down;
  int reached_by[kBalls] = {};  ///< players who adapt, by how many balls they needed
};

Row row(const Cell& cell, int players) {
  const Scenario scenario = scenario_of(cell);
  Row result;
  for (int k = 1; k <= players; ++k) {
    const auto seed = static_cast<std::uint64_t>(k);
    const Outcome standing = throw_once(scenario, seed, {});
    result.standing.add(standing);
    result.laid_down.add(throw_once(scenario, seed, kLaidDown));
    Outcome last = standing;
    for (int ball = 0; ball < kBalls; ++ball) {
      if (ball > 0) {  // another throw of the same player: its own tremor and errors
        last = throw_once(scenario, seed + 100'000 * static_cast<std::uint64_t>(ball),
                          height_after(ball));
      }
      if (!last.reached) continue;
      ++result.reached_by[ball];
      break;
    }
  }
  return result;
}

std::optional<Outcome> recorded(const Cell& cell, const char* file) {
  if (file == nullptr) return {};
  const devices::MotionRecording recording = devices::read_motion(file, {});
  Scenario scenario = scenario_of(cell);
  const Side side = throwing_side(recording, scenario.hand);
  const Throw found = find_throw(recording, scenario.hand, side);
  scenario = stand_thrower(scenario, recording, found, Heading::release);
  return play(scenario, to_samples(recording, found));
}

/// @return  whether the cell is a game
bool show(const Cell& cell, const Row& row, const std::optional<Outcome>& real) {
  std::printf("| %d%d%d | %.1f | %.1f | %-9s | %3.0f %% | %.1f | %3.0f %% | %.1f |", cell.e, cell.f,
              cell.s, cell.e ? 0.7 : 1.0, cell.f ? 0.7 : 0.0, cell.s ? "true" : "ellipsoid",
              row.standing.share(), row.standing.mean(), row.laid_down.share(),
              row.laid_down.mean());
  int so_far = 0;
  for (const int players : row.reached_by) {
    so_far += players;
    std::printf(" %.0f", 100.0 * so_far / row.standing.count);
  }
  std::printf(" %% |");
  if (real) std::printf(" %s |", real->reached ? std::to_string(real->down).c_str() : "-");
  std::printf("\n");
  std::fflush(stdout);
  return row.laid_down.share() >= 95.0 && 100.0 * so_far >= 95.0 * row.standing.count;
}

int check_all(int players, const char* file) {
  std::printf(
      "| EFS | elasticity | friction | shape | standing: reach | down | laid down: reach "
      "| down | adapting: reach by ball 1 2 3 4 |%s\n|%s%s\n",
      file ? " recorded: down |" : "", "---|---|---|---|---|---|---|---|---|", file ? "---|" : "");
  int games = 0;
  for (int k = 0; k < 8; ++k) {
    const Cell cell{k >> 2 & 1, k >> 1 & 1, k & 1};
    games += show(cell, row(cell, players), recorded(cell, file)) ? 1 : 0;
  }
  return games == 8 ? 0 : 1;
}

}  // namespace

int main(int count, char** arguments) {
  char* end = nullptr;
  const long players = count > 1 ? std::strtol(arguments[1], &end, 10) : 200;
  if (count > 3 || players < 1 || players > 10'000 || (end != nullptr && *end != '\0')) {
    std::fprintf(stderr, "usage: cells_check [PLAYERS, 1 to 10000 [RECORDING]]\n");
    return 2;
  }
  try {
    return check_all(static_cast<int>(players), count > 2 ? arguments[2] : nullptr);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "cells_check: %s\n", error.what());
    return 1;
  }
}
