#pragma once

#include <functional>
#include <span>
#include <string_view>

#include "base/math.h"

/// Collision response (paper 2.2): the impulse with which two bodies part.
///
/// Signs as in the paper's method: the normal N points from A to B, u is the velocity of A's
/// point minus that of B's, so the two approach when u.N > 0. The impulse F acts on A, -F on B.
namespace headpin::engine {

/// The data that determine an impulse between A and B.
struct Encounter {
  Vec3 n_AB_W;  ///< unit normal from A to B
  Vec3 u_W;     ///< velocity of A's point minus velocity of B's before, eq. (8) [m/s]
  Mat3 K_W;     ///< u' = u + K F, from eqs. (3)-(6) and (8) [1/kg]; symmetric, positive definite
};

/// Values of a pair: the product of the two bodies' values (paper 2.2 b), each in [0, 1].
struct Coefficients {
  double elasticity = 0.0;
  double friction = 0.0;
};

/// Inverse mass that an impulse at `r` from the centre of mass of one body meets.
///
/// (1/m) 1 - [r]x I^-1 [r]x; K of an encounter is the sum over both bodies. A fixed or driven
/// body gives zero.
Mat3 inverse_mass_at(double inv_mass, const Mat3& inv_inertia_W, const Vec3& r_W);

/// F00, case (iii): inelastic and smooth, u'.N = 0 and F along N.
Vec3 impulse_inelastic_smooth(const Encounter& e);
/// F10, case (i): elastic and smooth, F along N and eq. (7).
Vec3 impulse_elastic_smooth(const Encounter& e);
/// F01, case (iv): inelastic and rough, u' = 0.
Vec3 impulse_inelastic_rough(const Encounter& e);
/// F11, case (ii): elastic and rough, u' along N and eq. (7).
Vec3 impulse_elastic_rough(const Encounter& e);

/// The paper's impulse: the four above blended by eq. (9).
///
/// Kinetic energy changes by F.u + F.KF/2, which is convex in F and at most zero at each of the
/// four, so no blend of them adds energy. Keeps linear and angular momentum; keeps the energy
/// for elasticity 1 with friction 0 or 1.
Vec3 paper_impulse(const Encounter& e, const Coefficients& c);

/// Newton's restitution with Coulomb's friction.
///
/// u'.N = -elasticity u.N; the tangential part sticks (u' along N) if |Ft| <= friction |Fn| allows
/// it. Otherwise it opposes the slip with just that strength; for bodies that meet without a slip, that which the
/// normal impulse begins. Where these two laws would add energy
/// (the slip reverses within the impact), F is moved towards F00 until it adds none. Keeps linear
/// and angular momentum; keeps the energy for elasticity 1, friction 0.
Vec3 coulomb_impulse(const Encounter& e, const Coefficients& c);

/// How sliding continues at a lasting contact.
struct Sliding {
  double kept = 1.0;   ///< part of the slip that a step leaves, in [0, 1]
  double limit = 0.0;  ///< largest friction over normal impulse
};

/// The paper's friction is a rate: a slip decays as (1 - friction)^(t / tau), at any load.
///
/// The paper applies its rate once per contact and step; per unit of time nothing depends on the
/// step rate.
Sliding paper_sliding(double friction, double dt, double tau);

/// Coulomb: friction is at most `friction` times the load and stops the slip when it can.
Sliding coulomb_sliding(double friction, double dt, double tau);

/// A law of response. To add one, write its two functions and a line in the table of `responses()`;
/// `set_response` (world.h) gives one world a law of its own.
struct Response {
  std::string_view name;  ///< as users write it
  /// The impulse on A. Where it would pull the bodies together, the step uses F00 instead.
  std::function<Vec3(const Encounter&, const Coefficients&)> impulse;
  Sliding (*sliding)(double friction, double dt, double tau);
  std::string_view keeps;  ///< what it conserves, for help and reports
};

std::span<const Response> responses();

/// @throws std::invalid_argument  for a name that is none of `responses()`, naming them
const Response& response_named(std::string_view name);

/// The same under rules of the step (Parameters::rules): to 7, `coulomb` had no friction where bodies meet
/// without a slip, or took the direction of a slip that was rounding.
const Response& response_under(std::string_view name, int rules);

}  // namespace headpin::engine
