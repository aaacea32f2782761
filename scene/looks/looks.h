#pragma once

#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "render/draw_list.h"
#include "render/renderer.h"
#include "scene/looks/glimpse.h"
#include "scene/looks/score_board.h"
#include "scene/stage/stage.h"

/// From the bodies of a world to what is drawn.
namespace headpin::scene {

/// DrawItem::id of each object; ball i is kFirstBallId + i, skittle i kFirstSkittleId + i.
inline constexpr std::uint32_t kRoomId = 1;
inline constexpr std::uint32_t kHandId = 2;
inline constexpr std::uint32_t kStandId = 3;
inline constexpr std::uint32_t kButtonId = 4;
inline constexpr std::uint32_t kHeadId = 5;
inline constexpr std::uint32_t kBoardId = 6;
inline constexpr std::uint32_t kFirstBallId = 10;
inline constexpr std::uint32_t kFirstSkittleId = 100;

/// The number and the name of every object on a stage that can be drawn, by number.
std::map<std::uint32_t, std::string> object_names(const Stage& stage);

/// Stores meshes: a renderer, or a writer of files.
struct MeshKeeper {
  std::function<int(const render::Mesh&)> add;  ///< returns the number of the mesh
};

/// Meshes of a body, as DrawItem has them.
struct BodyMeshes {
  int mesh = 0;
  std::optional<int> far_mesh = {}, faint_mesh = {};
};

/// A character of the score board where it is drawn.
struct BoardCharacter {
  int mesh = 0;
  Vec3 p_WG = Vec3::Zero();
};

/// The meshes of the score board's characters, and where they are put.
struct BoardLooks {
  BoardMeasures measures;
  std::map<char, int> meshes;

  /// The characters of a text; blanks have none.
  std::vector<BoardCharacter> characters(std::span<const std::string> text) const;
};

/// Which of the hands is drawn.
///
/// @param closed  0: open, 1: around the ball
/// @param hands   how many there are
std::size_t hand_at(double closed, std::size_t hands);

/// Heights of the origins of a skittle's meshes above its base [m].
struct DrawnCentres {
  double true_skittle = 0.0;
  /// None: that of the body. So an ellipsoid that is weighed as the true skittle was drawn too low
  /// under rules 1 to 12, and who looks at such a trial sees what was seen then.
  std::optional<double> ellipsoid = {};
};

/// @param centre  height of the body's origin above the skittle's base as the session begins [m]
DrawnCentres drawn_centres(const Scenario& scenario, double centre);
DrawnCentres drawn_centres(const Stage& stage);

/// All visible objects of a stage, and their light.
struct Looks {
  /// Adds all meshes to the keeper.
  /// @throws std::runtime_error  naming a mesh file that is missing or was changed
  Looks(const MeshKeeper& keeper, const Stage& stage);
  Looks(render::Renderer& renderer, const Stage& stage)
      : Looks(MeshKeeper{[&](const render::Mesh& mesh) { return renderer.add(mesh); }}, stage) {}

  BodyMeshes true_skittle, ellipsoid_skittle, ball;
  std::optional<int> oil_ring;      ///< where the scenario has rings on balls
  std::optional<BoardLooks> board;  ///< where the scenario has a score board
  int head;
  std::vector<int> hands;  ///< from open to closed around the ball
  render::DrawList room;   ///< the parts that do not move, with light, patches and shadow box
  std::vector<render::Occluder> true_occluders, ellipsoid_occluders;  ///< of a skittle, p_BQ
  double ball_radius;
  DrawnCentres centres;     ///< of skittle meshes
  double room_reach = 0.0;  ///< of the room's own mesh from the world's origin [m]; 0 without one

 private:
  void add_skittle(const MeshKeeper& keeper, const Stage& stage);
  void add_hands(const MeshKeeper& keeper, const Scenario& scenario);
  void add_room(const MeshKeeper& keeper, const Scenario& scenario);
  void add_board(const MeshKeeper& keeper, const RoomMeasures& measures);
  void add_buttons(const MeshKeeper& keeper, const Versions& versions);
};

/// How a skittle is drawn: as the ellipsoid that collides, or true; and how high its mesh is in the
/// body's frame, as a version may weigh it elsewhere [m].
struct SkittleLook {
  bool ellipsoid = false;
  double raised = 0.0;

  bool operator==(const SkittleLook&) const = default;
};

/// @param centre  height of the body's origin above the skittle's base now [m]
SkittleLook skittle_look(bool ellipsoid, double centre, const DrawnCentres& drawn);
SkittleLook skittle_look(const Stage& stage, const DrawnCentres& drawn);

/// What a glimpse shows. The head is drawn for another camera alone: an eye is in it.
render::DrawList draw_list(const Looks& looks, const Glimpse& glimpse);

}  // namespace headpin::scene
