#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "scene/play/player.h"
#include "scene/play/tick.h"

/// Behavioural presence: does the player move head or hand away from a body that flies at them? Uno
/// & Slater 1997 saw people do so ("This is dangerous!") and left it for later. This measure is our
/// own.
///
/// The player consists of the vertical line from the floor to the top of the head, and of the hand.
/// Only the motion of the ball or skittle in the room counts, not that of a player who walks or
/// reaches towards it.
namespace headpin::scene {

/// How a body passes the player if both keep their velocities.
struct Passing {
  double time_s = 0.0;  ///< until it is nearest
  /// Closest distance between the sphere around the body and the player; 0 if it hits [m].
  double distance = 0.0;
  bool at_hand = false;  ///< it comes nearer to the hand than to head and body
};

/// Predicts how a body passes the player.
///
/// @param state    of the body, in the world; it falls under gravity, not below the floor
/// @param radius   radius of the sphere around the body [m]
/// @param p_WD     between the eyes
/// @param p_WH     the palm, if it is known
/// @param gravity  [m/s^2]
/// @return         nothing if the body does not come nearer
std::optional<Passing> passing(const engine::State& state, double radius, const Vec3& p_WD,
                               const std::optional<Vec3>& p_WH, double gravity);

/// Thresholds from which people move away: distance, time and speed of the body.
struct Alarm {
  double near = 0.4;    ///< [m]
  double soon_s = 1.0;  ///< [s]
  double fast = 1.0;    ///< of the thing in the room [m/s]
};

/// Whether a body flies at the player by these thresholds.
bool is_coming(const engine::State& state, const Passing& passing);

/// A body that flies at the player, from when it was noticed until 0.3 s after the closest
/// approach.
struct Approach {
  engine::BodyId body = 0;
  Time noticed{};
  Passing foreseen;              ///< predicted when it was noticed
  Vec3 along_W = Vec3::UnitY();  ///< horizontal direction of its flight then
  double closest = 0.0;          ///< closest distance of its collision surface so far [m]
  /// Largest acceleration of the head away from it so far [m/s^2].
  double head_away = 0.0;
  double hand_away = 0.0;           ///< likewise
  std::optional<Time> passed = {};  ///< when it began to move away
};

/// A body that the player released, until it turns back or is further away than `Alarm::near`.
struct Own {
  engine::BodyId body = 0;
  Vec3 along_W = Vec3::UnitY();  ///< horizontal direction of its flight at the release
};

/// All approaching bodies.
struct Presence {
  std::vector<Approach> approaches;  ///< oldest first
  std::vector<Own> own;
};

/// Whether a body is still flying from the player's own hand; people do not move away from those.
bool is_own(const Presence& presence, engine::BodyId body);

/// Head or hand counts as moved away above this acceleration [m/s^2]. For virtual participants, 90
/// % of undisturbed heads stay below 3.2, and 90 % of those that move away are above 5.
inline constexpr double kOutOfTheWay = 4.0;

/// Watches bodies that fly at the player after a step. Reports an event when one is noticed, and
/// one when it has passed, with the closest approach and the accelerations of head and hand.
///
/// Accelerations are those of parabolas through the samples of the last 0.2 s in the tracked space,
/// without walking by the thumb buttons. "Away" means along the flight, to the side of the player,
/// or up or down if the body passes within 0.5 m of the height. The head's acceleration is measured
/// at its joint with the neck, so turning the head does not count. A hand that swings, by more than
/// 0.3 m in that time, does not count.
void watch(Presence& presence, const Player& player, const Tick& tick);

/// The bodies that flew at the player, from the events of a session: time, body, closest approach
/// and the event's further values.
nlohmann::json approaches_of(std::span<const Event> events);

/// The same as text, one line each.
std::vector<std::string> approaches_in_words(std::span<const Event> events);

}  // namespace headpin::scene
