#pragma once

#include "engine/world.h"
#include "scene/scenario/scenario.h"

/// What collides: the skittle, the ball, the floor and the walls of a scenario as bodies.
namespace headpin::scene {

/// A skittle's shape with its base's middle at the origin and its axis along z.
///
/// @param shape  "true": the compound of its parts; "ellipsoid": the one ellipsoid of its height
///               and largest width (Uno & Slater 1997, table 1)
/// @throws std::invalid_argument  for another shape
engine::Compound skittle_shape(const Skittle& skittle, const std::string& shape);

/// A skittle as a body: origin at its centre of mass, uniform density.
struct SkittleBody {
  engine::Body body;
  double centre_height;  ///< of its centre of mass above its base [m]
};
SkittleBody skittle_body(const Scenario& scenario);

engine::Body ball_body(const Scenario& scenario);

/// The virtual hand, open, as the one body the player has: palm, two pairs of fingers, thumb. Its
/// frame is H.
engine::Body hand_body(const Scenario& scenario);

/// What a body is in the game.
enum class Role : std::uint8_t { lane, wall, ball, skittle, hand };

/// What never moves, and where it stands.
struct Fixture {
  Role role;
  engine::Body body;
  Pose X_WB;
};

/// The floor (with gutters of some depth: the lane, what is left and right of it, and the plane at
/// their bottom), the walls (left, right, behind, ahead), and the ceiling, the kick-backs and the masking
/// panel where the scenario has them.
std::vector<Fixture> room_fixtures(const Scenario& scenario);

/// How the world is stepped.
engine::Parameters world_parameters(const Scenario& scenario);

}  // namespace headpin::scene
