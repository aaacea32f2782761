#include "scene/hand.h"

#include <stdexcept>
#include <vector>

#include <fmt/format.h>

namespace headpin::scene {

namespace {

/// Slope at t = 0 of the parabola through points whose last one lies there, by least squares; of
/// the line through them where they are fewer than four.
///
/// @param t  [s], rising to 0
/// @return   per second
Vec3 slope_at_end(std::span<const double> t, std::span<const Vec3> y) {
  const int terms = t.size() >= 4 ? 3 : 2;
  const double scale = -t.front();  // t / scale lies in -1 .. 0
  Mat3 normal = Mat3::Identity();   // of 1, x, x^2; the identity where a term is left out
  normal.topLeftCorner(terms, terms).setZero();
  Mat3 right = Mat3::Zero();
  for (std::size_t i = 0; i < t.size(); ++i) {
    const double x = t[i] / scale;
    Vec3 powers(1.0, x, x * x);
    powers.tail(3 - terms).setZero();
    normal.topLeftCorner(terms, terms) += (powers * powers.transpose()).topLeftCorner(terms, terms);
    right += powers * y[i].transpose();
  }
  const Mat3 coefficients = normal.inverse() * right;
  return coefficients.row(1).transpose() / scale;
}

}  // namespace

Twist release_velocity(std::span<const Stamped<Pose>> track, const Vec3& p_HB, Time window) {
  std::vector<double> t;
  std::vector<Vec3> p, turn;  // of the hand, from its last pose
  for (const Stamped<Pose>& sample : track) {
    if (sample.time < track.back().time - window) continue;
    t.push_back(seconds(sample.time - track.back().time));
    p.push_back(sample.value.p - track.back().value.p);
    turn.push_back(rotation_vector(sample.value.q * track.back().value.q.conjugate()));
  }
  if (t.size() < 2) {
    throw std::invalid_argument(fmt::format(
        "release velocity: expected two hand samples within {} s of the release, found {}",
        seconds(window), t.size()));
  }
  const Vec3 v_WH = slope_at_end(t, p), w_WH = slope_at_end(t, turn);
  return {v_WH + w_WH.cross(track.back().value.q * p_HB), w_WH};
}

}  // namespace headpin::scene
