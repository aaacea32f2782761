#include <cstdio>
#include <string_view>

#include <gtest/gtest.h>

#include "tests/support/bowling.h"
#include "tests/support/scale.h"

namespace headpin::engine {
namespace {

const int kEveryOffset = kThorough ? 1 : 5;

struct Games {
  double down = 0.0;        // mean
  double correction = 0.0;  // most energy that pushing apart added in a game [J]
  double rise = -1e9;       // most that a game ended above what it began with [J]
  double overlap = 0.0;     // deepest [m]
};

Games games(const Query& query) {
  Games g;
  int count = 0;
  for (int k = 0; k <= 40; k += kEveryOffset) {
    RackOptions o;
    o.parameters.query = query;
    o.parameters.keep_ledger = true;
    o.ball_offset = -0.1 + 0.005 * k;
    Bowling b = bowling(o);
    const double start = balance(b.world).energy;
    for (int t = 0; t < 5 * o.parameters.rate_hz; ++t) {
      step(b.world);
      g.overlap = std::max(g.overlap, b.world.statistics.deepest_overlap);
    }
    g.down += skittles_down(b);
    g.correction = std::max(g.correction, b.world.ledger.correction.energy);
    g.rise = std::max(g.rise, balance(b.world).energy - start);
    ++count;
  }
  g.down /= count;
  return g;
}

// The paper stopped after 5 to 20 iterations and found no difference. Its depths are guesses there;
// none may lift what it pushes apart. (From the last normal and unlimited they added 9 J to a
// game.)
TEST(PaperDetection, PlaysTheSameGamesAtEveryCapAndAddsNoEnergy) {
  const Games converged = games({});
  std::printf("%-10s %6s %14s %10s\n", "cap", "down", "correction [J]", "deepest");
  std::printf("%-10s %6.2f %14.3f %10.4f\n", "converged", converged.down, converged.correction,
              converged.overlap);
  for (const bool warm : {false, true}) {
    for (const int cap : {5, 10, 20}) {
      const Games g = games({.mode = Query::paper, .cap = cap, .warm = warm});
      std::printf("%-2d %-7s %6.2f %14.3f %10.4f\n", cap, warm ? "warm" : "", g.down, g.correction,
                  g.overlap);
      // What the lane, whose depths are exact, takes back is all there is.
      EXPECT_LT(g.correction, converged.correction + 0.1) << "cap " << cap;
      EXPECT_LT(g.rise, 0.0) << "cap " << cap;
      EXPECT_NEAR(g.down, converged.down, kThorough ? 0.8 : 1.5) << "cap " << cap;
    }
  }
}

struct Rack {
  double ball_offset = 0.0;
  double yaw = 0.0;       // of every skittle about its own axis [rad]
  bool mirrored = false;  // skittles and ball, left for right
};

int down_after(const Rack& rack, std::string_view response) {
  RackOptions o;
  o.parameters.response = response;
  o.ball_offset = rack.mirrored ? -rack.ball_offset : rack.ball_offset;
  Bowling b = bowling(o);
  for (const BodyId i : b.skittles) {
    State state = b.world.states[i];
    state.X_WB.q = state.X_WB.q * rotation(rack.yaw * Vec3::UnitZ());
    if (rack.mirrored) state.X_WB.p.x() = -state.X_WB.p.x();
    set_state(b.world, i, state);
  }
  run(b.world, 5.0);
  return skittles_down(b);
}

// A skittle is round, and left is as good as right: its standing points are chosen by the contact.
// Only games that 1e-9 m of the ball changes may go another way.
TEST(ARack, FallsAlikeWhenItsSkittlesAreTurnedAndWhenItIsMirrored) {
  for (const std::string_view response : {"paper", "coulomb"}) {
    for (int k = 0; k <= 40; k += kEveryOffset) {
      const double offset = -0.101 + 0.005 * k;
      const int down = down_after({offset}, response);
      if (down_after({offset + 1e-9}, response) != down) continue;
      EXPECT_EQ(down_after({offset, 1.0}, response), down) << response << " " << offset;
      EXPECT_EQ(down_after({offset, 0.0, true}, response), down) << response << " " << offset;
    }
  }
}

}  // namespace
}  // namespace headpin::engine
