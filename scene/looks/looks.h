#pragma once

#include <functional>
#include <optional>
#include <span>

#include "render/draw_list.h"
#include "render/renderer.h"
#include "scene/stage/stage.h"

/// From what the world knows to what the eyes see.
namespace headpin::scene {

/// DrawItem::id of what is seen; ball i is kFirstBallId + i, skittle i kFirstSkittleId + i.
inline constexpr std::uint32_t kRoomId = 1;
inline constexpr std::uint32_t kHandId = 2;
inline constexpr std::uint32_t kStandId = 3;
inline constexpr std::uint32_t kButtonId = 4;
inline constexpr std::uint32_t kHeadId = 5;
inline constexpr std::uint32_t kFirstBallId = 10;
inline constexpr std::uint32_t kFirstSkittleId = 100;

/// Whoever keeps meshes: a renderer, or one that writes them down.
struct MeshKeeper {
  std::function<int(const render::Mesh&)> add;  ///< gives the number it is asked for by
};

/// Meshes of a body, as DrawItem has them.
struct BodyMeshes {
  int mesh = 0;
  std::optional<int> far_mesh = {}, faint_mesh = {};
};

/// Everything of a stage that can be seen, and the light it is seen in.
struct Looks {
  /// Adds all meshes to the keeper.
  /// @throws std::runtime_error  naming a mesh file that is not there or is not what it was
  Looks(const MeshKeeper& keeper, const Stage& stage);
  Looks(render::Renderer& renderer, const Stage& stage)
      : Looks(MeshKeeper{[&](const render::Mesh& mesh) { return renderer.add(mesh); }}, stage) {}

  BodyMeshes true_skittle, ellipsoid_skittle, ball;
  int head;
  std::vector<int> hands;  ///< from open to closed around the ball
  render::DrawList room;   ///< what never moves, with light, patches and shadow box
  std::vector<render::Occluder> true_occluders, ellipsoid_occluders;  ///< of a skittle, p_BQ
  double ball_radius, skittle_centre;  ///< the latter of the stage's skittles

 private:
  void add_skittle(const MeshKeeper& keeper, const Stage& stage);
  void add_hands(const MeshKeeper& keeper, const Scenario& scenario);
  void add_room(const MeshKeeper& keeper, const Scenario& scenario);
  void add_buttons(const MeshKeeper& keeper, const Versions& versions);
};

/// What moves, at one moment.
struct Moving {
  std::span<const Pose> X_WB_skittles;
  bool ellipsoids = false;  ///< skittles look like the ellipsoids they are
  double skittle_centre =
      0.0;  ///< of their bodies above their base: a version may have its own [m]
  std::span<const Pose> X_WB_balls;
  std::optional<Pose> X_WH;       ///< no hand is seen without
  double closed = 0.0;            ///< the hand: 0 is open, 1 around the ball
  std::optional<Pose> X_WD = {};  ///< no head is seen without
};

render::DrawList draw_list(const Looks& looks, const Moving& moving);

}  // namespace headpin::scene
