#pragma once

#include <vector>

#include "scene/scenario/scenario.h"
#include "scene/sound/modal.h"
#include "scene/stage/room.h"

/// The modes of the bodies of an alley, and how long two of them touch in a collision.
///
/// No measured modes of a bowling pin were found. The modes are those of simple bodies with the
/// measures of the scenario: a free bar, a free sphere, a plate.
namespace headpin::scene {

/// Of a skittle: the first four bending modes of a free bar of maple.
///
/// The bar has the skittle's height, and the radius of a cylinder of the same volume. Euler and
/// Bernoulli's frequencies are corrected for shear and rotation by the first term of Timoshenko's.
std::vector<Mode> modes_of_skittle(const Skittle& skittle);

/// Of a ball: the first three spheroidal modes of a free sphere of polyester (Lamb 1882).
std::vector<Mode> modes_of_ball(const Ball& ball);

/// Of the lane under a blow: eight bending modes of a plate of maple, 65 mm thick and as wide as the
/// lane, that lies on sleepers 0.6 m apart.
std::vector<Mode> modes_of_lane(const RoomMeasures& room);

/// How a body is where it is struck.
struct ContactSurface {
  double curvature = 0.0;  ///< 1 / radius, 0 for a plane [1/m]
  double modulus = 0.0;    ///< Young's, across the surface [Pa]
  double poisson = 0.0;
};

ContactSurface surface_of_skittle(const Skittle& skittle);
ContactSurface surface_of_ball(const Ball& ball);
ContactSurface surface_of_room();  ///< maple
ContactSurface surface_of_hand();  ///< soft

/// Time that two bodies touch in a collision [s] (Hertz; Johnson 1985, Contact mechanics, 11.24).
///
/// @param mass   reduced mass of both [kg]
/// @param speed  they approach with [m/s]
double contact_time(const ContactSurface& a, const ContactSurface& b, double mass, double speed);

/// Part of an impulse that reaches a mode when it is not short against a period.
///
/// The force is half a sine. The maxima of its spectrum are met within 3 dB; its zeros are left out,
/// because the force of a real contact has none.
///
/// @param touching  the contact time [s]
double part_of_impulse(double frequency, double touching);

}  // namespace headpin::scene
