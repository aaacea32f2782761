#include "scene/people/throw_motion.h"

#include <algorithm>

#include "scene/play/release.h"

namespace headpin::scene {

using devices::MotionRecording;

MotionRecording samples_of(const MotionRecording& r, std::size_t begin, std::size_t end) {
  MotionRecording part = r;
  const auto cut = [&](auto& list) {
    if (list.empty()) return;
    list.erase(list.begin() + static_cast<std::ptrdiff_t>(end), list.end());
    list.erase(list.begin(), list.begin() + static_cast<std::ptrdiff_t>(begin));
  };
  for (auto* track : {&part.head, &part.left_hand, &part.right_hand}) cut(*track);
  cut(part.times);
  const Time start = r.times[begin];
  for (Time& time : part.times) time -= start;
  part.start += start;
  for (auto& trigger : part.triggers) {
    for (Stamped<bool>& change : trigger) change.time -= start;
    const auto first =
        std::ranges::find_if(trigger, [](const auto& c) { return c.time >= Time{}; });
    const bool held = first != trigger.begin() && std::prev(first)->value;  // since before
    if (held) std::prev(first)->time = Time{};
    trigger.erase(trigger.begin(), held ? std::prev(first) : first);
  }
  return part;
}

Vec3 velocity(const std::vector<Time>& times, const std::vector<Pose>& track, std::size_t i) {
  const std::size_t before = i == 0 ? 0 : i - 1, after = std::min(i + 1, track.size() - 1);
  return (track[after].p - track[before].p) / seconds(times[after] - times[before]);
}

Motion ball_motion(const MotionRecording& r, Time release, Side side, const Vec3& p_HB,
                   const Hand& rules) {
  const std::vector<Pose>& hand = throwing_hand(r, side);
  const ReleaseWindow window = release_window(rules);
  const bool after = rules.release_at == ReleaseAt::trigger;
  const Time last = after ? told_until(release, seconds(kReadLate)) : release;
  std::vector<Stamped<Pose>> track;
  for (std::size_t i = 0; i < r.times.size(); ++i) {
    if (release - r.times[i] > window.longest() || r.times[i] > last) continue;
    track.push_back({r.times[i], hand[i]});
  }
  if (after) return motion_at(track, release, p_HB, window);
  return {.V_WB = release_velocity(track, p_HB, window), .known = Known::tracked};
}

Vec3 hand_velocity_at(const MotionRecording& r, const Throw& found, const Hand& hand) {
  return ball_motion(r, found.release_time, found.side, Vec3::Zero(), hand).V_WB.v;
}

std::pair<std::size_t, std::size_t> samples_of_swing(const MotionRecording& r, const Throw& found) {
  constexpr Time kSwing{1'000'000};
  std::size_t begin = found.release;
  while (begin > 0 && r.times[begin - 1] >= r.times[found.release] - kSwing) --begin;
  return {begin, found.release + 1};
}

Vec3 mean_gaze(const MotionRecording& r, const Throw& found) {
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
