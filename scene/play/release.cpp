#include "scene/play/release.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace headpin::scene {

namespace {

using Track = std::vector<Stamped<Pose>>;
// Plain sums in a fixed order, because a library's order of four numbers depends on the processor.
using Four = std::array<double, 4>;
using Square = std::array<Four, 4>;

constexpr double kFastestHand = 20.0;  // m/s; the fastest bowlers' hands reach half of it
constexpr double kUsualHand = 10.0;    // m/s, faster is less likely
constexpr double kFastestOver = 12.0;  // m/s, limit across samples that are left out
constexpr double kJitter = 0.05;       // m, between two samples of a noisy tracker
constexpr Time kFollowed{30'000};      // extrapolation after the last sample
constexpr double kAfter = 0.04;        // s, part of the window after the time
constexpr Time kHole{50'000};          // a longer time between two samples was not tracked
constexpr double kOffPath = 0.015, kOffTurn = 0.15;  // m, rad: a nearer sample is no outlier
constexpr double kOffFit = 16.0;           // without an outlier, squares are smaller by this factor
constexpr std::size_t kFewestToJudge = 7;  // a cubic and three more

/// Cost of the assumption that the hand moved from sample a to sample b and that the `skipped`
/// samples in between are wrong. A kept sample is worth 1. Nothing if no hand is fast enough.
std::optional<double> cost(const Stamped<Pose>& a, const Stamped<Pose>& b, std::size_t skipped) {
  const double dt = std::abs(seconds(b.time - a.time));
  const double speed = std::max(0.0, (b.value.p - a.value.p).norm() - kJitter) / dt;
  if (speed > (skipped == 0 ? kFastestHand : kFastestOver)) return std::nullopt;
  return 0.95 * static_cast<double>(skipped) + std::max(0.0, speed - kUsualHand) / kUsualHand;
}

/// The samples of a track that are plausible for a hand: the sequence with the most samples at the
/// least cost; of equal sequences, the latest.
Track possible(std::span<const Stamped<Pose>> track) {
  std::vector<double> worth(track.size(), 1.0);
  std::vector<std::size_t> before(track.size());
  std::size_t last = 0;
  for (std::size_t j = 0; j < track.size(); ++j) {
    before[j] = j;
    for (std::size_t i = j; i-- > 0;) {
      const std::optional<double> link = cost(track[i], track[j], j - i - 1);
      if (!link || worth[i] + 1.0 - *link <= worth[j]) continue;
      worth[j] = worth[i] + 1.0 - *link;
      before[j] = i;
      if (*link == 0.0) break;
    }
    if (worth[j] >= worth[last]) last = j;
  }
  Track kept;
  for (std::size_t j = last;; j = before[j]) {
    kept.push_back(track[j]);
    if (before[j] == j) break;
  }
  std::ranges::reverse(kept);
  return kept;
}

/// A polynomial through points in time, by weighted least squares.
struct Fit {
  Vec3 slope = Vec3::Zero();  ///< at t = 0, per second
  double deviation = 0.0;     ///< of the slope along an axis; 0 if unknown
  std::size_t worst = 0;      ///< the point that disagrees most with the others
  double off = 0.0;           ///< its distance from the fit of the others
  bool alone = false;         ///< without it the others fit much better
};

double tricube(double u) {
  const double v = 1.0 - u * u * u;
  return u < 1.0 ? v * v * v : 0.0;
}

/// Weights of a window that reaches back by `before`.
std::vector<double> weights(std::span<const double> t, double before) {
  std::vector<double> w;
  w.reserve(t.size());
  for (const double ti : t) w.push_back(tricube(ti < 0.0 ? -ti / before : ti / kAfter));
  return w;
}

/// a^-1 for the first `n` rows and columns, positive definite.
template <std::size_t n>
Square inverse(Square a) {
  Square b{};
  for (std::size_t i = 0; i < n; ++i) b[i][i] = 1.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double pivot = a[i][i];
    for (std::size_t j = 0; j < n; ++j) {
      a[i][j] /= pivot;
      b[i][j] /= pivot;
    }
    for (std::size_t k = 0; k < n; ++k) {
      if (k == i) continue;
      const double f = a[k][i];
      for (std::size_t j = 0; j < n; ++j) {
        a[k][j] -= f * a[i][j];
        b[k][j] -= f * b[i][j];
      }
    }
  }
  return b;
}

template <std::size_t n>
double form(const Four& x, const Square& a, const Four& y) {
  double sum = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) sum += x[i] * a[i][j] * y[j];
  }
  return sum;
}

/// The part of a weighted least-squares problem that depends only on the times of the points.
struct Design {
  std::span<const double> w;
  std::size_t used = 0;  ///< points that have a weight
  std::size_t n = 0;     ///< coefficients of the polynomial
  std::vector<Four> powers;
  Square squared{}, solved{};
  double sum = 0.0;           ///< of the weights
  std::vector<double> apart;  ///< 1 - leverage of each point, if points are more than coefficients
};

constexpr double kScale = 0.05;  // of the times [s]

/// Calls f.template operator()<n>() with the number of coefficients, so that loops over them have no counters: a
/// moving hand is fitted at each tick.
template <typename F>
auto with_terms(std::size_t n, F&& f) {
  return n == 4   ? f.template operator()<4>()
         : n == 3 ? f.template operator()<3>()
                  : f.template operator()<2>();
}

template <std::size_t n>
void set_up(Design& d, std::span<const double> t, std::span<const double> w) {
  Square normal{};
  d.powers.resize(t.size());
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (!(w[i] > 0.0)) continue;
    const double x = t[i] / kScale;
    const Four& p = d.powers[i] = {1.0, x, x * x, x * x * x};
    for (std::size_t a = 0; a < n; ++a) {
      for (std::size_t b = 0; b < n; ++b) {
        normal[a][b] += w[i] * p[a] * p[b];
        d.squared[a][b] += w[i] * w[i] * p[a] * p[b];
      }
    }
    d.sum += w[i];
  }
  d.solved = inverse<n>(normal);
  if (d.used <= n) return;
  d.apart.resize(t.size());
  for (std::size_t i = 0; i < t.size(); ++i) {
    const Four& p = d.powers[i];
    if (w[i] > 0.0) d.apart[i] = 1.0 - w[i] * form<n>(p, d.solved, p);
  }
}

/// @param t  [s]; slopes are those at 0
/// @param w  must outlive the result
Design design(std::span<const double> t, std::span<const double> w) {
  Design d;
  d.w = w;
  d.used = static_cast<std::size_t>(
      std::ranges::count_if(w, [](double weight) { return weight > 0.0; }));
  if (d.used < 2) return d;
  d.n = d.used >= 5 ? 4 : d.used == 4 ? 3 : 2;
  with_terms(d.n, [&]<std::size_t n> { set_up<n>(d, t, w); });
  return d;
}

template <std::size_t n>
Fit fit(const Design& d, std::span<const Vec3> y) {
  Fit found;
  std::array<Vec3, 4> right{Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  for (std::size_t i = 0; i < y.size(); ++i) {
    if (!(d.w[i] > 0.0)) continue;
    for (std::size_t a = 0; a < n; ++a) right[a] += d.w[i] * d.powers[i][a] * y[i];
  }
  std::array<Vec3, 4> coefficient{Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  for (std::size_t a = 0; a < n; ++a) {
    for (std::size_t b = 0; b < n; ++b) coefficient[a] += d.solved[a][b] * right[b];
  }
  found.slope = coefficient[1] / kScale;
  if (d.used <= n) return found;
  double squares = 0.0, most = -1.0;
  for (std::size_t i = 0; i < y.size(); ++i) {
    if (!(d.w[i] > 0.0)) continue;
    Vec3 left = y[i];
    for (std::size_t a = 0; a < n; ++a) left -= d.powers[i][a] * coefficient[a];
    squares += d.w[i] * left.squaredNorm();
    // The decrease of the sum of squares without this point.
    const double without = d.w[i] * left.squaredNorm() / d.apart[i];
    if (!(d.apart[i] > 1e-6) || without <= most) continue;
    most = without;
    found.worst = i;
    found.off = left.norm() / d.apart[i];
  }
  found.alone = d.used >= kFewestToJudge && kOffFit * (squares - most) < squares;
  const double variance =
      squares / (3.0 * d.sum) * static_cast<double>(d.used) / static_cast<double>(d.used - n);
  found.deviation = std::sqrt(variance * form<n>(d.solved[1], d.squared, d.solved[1])) / kScale;
  return found;
}

Fit fit(const Design& d, std::span<const Vec3> y) {
  if (d.used < 2) return {};
  return with_terms(d.n, [&]<std::size_t n> { return fit<n>(d, y); });
}

/// The samples of a track that are used for a time, back to the start of the longest window.
struct Near {
  Track track;
  int left_out = 0;
};

Near samples_near(std::span<const Stamped<Pose>> track, Time at, const ReleaseWindow& window) {
  const Time latest = std::min(at, track.back().time);
  std::size_t first = 0, oldest = 0, end = track.size();
  while (end > 0 && track[end - 1].time >= at + microseconds(kAfter)) --end;
  oldest =
      static_cast<std::size_t>(std::ranges::upper_bound(track.first(end), latest - window.longest(),
                                                        {}, &Stamped<Pose>::time) -
                               track.begin());
  first = oldest;
  while (first < end && track[first].time <= latest - window.least) ++first;
  if (end - first < 3) first = oldest;
  if (first == end) return {};
  const auto inside = track.subspan(first, end - first);
  Near near{possible(inside)};
  near.left_out = static_cast<int>(inside.size() - near.track.size());
  Track older;
  for (std::size_t i = first; i-- > oldest;) {
    const Stamped<Pose>& next = older.empty() ? near.track.front() : older.back();
    if (cost(track[i], next, 0)) older.push_back(track[i]);
  }
  near.track.insert(near.track.begin(), older.rbegin(), older.rend());
  return near;
}

/// Time to the nearest sample; 0 between two samples that are near each other.
Time away(const Track& track, Time at) {
  const auto after = std::ranges::lower_bound(track, at, {}, &Stamped<Pose>::time);
  if (after == track.end()) return at - track.back().time;
  if (after->time == at) return Time{};
  if (after == track.begin()) return after->time - at;
  const Time since = at - (after - 1)->time, until = after->time - at;
  return since + until <= kHole ? Time{} : std::min(since, until);
}

/// The pose at a time: interpolated between two samples, and held before the first and after the last.
Pose pose_at(const Track& track, Time at) {
  const auto after = std::ranges::lower_bound(track, at, {}, &Stamped<Pose>::time);
  if (after == track.end()) return track.back().value;
  if (after == track.begin()) return after->value;
  const Stamped<Pose>& before = *(after - 1);
  return interpolate(before.value, after->value,
                     seconds(at - before.time) / seconds(after->time - before.time));
}

/// The two fits of a track at a time, over the shortest window that is accurate enough.
struct Fits {
  Fit path, turn;
};

Fits fits(const Track& track, Time at, const Quat& q_WH, const ReleaseWindow& window) {
  std::vector<double> t;
  std::vector<Vec3> p;
  t.reserve(track.size());
  p.reserve(track.size());
  for (const Stamped<Pose>& sample : track) {
    t.push_back(seconds(sample.time - at));
    p.push_back(sample.value.p - track.back().value.p);
  }
  const auto fit_turn = [&](const Design& times) {
    std::vector<Vec3> turn(track.size(), Vec3::Zero());
    for (std::size_t i = 0; i < track.size(); ++i) {
      if (times.w[i] > 0.0) turn[i] = rotation_vector(track[i].value.q * q_WH.conjugate());
    }
    return fit(times, turn);
  };
  const double past = std::max(0.0, -t.back());
  const double least = seconds(window.least) + past, most = seconds(window.longest()) + past;
  for (double before = least;; before = std::min(most, before + 0.25 * least)) {
    const std::vector<double> w = weights(t, before);
    const Design times = design(t, w);
    const Fit path = fit(times, p);
    const bool enough = times.used >= 3 && path.deviation <= window.accuracy;
    if (path.alone || enough || before >= most) return {path, fit_turn(times)};
  }
}

}  // namespace

Motion motion_at(std::span<const Stamped<Pose>> track, Time at, const Vec3& p_HB,
                 const ReleaseWindow& window) {
  if (track.empty() || track.back().time < at - window.least) return {};
  Near near = samples_near(track, at, window);
  while (near.track.size() >= 2) {
    const Time last = near.track.back().time;
    const Time there = std::min(at, last + kFollowed);
    const Pose X_PH = pose_at(near.track, there);
    const Fits found = fits(near.track, there, X_PH.q, window);
    const auto leave_out = [&](const Fit& fit) {
      near.track.erase(near.track.begin() + static_cast<std::ptrdiff_t>(fit.worst));
      ++near.left_out;
    };
    if (found.path.alone && found.path.off > kOffPath) {
      leave_out(found.path);
    } else if (found.turn.alone && found.turn.off > kOffTurn) {
      leave_out(found.turn);
    } else {
      Motion motion{{found.path.slope + found.turn.slope.cross(X_PH.q * p_HB), found.turn.slope},
                    Known::tracked,
                    away(near.track, at),
                    near.left_out,
                    X_PH};
      if (motion.extrapolated > window.least || !(motion.V_WB.v.norm() <= kFastestHand)) break;
      if (motion.extrapolated > Time{}) motion.known = Known::extrapolated;
      return motion;
    }
  }
  Motion none;
  none.left_out = near.left_out;
  if (!near.track.empty()) none.X_PH = pose_at(near.track, at);
  return none;
}

}  // namespace headpin::scene
