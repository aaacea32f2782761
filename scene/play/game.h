#pragma once

#include <optional>
#include <vector>

#include "scene/play/ball_path.h"
#include "scene/play/lane_wear.h"
#include "scene/play/tick.h"
#include "scene/play/track_flare.h"
#include "scene/record/details.h"
#include "scene/scenario/rules.h"
#include "scene/stage/stage.h"

/// The game: contacts and falls of a step, and what the rules do about them.
namespace headpin::scene {

/// A ball is on the foul line, not beyond it, up to this distance: less is rounding [m].
inline constexpr double kOnLine = 1e-6;

/// A ball that is in the hand again earlier than this was not thrown, even beyond the foul line. Nor is a
/// ball at rest counted earlier: it may not have fallen yet.
inline constexpr Time kThrownAfter{500'000};

/// A thrown ball whose way is watched.
struct WatchedBall {
  engine::BodyId body = 0;
  BallWatch watch;
  TouchedCells touched;  ///< of a lane with wear
  OilRings rings;
};

/// A ball with the rings of its last throw, for the eyes.
struct RingedBall {
  engine::BodyId body = 0;
  std::vector<OilRing> rings;
};

/// The state of the game.
struct Game {
  std::vector<std::uint8_t> down;   ///< 1 for a skittle that has fallen; by the number of its body
  std::vector<By> moved_by;         ///< for the skittles; same numbers
  bool struck = false;              ///< a ball has touched a skittle
  std::vector<std::uint8_t> stray;  ///< 1 for a thrown ball that is stray; same numbers
  std::vector<Vec3> velocities;     ///< of the bodies before the step [m/s], same numbers

  // Of a game with rules.
  std::vector<std::uint8_t> swept;  ///< 1 for a skittle that was counted and removed; same numbers
  std::vector<Frame> frames;        ///< frames so far; the last one is being played
  std::vector<std::uint8_t> fouls;  ///< of the balls of all frames, in order: 1 for a foul
  std::optional<Time> thrown;       ///< release time of the current ball
  std::optional<Time> quiet;        ///< time since which all bodies have been at rest
  bool foul = false;                ///< the current ball was released beyond the foul line
  bool beyond = false;              ///< the current ball has been beyond the foul line
  bool begun = false, over = false;
  std::optional<WatchedBall> watched;  ///< the last ball that was thrown, while it is on its way
  std::optional<RingedBall> ringed;    ///< until the next throw, where the scenario has rings
};

Game make_game(const Stage& stage);

/// A thrown ball that is in the hand again.
struct CaughtBall {
  bool struck = false;   ///< it has touched a skittle
  bool beyond = false;   ///< it has been beyond the foul line
  Time since_release{};  ///< from tick to tick
};

/// Whether it does not count as thrown: then neither does its foul. Referee and score sheet decide by
/// this; the sheet knows of a ball beyond the line only that it was let go there.
bool is_taken_back(const GameRules& rules, const CaughtBall& ball);

/// The way of the ball that is watched, as far as it has come: the event of a trial that ends before
/// it. Nothing if no ball is on its way.
std::optional<Event> ball_path_so_far(const Game& game, const engine::World& world,
                                      const Moment& moment);

/// Reports the way of the ball that is watched, wears the lane, and watches the ball no longer.
void end_ball_path(Game& game, const Tick& tick);

/// Whether a skittle has fallen over: its axis leans by more than 20 degrees.
bool has_fallen(const Pose& X_WB);

/// Whether a skittle is further from its spot than `game.off_spot`.
bool is_off_spot(const engine::World& world, const Stage& stage, engine::BodyId skittle);

/// Stores the velocities before a step, for the speed of a ball just before its first skittle.
void note_velocities(Game& game, const engine::World& world);

/// Reports the events of a step: touches, fallen skittles with their cause, and fouls.
///
/// The cause of a fall is what set the skittle in motion: the last ball or hand that touched it, or
/// else the cause of the skittle that touched it first. A carried body counts as the hand. In a game
/// whose rules say so, a ball is stray after it left the lane before the head pin, having touched no
/// skittle, or came back from behind the last row (USBC rules, illegal pinfall).
///
/// @param tick  gets the events, in order of time
void note_step(Game& game, const Tick& tick);

}  // namespace headpin::scene
