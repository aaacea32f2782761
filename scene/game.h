#pragma once

#include <vector>

#include "scene/moment.h"
#include "scene/stage.h"

/// What the meetings and falls of a step mean for the game.
namespace headpin::scene {

/// What the game remembers of the skittles as they were last set.
struct Game {
  std::vector<std::uint8_t> down;  ///< 1 for a skittle that has fallen; by the number of its body
  bool struck = false;             ///< a ball has met a skittle
  std::vector<double> speeds;      ///< of the bodies before the step [m/s], same numbers
};

Game make_game(const Stage& stage);

/// Whether a skittle has fallen over: its axis leans by more than 20 degrees.
bool has_fallen(const Pose& X_WB);

/// Remembers how fast the bodies are before a step: a ball's own as it comes to its first skittle.
void note_speeds(Game& game, const engine::World& world);

/// Notes what the step made of the skittles: who touched, who fell.
///
/// @param out  events are appended, in the order they happened
void play(Game& game, const Stage& stage, const engine::World& world, const Moment& moment,
          std::vector<devices::Event>& out);

}  // namespace headpin::scene
