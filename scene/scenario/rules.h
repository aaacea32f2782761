#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "scene/scenario/choices.h"

/// Rules of skittles games as data, and scores under these rules. No physics.
namespace headpin::scene {

struct Rules {
  GameKind kind;
  bool counted;    ///< it is a game: balls are counted, skittles swept and set again
  bool full_rack;  ///< all skittles are set before every ball
  bool set_again;  ///< and within a frame when none is left
  bool bonuses;    ///< strikes and spares count the next balls too
};

const Rules& rules_of(GameKind kind);

/// Skittles down by each ball of a frame.
using Frame = std::vector<int>;

/// Whether a frame is over.
///
/// @param rack   skittles that are set
/// @param balls  of a frame
/// @param last   it is the last of the game: a strike or a spare in it is played out
bool is_over(const Rules& rules, const Frame& frame, int rack, int balls, bool last);

/// Whether all skittles are set before the next ball of a frame that is not over.
bool is_set_again(const Rules& rules, const Frame& frame, int rack);

/// The points of the frames so far, without bonuses of future balls.
int points(const Rules& rules, std::span<const Frame> frames, int rack);

/// One ball of a frame: "X", "7", "/" or "-".
std::string ball_in_words(const Rules& rules, const Frame& frame, std::size_t ball, int rack);

/// "X | 7 / | 9 -": with strikes and spares if the rules have them; a dash is 0.
std::string in_words(const Rules& rules, std::span<const Frame> frames, int rack);

}  // namespace headpin::scene
