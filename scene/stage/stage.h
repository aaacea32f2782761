#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/stage/bodies.h"
#include "scene/stage/room.h"

/// The initial state of a scenario, built once and shared by runs.
namespace headpin::scene {

/// The bodies of a scenario in their initial state, and their roles.
///
/// Bodies are identified by their role, never by their number.
struct Stage {
  Scenario scenario;
  RoomMeasures room;        ///< of the scenario
  engine::World world;      ///< at its start; a session steps a copy of it
  std::vector<Role> roles;  ///< of the world's bodies, same numbers
  engine::Body skittle;     ///< what each skittle is made as: its mass properties are found once
  double skittle_centre = 0.0;  ///< height of a skittle's centre of mass above its base [m]
  double widest_skittle = 0.0;  ///< largest radius of one [m]

  // Bodies of a role, in the order they were added.
  std::vector<engine::BodyId> balls, skittles;
  std::optional<engine::BodyId> hand;  ///< where the scenario has a solid one
  engine::BodyId lane = 0;
  /// The friction of the lane before the first throw, if throws wear it; else none.
  std::shared_ptr<const engine::FrictionTable> fresh_lane;
};

/// The pose of an absent hand: below the floor.
inline const Pose kAway{Quat::Identity(), Vec3(0.0, 0.0, -10.0)};

/// The pose of a skittle that was counted: upright beside the others behind the wall ahead, where it is
/// not visible.
Pose away_pose(const Stage& stage, engine::BodyId skittle);

/// Whether a body with this pose is not in play: an absent hand, or a skittle that was counted.
bool is_away(const Stage& stage, engine::BodyId body, const Pose& X_WB);

/// The room, a ball on its stand, a rack of skittles and the hand, as the scenario has them.
Stage make_stage(const Scenario& scenario);

/// Adds a ball that waits on a stand until it is taken.
///
/// @param home  p_WB of its centre
engine::BodyId add_ball(Stage& stage, const Vec3& home);

/// Adds a rack of skittles that stand until they are struck.
///
/// @param head_pin  where its first spot is, on the lane: x right, y away
void add_rack(Stage& stage, const Vec2& head_pin);

/// Names of the world's bodies, in their order: "lane", "ball", "skittle 1" ...
std::vector<std::string> body_names(const Stage& stage);

/// The role of the body that a stage gives this name. Trials and their events know bodies by their
/// names alone.
///
/// @return  ball, skittle or hand; nothing for a part of the room or another name
std::optional<Role> role_named(std::string_view name);

/// "skittle 3", and back: nothing for another name.
std::string name_of_skittle(int number);
std::optional<int> skittle_number(std::string_view name);

}  // namespace headpin::scene
