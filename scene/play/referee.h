#pragma once

#include <optional>

#include "scene/play/game.h"

namespace headpin::scene {

/// Counts, sweeps and sets skittles again by the scenario's rules, once the thrown ball and all
/// skittles have been at rest for longer than a ball pauses at the top of its flight, or
/// `game.ball_back_s` after the release (with friction 0, bodies never rest). A skittle is down if
/// it has fallen or stands further from its spot than `game.off_spot`. Skittles that the hand
/// knocked down are dead wood; those of a stray ball are set up again and do not count.
///
/// A ball that the hand grabs again does not count as thrown, if it has touched no skittle and has
/// not crossed the foul line, or within half a second.
///
/// @param held  the body in the hand, which is not moved, except for a skittle when all are set for
///              the next frame
/// @return      whether the body was taken out of the hand
bool referee(Game& game, const Tick& tick, std::optional<engine::BodyId> held);

}  // namespace headpin::scene
