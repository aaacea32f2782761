#pragma once

#include <optional>
#include <vector>

#include "engine/body.h"
#include "scene/stage/room.h"

/// Rings of oil on a ball: where it touched the lane, revolution by revolution. With a core whose
/// axis wanders, they fan out: track flare.
namespace headpin::scene {

/// The circle on a ball along which it touched the lane in one revolution.
struct OilRing {
  Vec3 n_B = Vec3::UnitZ();  ///< its axis, through the ball's centre
  double height = 0.0;       ///< of its plane above the centre, along n_B, per radius of the ball
};

/// The largest distance of a circle from another one, along the surface of a ball.
///
/// @param radius  of the ball [m]
double rings_apart(const OilRing& a, const OilRing& b, double radius);

/// Finds the rings of a ball that rolls.
struct OilRings {
  // Of the revolution that is not complete. Places are from the ball's centre, per radius.
  std::optional<Vec3> begin_B;    ///< its first place
  Vec3 last_B = Vec3::Zero();     ///< its last one
  Vec3 area_B = Vec3::Zero();     ///< twice that of the polygon of the places, from the centre
  Vec3 sum_B = Vec3::Zero();      ///< of the places
  std::int64_t places = 0;        ///< how many
  double turned = 0.0;            ///< [rad]
  std::optional<OilRing> first;   ///< ring that is complete
  std::optional<double> flare;    ///< largest distance of a later ring from the first one [m]
  std::optional<OilRing> newest;  ///< that this tick completed
};

/// Adds the state of the ball after a step.
///
/// @param leaves_oil  it touches the lane, and takes oil there
/// @param radius      of the ball [m]
/// @param dt          of the step [s]
void add_contact(OilRings& rings, const engine::State& now, bool leaves_oil, double radius,
                 double dt);

/// Whether a ball takes oil at a place of the lane. A lane without oil leaves rings of dust: there,
/// every place before the skittles counts.
bool leaves_rings(const RoomMeasures& room, const Vec3& p_WB);

}  // namespace headpin::scene
