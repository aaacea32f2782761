#pragma once

#include <string_view>

#include "engine/world.h"
#include "scene/scenario/scenario.h"

/// The bodies that collide: skittles, ball, floor and walls of a scenario.
namespace headpin::scene {

/// A skittle's shape with its base's middle at the origin and its axis along z.
engine::Compound skittle_shape(const Skittle& skittle, SkittleShape shape);

/// A skittle as a body: origin at its centre of mass, axes of its parts, uniform density.
struct SkittleBody {
  engine::Body body;
  double centre_height;  ///< of its centre of mass above its base [m]
};
SkittleBody skittle_body(const Scenario& scenario);

engine::Body ball_body(const Scenario& scenario);

/// The open virtual hand, which is the only body of the player: palm, two pairs of fingers, thumb.
/// Its frame is H.
engine::Body hand_body(const Scenario& scenario);

/// The role of a body in the game.
enum class Role : std::uint8_t { lane, wall, ball, skittle, hand };

// The first words of the names of bodies that move: "ball 2", "skittle 1".
inline constexpr std::string_view kBallName = "ball";
inline constexpr std::string_view kSkittleName = "skittle";
inline constexpr std::string_view kHandName = "hand";

/// A fixed body and its pose.
struct Fixture {
  Role role;
  engine::Body body;
  Pose X_WB;
};

/// The floor (with gutters of some depth: the lane, what is left and right of it, and the plane at
/// their bottom), the walls (left, right, behind, ahead), and the ceiling, the kick-backs and the masking
/// panel where the scenario has them.
std::vector<Fixture> room_fixtures(const Scenario& scenario);

/// The parameters of the engine's step.
engine::Parameters world_parameters(const Scenario& scenario);

}  // namespace headpin::scene
