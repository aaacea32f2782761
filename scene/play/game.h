#pragma once

#include <optional>
#include <vector>

#include "scene/play/moment.h"
#include "scene/scenario/rules.h"
#include "scene/stage/stage.h"

/// What the meetings and falls of a step mean for the game, and what its rules do about them.
namespace headpin::scene {

/// Who set a skittle moving.
enum class By : std::uint8_t {
  nobody,
  ball,  ///< one that was thrown
  hand   ///< or what it carries
};

/// What the game remembers.
struct Game {
  std::vector<std::uint8_t> down;  ///< 1 for a skittle that has fallen; by the number of its body
  std::vector<By> moved_by;        ///< for the skittles; same numbers
  bool struck = false;             ///< a ball has met a skittle
  std::vector<Vec3> velocities;    ///< of the bodies before the step [m/s], same numbers

  // Of a game with rules.
  std::vector<std::uint8_t> swept;  ///< 1 for a skittle that was counted and is away; same numbers
  std::vector<Frame> frames;        ///< so far; the last one is played
  std::optional<Time> thrown;       ///< when the ball that is under way was let go
  std::optional<Time> quiet;        ///< since when all has been at rest under way
  bool foul = false;                ///< the ball that is under way was let go beyond the foul line
  bool beyond = false;              ///< it has been there
  bool begun = false, over = false;
};

Game make_game(const Stage& stage);

/// Whether a skittle has fallen over: its axis leans by more than 20 degrees.
bool has_fallen(const Pose& X_WB);

/// Remembers how the bodies move before a step: a ball's own as it comes to its first skittle.
void note_velocities(Game& game, const engine::World& world);

/// Notes what the step made of the skittles: who touched, who fell and by whom; and a foul.
///
/// A skittle is felled by whoever set it moving: the last ball or hand that met it itself, else the
/// skittle that met it first hands on whose doing that was. What is carried is the hand's.
///
/// @param out  events of this tick so far; more are appended, in the order they happened
void note_step(Game& game, const Stage& stage, const engine::World& world, const Moment& moment,
               std::vector<devices::Event>& out);

/// Counts, sweeps and sets again as the scenario's rules want it, once a ball that was thrown and
/// all skittles are at rest and have been for longer than a ball hangs at the top of its flight, or
/// `game.ball_back_s` after it was let go: with friction 0 nothing ever rests. Down is what has
/// fallen or stands further from its spot than `game.off_spot`; what the hand felled is dead wood.
///
/// A ball that the hand takes again was not thrown, as long as it has met no skittle and has not
/// been over the foul line, or within half a second.
///
/// @param held  what the hand holds is not moved; but a skittle is, once all are set for the next frame
/// @param out   events are appended
/// @return      whether what the hand holds was taken from it
bool referee(Game& game, const Stage& stage, engine::World& world, const Moment& moment,
             std::optional<engine::BodyId> held, std::vector<devices::Event>& out);

}  // namespace headpin::scene
