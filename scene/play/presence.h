#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "scene/play/moment.h"
#include "scene/play/player.h"

/// Presence as behaviour shows it: something flies at the player; does head or hand get out of its
/// way? Uno & Slater 1997 saw people do so and leave it for later: "This is dangerous!" How it is
/// told is ours.
///
/// The player is the upright line from the floor to the crown of the head, and the hand. What counts
/// is how a ball or a skittle moves in the room, not that somebody walks or reaches towards it.
namespace headpin::scene {

/// How something passes the player if it goes on as it does.
struct Passing {
  double time_s = 0.0;    ///< until it is nearest
  double distance = 0.0;  ///< between the sphere around it and the player then, 0 where it hits [m]
  bool at_hand = false;   ///< it is nearer to the hand than to the rest
};

/// What comes at somebody.
///
/// @param state    of the thing, in the world; it falls under gravity, not below the floor
/// @param radius   of the thing, all around it [m]
/// @param p_WD     between the eyes
/// @param p_WH     the palm, where it is known
/// @param gravity  [m/s^2]
/// @return         nothing for what does not come nearer
std::optional<Passing> passing(const engine::State& state, double radius, const Vec3& p_WD,
                               const std::optional<Vec3>& p_WH, double gravity);

/// From when a passing is one that people draw back from: it would come this near, this soon, this
/// fast.
struct Alarm {
  double near = 0.4;    ///< [m]
  double soon_s = 1.0;  ///< [s]
  double fast = 1.0;    ///< of the thing in the room [m/s]
};

/// Whether something flies at the player, by `Alarm`.
bool is_coming(const engine::State& state, const Passing& passing);

/// A thing that flies at the player, from when it was noticed until 0.3 s after it was nearest.
struct Approach {
  engine::BodyId body = 0;
  Time noticed{};
  Passing foreseen;                 ///< as it was noticed
  Vec3 along_W = Vec3::UnitY();     ///< where it flew then, horizontally
  double closest = 0.0;             ///< its surface, as it collides, to the player, so far [m]
  double head_away = 0.0;           ///< largest acceleration out of its way, so far [m/s^2]
  double hand_away = 0.0;           ///< likewise
  std::optional<Time> passed = {};  ///< when it no longer came nearer
};

/// What the player has let go, until it turns back or goes away, further off than `Alarm::near`.
struct Own {
  engine::BodyId body = 0;
  Vec3 along_W = Vec3::UnitY();  ///< where it flew as it was let go, horizontally
};

/// What is in the air.
struct Presence {
  std::vector<Approach> approaches;  ///< oldest first
  std::vector<Own> own;
};

/// Whether something is on its way from the player's own hand: nobody draws back from that.
bool is_own(const Presence& presence, engine::BodyId body);

/// Head or hand got out of the way when it accelerated out of it by this [m/s^2]. Of virtual
/// participants whom nothing disturbs nine heads in ten stay below 3.2, of those who draw back nine in
/// ten are above 5.
inline constexpr double kOutOfTheWay = 4.0;

/// Looks at what flies at the player after a step: an event as it is noticed and one when it is
/// over, with the closest approach and with how head and hand accelerated.
///
/// Accelerations are the slopes of parabolas through the samples of the last 0.2 s, in the tracked
/// space: own movement, a walk by the thumbs is not in it. Out of its way is along its flight, to
/// the side that the player is on, or, for what passes within 0.5 m of the height, up or down. The
/// head's is that of its joint with the neck, so that who looks round stays; a hand that swings, by
/// more than 0.3 m in that time, does not count.
///
/// @param out  events are appended
void watch(Presence& presence, const Player& player, const Stage& stage, const engine::World& world,
           const Moment& moment, std::vector<devices::Event>& out);

/// What flew at the player, from the events of a session: when it was over, the body, the closest
/// approach, and what the event says besides.
nlohmann::json approaches_of(std::span<const devices::Event> events);

/// The same for people, a line each.
std::vector<std::string> approaches_in_words(std::span<const devices::Event> events);

}  // namespace headpin::scene
