#include "scene/hand.h"

#include <stdexcept>

#include <fmt/format.h>

namespace headpin::scene {

Twist release_velocity(std::span<const Stamped<Pose>> track, const Vec3& p_HB, Time window) {
  std::size_t first = track.size();
  while (first > 0 && track[first - 1].time >= track.back().time - window) --first;
  const std::span<const Stamped<Pose>> recent = track.subspan(first);
  if (recent.size() < 2) {
    throw std::invalid_argument(fmt::format(
        "release velocity: expected two hand samples within {} s of the release, found {}",
        seconds(window), recent.size()));
  }

  const auto n = static_cast<double>(recent.size());
  double mean_t = 0.0;
  Vec3 mean_p = Vec3::Zero();
  for (const auto& sample : recent) {
    mean_t += seconds(sample.time - recent.front().time) / n;
    mean_p += sample.value.p / n;
  }
  double tt = 0.0;
  Vec3 tp = Vec3::Zero();
  for (const auto& sample : recent) {
    const double t = seconds(sample.time - recent.front().time) - mean_t;
    tt += t * t;
    tp += t * (sample.value.p - mean_p);
  }
  const Vec3 v_WH = tp / tt;

  const Pose& X_WH = recent.back().value;
  const Quat turn_W = X_WH.q * recent.front().value.q.conjugate();
  const Vec3 w_WH = rotation_vector(turn_W) / seconds(recent.back().time - recent.front().time);
  return {v_WH + w_WH.cross(X_WH.q * p_HB), w_WH};
}

}  // namespace headpin::scene
