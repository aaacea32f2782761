#include "scene/people/throw.h"

#include <algorithm>
#include <stdexcept>

#include "scene/people/throw_motion.h"
#include "scene/play/hand.h"
#include "scene/play/release.h"

namespace headpin::scene {
namespace {

using devices::MotionRecording;

constexpr double kRestingHand = 0.35;  // m/s

/// Position of the ball in the hand. The scenario has that of a right hand; for a left one it is
/// mirrored.
Vec3 grip_of(const Hand& hand, Side side) {
  const Vec3& p = hand.grip;
  return side == Side::left ? Vec3(-p.x(), p.y(), p.z()) : p;
}

/// The same of what the fingers add to the spin.
Vec3 spin_of(const Hand& hand, Side side) {
  const Vec3& w = hand.spin;
  return side == Side::left ? Vec3(w.x(), -w.y(), -w.z()) : w;
}

template <typename Score>
std::size_t best(std::size_t begin, std::size_t end, const Score& score) {
  std::size_t best = begin;
  for (std::size_t i = begin; i < end; ++i) {
    if (score(i) > score(best)) best = i;
  }
  return best;
}

/// The last sample at or before a time; the first if all are later.
std::size_t sample_at(const std::vector<Time>& times, Time time) {
  const auto after = std::ranges::upper_bound(times, time);
  return after == times.begin() ? 0 : static_cast<std::size_t>(after - times.begin()) - 1;
}

/// Grab and release by the trigger: the press that ends nearest to a time.
void take_trigger(const MotionRecording& r, Time fastest, Throw& found) {
  const std::vector<Stamped<bool>>& trigger = r.triggers[found.side == Side::left ? 0 : 1];
  for (std::size_t i = 1; i < trigger.size(); ++i) {
    const Time released = trigger[i].time;
    if (trigger[i].value || released < r.times.front() || released > r.times.back()) continue;
    if (found.by_trigger &&
        std::chrono::abs(found.release_time - fastest) <= std::chrono::abs(released - fastest)) {
      continue;
    }
    found.by_trigger = true;
    found.release_time = released;
    found.grab_time = std::max(trigger[i - 1].time, r.times.front());
  }
  if (!found.by_trigger) return;
  found.grab = sample_at(r.times, found.grab_time);
  found.release = sample_at(r.times, found.release_time);
}

devices::TrackerSample tracker(const MotionRecording& r, std::size_t i, std::int32_t station,
                               const Pose& X_TS) {
  devices::TrackerSample sample;
  sample.device_time = r.times[i];
  sample.sequence = static_cast<std::int64_t>(i);
  sample.station = station;
  sample.X_TS = X_TS;
  return sample;
}

/// The world's x, y, z in the frame of the recording: right, ahead, up.
Quat turned_ahead(const Vec3& ahead) {
  Mat3 R_TW;
  R_TW << ahead.cross(kUp), ahead, kUp;
  return Quat(R_TW.transpose());
}

constexpr Time kApart{1'500'000};  // longer than back swing to throw, shorter than between throws
constexpr Time kSwingsOn{1'000'000};

/// The samples at which a hand is fastest in each of its throws.
std::vector<std::size_t> throw_peaks(const MotionRecording& r, Side side) {
  const std::vector<Pose>& track = throwing_hand(r, side);
  std::vector<std::size_t> peaks;
  std::vector<double> speeds;
  for (std::size_t i = 0; i < track.size(); ++i) {
    speeds.push_back(track.size() < 2 ? 0.0 : horizontal(velocity(r.times, track, i)).norm());
  }
  for (std::size_t i = 0; i < track.size(); ++i) {
    if (speeds[i] < kSlowestThrow) continue;
    if (peaks.empty() || r.times[i] - r.times[peaks.back()] > kApart) {
      peaks.push_back(i);
    } else if (speeds[i] > speeds[peaks.back()]) {
      peaks.back() = i;
    }
  }
  return peaks;
}

/// The part of [begin, end) between the gaps before the swing and after the follow-through of the
/// throw that is fastest at `peak`.
std::pair<std::size_t, std::size_t> between_gaps(const std::vector<Time>& times, Time peak,
                                                 std::size_t begin, std::size_t end) {
  for (std::size_t i = begin + 1; i < end; ++i) {
    if (seconds(times[i] - times[i - 1]) <= kLongestGap) continue;
    if (times[i] <= peak - kApart) begin = i;
    if (times[i - 1] >= peak + kSwingsOn) return {begin, i};
  }
  return {begin, end};
}

std::int32_t station_of(Side side) {
  return side == Side::left ? devices::kLeftHandStation : devices::kHandStation;
}

/// @param side  of the hand that throws
void use_recorded_rig(Scenario& scenario, const Quat& q_WT, const Vec3& p_over_foul_line,
                      Side side) {
  const Vec3 p_W = q_WT * -horizontal(p_over_foul_line);
  scenario.rig.X_WT = {q_WT.normalized(), Vec3(p_W.x(), p_W.y(), 0.0)};
  scenario.rig.head_station = devices::kHeadStation;  // as in to_samples
  scenario.rig.hand_station = station_of(side);
  scenario.rig.X_SD = {};
  scenario.rig.X_SH = {};
  scenario.rig.delay_s = nearest_seconds(kReadLate);
}

}  // namespace

const std::vector<Pose>& throwing_hand(const MotionRecording& r, Side side) {
  return side == Side::left ? r.left_hand : r.right_hand;
}

Throw find_throw(const MotionRecording& r, const Hand& hand, Side side) {
  if (r.times.size() < 10) throw std::invalid_argument("a throw takes at least ten samples");
  const std::size_t n = r.times.size();
  const std::vector<Pose>& track = throwing_hand(r, side);
  const auto hand_velocity = [&](std::size_t i) { return velocity(r.times, track, i); };
  const auto hand_height = [&](std::size_t i) { return track[i].p.y(); };
  const auto level_speed = [&](std::size_t i) { return horizontal(hand_velocity(i)).norm(); };
  const ReleaseWindow window = release_window(hand);

  Throw found;
  found.side = side;
  const std::size_t peak = best(0, n, [&](std::size_t i) { return hand_velocity(i).norm(); });
  found.peak_hand_speed = hand_velocity(peak).norm();

  const std::size_t fastest = std::max<std::size_t>(best(0, n, level_speed), 1);
  std::size_t swing = fastest;
  constexpr Time kSwing{200'000};
  while (swing > 0 && r.times[swing - 1] >= r.times[fastest] - kSwing) --swing;
  const std::size_t lowest =
      best(swing, fastest + 1, [&](std::size_t i) { return -hand_height(i); });
  found.release = std::min(lowest + 1, fastest);
  // The grab is the lowest sample at which the hand rests, except at the end of the back swing. A
  // hand that never rests has the ball from the start.
  constexpr Time kForward{1'500'000};
  const Vec3 along = horizontal(hand_velocity(fastest));
  for (std::size_t i = 0; i < found.release; ++i) {
    const bool lower = found.grab == 0 || hand_height(i) < hand_height(found.grab);
    const bool swung_back =
        r.times[found.release] - r.times[i] < kForward && along.dot(track[i].p - r.head[i].p) < 0.0;
    if (hand_velocity(i).norm() < kRestingHand && lower && !swung_back) found.grab = i;
  }
  found.grab_time = r.times[found.grab];
  found.release_time = r.times[found.release];
  take_trigger(r, r.times[fastest], found);
  if (found.release_time - window.least >= r.times.front()) {
    const Motion ball = ball_motion(r, found.release_time, side, grip_of(hand, side), hand);
    found.V_TB = ball.V_WB;
    found.known = ball.known;
    found.extrapolated = ball.extrapolated;
  }
  return found;
}

std::vector<MotionRecording> split_throws(const MotionRecording& r, Side side) {
  const std::vector<std::size_t> peaks = throw_peaks(r, side);
  if (peaks.empty()) return {r};
  const auto first_after = [&](Time time) {
    return static_cast<std::size_t>(std::ranges::upper_bound(r.times, time) - r.times.begin());
  };
  std::vector<MotionRecording> all;
  std::size_t begin = 0;
  for (std::size_t k = 0; k < peaks.size(); ++k) {
    const Time peak = r.times[peaks[k]];
    std::size_t end = r.times.size(), next_begin = end;
    if (k + 1 < peaks.size()) {
      // The follow-through belongs to this throw, the way back to the ball to both.
      const Time next = r.times[peaks[k + 1]];
      const Time follows = peak + std::min(kSwingsOn, (next - peak) / 2);
      next_begin = first_after(follows);
      end = first_after(std::max(follows, next - kApart));
    }
    const auto [from, to] = between_gaps(r.times, peak, begin, end);
    const bool whole = from == 0 && to == r.times.size();
    all.push_back(whole ? r : samples_of(r, from, to));
    begin = next_begin;
  }
  return all;
}

Scenario stand_thrower(Scenario scenario, const MotionRecording& recording, const Throw& found,
                       Heading heading) {
  Vec3 ahead = -Vec3::UnitZ();
  if (heading == Heading::release) ahead = horizontal(found.V_TB.v).normalized();
  if (heading == Heading::gaze) ahead = horizontal(mean_gaze(recording, found)).normalized();
  const Quat q_WT = turned_ahead(ahead);

  scenario.hand.grip = grip_of(scenario.hand, found.side);
  scenario.hand.spin = spin_of(scenario.hand, found.side);
  const std::vector<Pose>& track = throwing_hand(recording, found.side);
  const Vec3 p_TB = track[found.release] * scenario.hand.grip;
  use_recorded_rig(scenario, q_WT, p_TB, found.side);
  scenario.ball.home = scenario.rig.X_WT * (track[found.grab] * scenario.hand.grip);
  return scenario;
}

Scenario stand_onlooker(Scenario scenario, const MotionRecording& recording, Heading heading) {
  Vec3 ahead = -Vec3::UnitZ();
  if (heading != Heading::keep) {
    Vec3 gaze = Vec3::Zero();
    for (std::size_t i = 0; i < recording.times.size() && recording.times[i] < Time{1'000'000};
         ++i) {
      gaze += horizontal(recording.head[i].q * -Vec3::UnitZ());
    }
    if (gaze.norm() > 0.0) ahead = gaze.normalized();
  }
  use_recorded_rig(scenario, turned_ahead(ahead), recording.head.front().p, Side::right);
  return scenario;
}

std::vector<devices::Sample> head_samples(const MotionRecording& recording) {
  std::vector<devices::Sample> samples;
  for (std::size_t i = 0; i < recording.times.size(); ++i) {
    samples.emplace_back(tracker(recording, i, devices::kHeadStation, recording.head[i]));
  }
  return samples;
}

std::vector<devices::Sample> to_samples(const MotionRecording& recording, const Throw& found) {
  const Side other = found.side == Side::left ? Side::right : Side::left;
  std::vector<devices::Sample> samples;
  for (std::size_t i = 0; i < recording.times.size(); ++i) {
    const auto add = [&](std::int32_t station, const Pose& X_TS) {
      samples.emplace_back(tracker(recording, i, station, X_TS));
    };
    add(devices::kHeadStation, recording.head[i]);
    add(station_of(found.side), throwing_hand(recording, found.side)[i]);
    const std::vector<Pose>& resting = throwing_hand(recording, other);
    if (!resting.empty()) add(station_of(other), resting[i]);
    for (const bool pressed : {true, false}) {
      if (i != (pressed ? found.grab : found.release)) continue;
      devices::MouseSample mouse;
      mouse.device_time = pressed ? found.grab_time : found.release_time;
      mouse.trigger = pressed;
      samples.emplace_back(mouse);
    }
  }
  return samples;
}

}  // namespace headpin::scene
