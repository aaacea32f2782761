#include "engine/response.h"

#include <array>
#include <limits>
#include <stdexcept>
#include <string>

namespace headpin::engine {
namespace {

/// K^-1 v. Cholesky, because K of a slender body or an uneven pair is badly scaled.
Vec3 divide(const Eigen::LLT<Mat3>& K, const Vec3& v) {
  return K.solve(v);
}

/// Below this part of the approach, a slip is rounding: the bodies meet without one.
constexpr double kNoSlip = 1e-9;

/// The direction in which bodies that meet without a slip begin to slip, by the normal impulse; zero if they do
/// not.
Vec3 direction_that_begins(const Encounter& e) {
  const Vec3& N = e.n_AB_W;
  const Vec3 KN = e.K_W * N;
  const Vec3 along = KN - N.dot(KN) * N;
  return along.norm() > kNoSlip * KN.norm() ? Vec3(-along.normalized()) : Vec3(Vec3::Zero());
}

/// Kinetic energy that F adds to the pair [J].
double energy_added(const Encounter& e, const Vec3& F) {
  return F.dot(e.u_W) + 0.5 * F.dot(e.K_W * F);
}

}  // namespace

Mat3 inverse_mass_at(double inv_mass, const Mat3& inv_inertia_W, const Vec3& r_W) {
  const Mat3 r = skew(r_W);
  return inv_mass * Mat3::Identity() - r * inv_inertia_W * r;
}

Vec3 impulse_inelastic_smooth(const Encounter& e) {
  const Vec3& N = e.n_AB_W;
  return -e.u_W.dot(N) / N.dot(e.K_W * N) * N;
}

Vec3 impulse_elastic_smooth(const Encounter& e) {
  return 2.0 * impulse_inelastic_smooth(e);
}

Vec3 impulse_inelastic_rough(const Encounter& e) {
  return -divide(Eigen::LLT<Mat3>(e.K_W), e.u_W);
}

Vec3 impulse_elastic_rough(const Encounter& e) {
  const Eigen::LLT<Mat3> K(e.K_W);
  const Vec3 Ku = divide(K, e.u_W), KN = divide(K, e.n_AB_W);
  const double k = -std::sqrt(e.u_W.dot(Ku) / e.n_AB_W.dot(KN));  // u' = k N satisfies eq. (7)
  return k * KN - Ku;
}

Vec3 paper_impulse(const Encounter& e, const Coefficients& c) {
  const Vec3 F00 = impulse_inelastic_smooth(e), F10 = impulse_elastic_smooth(e);
  if (c.friction == 0.0) return F00 + (F10 - F00) * c.elasticity;
  const Vec3 F01 = impulse_inelastic_rough(e), F11 = impulse_elastic_rough(e);
  return F00 + (F10 - F00) * c.elasticity + (F01 - F00) * c.friction +
         (F11 - F01 - F10 + F00) * (c.elasticity * c.friction);
}

namespace {

Vec3 slip_of(const Encounter& e) {
  return e.u_W - e.u_W.dot(e.n_AB_W) * e.n_AB_W;
}

/// @param limit  the direction of an impulse at the limit of friction: N, and the slip at `friction` long
Vec3 coulomb_along(const Encounter& e, const Coefficients& c, const Vec3& limit) {
  const Vec3& N = e.n_AB_W;
  const double approach = e.u_W.dot(N);
  Vec3 F = -divide(Eigen::LLT<Mat3>(e.K_W), e.u_W + c.elasticity * approach * N);
  const double Fn = -F.dot(N);
  if (const Vec3 Ft = F + Fn * N; Ft.norm() > c.friction * Fn) {
    const double seen = N.dot(e.K_W * limit);
    // If friction is so strong that it would pull the bodies together, use only the normal part.
    F = seen > 0.0 ? Vec3(-(1.0 + c.elasticity) * approach / seen * limit)
                   : Vec3((1.0 + c.elasticity) * impulse_inelastic_smooth(e));
  }
  const Vec3 F00 = impulse_inelastic_smooth(e), more = F - F00;
  if (energy_added(e, F) <= 0.0) return F;
  // energy_added(F00 + s more) = a s^2 + b s + c0 with c0 <= 0 <= a: its root in [0, 1].
  const double a = 0.5 * more.dot(e.K_W * more);
  const double b = more.dot(e.u_W + e.K_W * F00);
  const double c0 = energy_added(e, F00);
  const double root = std::sqrt(std::max(0.0, b * b - 4.0 * a * c0));
  return F00 + (b > 0.0 ? -2.0 * c0 / (b + root) : (root - b) / (2.0 * a)) * more;
}

/// Friction opposes any slip, also one that is rounding; without one there is no friction.
Vec3 coulomb_impulse_to_rules_7(const Encounter& e, const Coefficients& c) {
  const Vec3 slip = slip_of(e);
  const double speed = slip.norm();
  return coulomb_along(e, c, speed > 0.0 ? Vec3(e.n_AB_W + c.friction / speed * slip) : e.n_AB_W);
}

}  // namespace

Vec3 coulomb_impulse(const Encounter& e, const Coefficients& c) {
  const Vec3 slip = slip_of(e);
  const double speed = slip.norm();
  if (speed > kNoSlip * std::abs(e.u_W.dot(e.n_AB_W))) return coulomb_impulse_to_rules_7(e, c);
  return coulomb_along(e, c, e.n_AB_W + c.friction * direction_that_begins(e));
}

Sliding paper_sliding(double friction, double dt, double tau) {
  return {power(1.0 - friction, dt / tau), std::numeric_limits<double>::infinity()};
}

Sliding coulomb_sliding(double friction, double, double) {
  return {friction > 0.0 ? 0.0 : 1.0, friction};
}

std::span<const Response> responses() {
  static const std::array<Response, 2> kResponses{{
      {"paper", paper_impulse, paper_sliding,
       "momentum always; energy for elasticity 1 with friction 0 or 1; energy never grows"},
      {"coulomb", coulomb_impulse, coulomb_sliding,
       "momentum always; energy for elasticity 1 with friction 0; energy never grows"},
  }};
  return kResponses;
}

const Response& response_under(std::string_view name, int rules) {
  static const Response kCoulombToRules7{"coulomb", coulomb_impulse_to_rules_7, coulomb_sliding,
                                         responses()[1].keeps};
  const Response& response = response_named(name);
  return name == kCoulombToRules7.name && rules <= 7 ? kCoulombToRules7 : response;
}

const Response& response_named(std::string_view name) {
  std::string known;
  for (const Response& r : responses()) {
    if (r.name == name) return r;
    known += (known.empty() ? "" : ", ") + std::string(r.name);
  }
  throw std::invalid_argument("response: expected one of " + known + ", found '" +
                              std::string(name) + "'");
}

}  // namespace headpin::engine
