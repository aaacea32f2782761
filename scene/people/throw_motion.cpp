#include "scene/people/throw_motion.h"

#include <algorithm>

#include "scene/play/release.h"

namespace headpin::scene {

using devices::MotionRecording;

Vec3 velocity(const std::vector<Time>& times, const std::vector<Pose>& track, std::size_t i) {
  const std::size_t before = i == 0 ? 0 : i - 1, after = std::min(i + 1, track.size() - 1);
  return (track[after].p - track[before].p) / seconds(times[after] - times[before]);
}

Twist ball_velocity(const MotionRecording& r, std::size_t release, Side side, const Vec3& p_HB,
                    const Hand& rules) {
  const std::vector<Pose>& hand = throwing_hand(r, side);
  const ReleaseWindow window = release_window(rules);
  const bool after = rules.release_at == "trigger";
  const Time last = after ? told_until(r.times[release], seconds(kReadLate)) : r.times[release];
  std::vector<Stamped<Pose>> track;
  for (std::size_t i = 0; i < r.times.size(); ++i) {
    if (r.times[release] - r.times[i] > window.longest() || r.times[i] > last) continue;
    track.push_back({r.times[i], hand[i]});
  }
  return after ? motion_at(track, r.times[release], p_HB, window).V_WB
               : release_velocity(track, p_HB, window);
}

Vec3 hand_velocity_at(const MotionRecording& r, const Throw& found, const Hand& hand) {
  return ball_velocity(r, found.release, found.side, Vec3::Zero(), hand).v;
}

std::pair<std::size_t, std::size_t> samples_of_swing(const MotionRecording& r, const Throw& found) {
  constexpr Time kSwing{1'000'000};
  std::size_t begin = found.release;
  while (begin > 0 && r.times[begin - 1] >= r.times[found.release] - kSwing) --begin;
  return {begin, found.release + 1};
}

Vec3 mean_look(const MotionRecording& r, const Throw& found) {
  const auto [begin, end] = samples_of_swing(r, found);
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = begin; i < end; ++i) sum += r.head[i].q * -Vec3::UnitZ();
  return sum / static_cast<double>(end - begin);
}

double fastest(const MotionRecording& r, const std::vector<Pose>& track) {
  double speed = 0.0;
  for (std::size_t i = 0; i < track.size(); ++i) {
    speed = std::max(speed, velocity(r.times, track, i).norm());
  }
  return speed;
}

}  // namespace headpin::scene
