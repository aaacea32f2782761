#pragma once

#include <optional>
#include <vector>

#include "scene/moment.h"
#include "scene/rules.h"
#include "scene/stage.h"

/// What the meetings and falls of a step mean for the game, and what its rules do about them.
namespace headpin::scene {

/// What the game remembers.
struct Game {
  std::vector<std::uint8_t> down;  ///< 1 for a skittle that has fallen; by the number of its body
  bool struck = false;             ///< a ball has met a skittle
  std::vector<double> speeds;      ///< of the bodies before the step [m/s], same numbers

  // Of a game with rules.
  std::vector<std::uint8_t> swept;  ///< 1 for a skittle that was counted and is away; same numbers
  std::vector<Frame> frames;        ///< so far; the last one is played
  std::optional<Time> thrown;       ///< when the ball that is under way was let go
  bool begun = false, over = false;
};

Game make_game(const Stage& stage);

/// Whether a skittle has fallen over: its axis leans by more than 20 degrees.
bool has_fallen(const Pose& X_WB);

/// Remembers how fast the bodies are before a step: a ball's own as it comes to its first skittle.
void note_speeds(Game& game, const engine::World& world);

/// Notes what the step made of the skittles: who touched, who fell.
///
/// @param out  events are appended, in the order they happened
void note_step(Game& game, const Stage& stage, const engine::World& world, const Moment& moment,
               std::vector<devices::Event>& out);

/// Counts, sweeps and sets again as the scenario's rules want it, once a ball that was thrown and
/// all skittles are at rest, or `game.ball_back_s` after it was let go: with friction 0 nothing ever
/// rests. Down is what has fallen or stands further from its spot than `game.off_spot`.
///
/// @param held  what the hand holds is not moved
/// @param out   events are appended
void referee(Game& game, const Stage& stage, engine::World& world, const Moment& moment,
             std::optional<engine::BodyId> held, std::vector<devices::Event>& out);

}  // namespace headpin::scene
