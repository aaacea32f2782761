#pragma once

#include <string>
#include <vector>

#include "render/data/mesh.h"
#include "scene/play/session.h"
#include "scene/stage/room.h"

/// The score board of an alley: its text, its place in the room and its meshes.
namespace headpin::scene {

/// The size of the board, in characters.
inline constexpr std::size_t kBoardRows = 2, kBoardColumns = 10;

/// The text of the board: rows of at most kBoardColumns characters; none where nothing is counted.
///
/// The first row has the last frames as the score sheet writes them, and `_` for the next ball. An F
/// is before a ball that was a foul, or alone where a foul counts 0. Where a ball can count more than
/// ten, a + is between two numbers of a frame. The second row has the number of
/// the frame, or FOUL, or OVER, and the points so far.
std::vector<std::string> board_text(const GameRules& plan, const Game& game, int rack);

/// The same for the session's game; none without a board.
std::vector<std::string> board_text(const Session& session);

/// The board's place. It hangs above the masking panel, else before the wall behind the skittles,
/// and is turned to the player.
struct BoardMeasures {
  Vec3 p_W = Vec3::Zero();   ///< lower left corner of its front, seen by the player
  Vec2 dot = Vec2::Zero();   ///< width and height of a dot: a character has 3 by 5 dots [m]
  Vec2 size = Vec2::Zero();  ///< width and height of the front [m]

  /// Lower left corner of a character, a little before the front.
  Vec3 cell(std::size_t row, std::size_t column) const;
};

/// From the foul line a character is 8 pixels high on the paper's display, and a dot is 1.5 pixels
/// wide; less where the room has too little space for it.
BoardMeasures board_measures(const RoomMeasures& room);

/// The board without characters, at its place in the world.
render::Mesh board_mesh(const BoardMeasures& board);

/// All characters that have a mesh.
std::string board_characters();

/// A character, its lower left corner at the origin: x right, z up, turned to -y.
/// @param dot  as in BoardMeasures
/// @throws std::invalid_argument  for a character without a mesh
render::Mesh character_mesh(char character, const Vec2& dot);

}  // namespace headpin::scene
