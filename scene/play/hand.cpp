#include "scene/play/hand.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "scene/play/parabola.h"

namespace headpin::scene {

namespace {

/// A slope and its standard error along an axis; 0 if the error is not known.
struct Slope {
  Vec3 value;
  double deviation = 0.0;
};

/// Slope at t = 0, which is the last point, of a least-squares parabola; of a line if there are
/// fewer than four points.
///
/// @param t  [s], rising to 0
/// @return   per second
Slope slope_at_end(std::span<const double> t, std::span<const Vec3> y) {
  const int terms = t.size() >= 4 ? 3 : 2;
  const double scale = -t.front();
  std::vector<double> x;  // in -1 .. 0
  for (const double ti : t) x.push_back(ti / scale);
  const Parabola fit = fit_parabola(x, y, terms);
  Slope slope{fit.coefficients.row(1).transpose() / scale};
  if (terms < 3) return slope;
  double squares = 0.0;  // sum of squared residuals, on three axes
  for (std::size_t i = 0; i < x.size(); ++i) {
    squares += (y[i] - fit.coefficients.transpose() * Vec3(1.0, x[i], x[i] * x[i])).squaredNorm();
  }
  const double variance = squares / (3.0 * static_cast<double>(x.size() - 3));
  slope.deviation = std::sqrt(variance * fit.inverse(1, 1)) / scale;
  return slope;
}

}  // namespace

Twist release_velocity(std::span<const Stamped<Pose>> track, const Vec3& p_HB,
                       const ReleaseWindow& window) {
  std::vector<double> t;
  std::vector<Vec3> p, turn;  // of the hand, from its last pose
  std::size_t first = 0;      // in the window
  for (const Stamped<Pose>& sample : track) {
    const Time age = track.back().time - sample.time;
    if (age > window.longest()) continue;
    if (age > window.least) ++first;
    t.push_back(seconds(-age));
    p.push_back(sample.value.p - track.back().value.p);
    turn.push_back(rotation_vector(sample.value.q * track.back().value.q.conjugate()));
  }
  if (t.size() < 2) {
    throw std::invalid_argument(fmt::format(
        "release velocity: expected two hand samples within {} s of the release, found {}",
        seconds(window.longest()), t.size()));
  }
  first = std::min(first, t.size() - 2);  // across a gap
  const auto fit = [&](const std::vector<Vec3>& y) {
    return slope_at_end(std::span(t).subspan(first), std::span(y).subspan(first));
  };
  Slope v_WH = fit(p);
  while (first > 0 && v_WH.deviation > window.accuracy) {
    --first;
    v_WH = fit(p);
  }
  const Vec3 w_WH = fit(turn).value;
  return {v_WH.value + w_WH.cross(track.back().value.q * p_HB), w_WH};
}

}  // namespace headpin::scene
