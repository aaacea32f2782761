#include "scene/people/throw.h"

#include <algorithm>
#include <functional>
#include <stdexcept>

#include <fmt/format.h>

#include "scene/play/hand.h"
#include "scene/play/quantile.h"
#include "scene/play/release.h"

namespace headpin::scene {
namespace {

using devices::MotionRecording;

// What a body allows. Standing adults' eyes are 1.4 to 1.8 m up (5th percentile of women to 95th of
// men); wider here for the young, the tall, and headsets worn high. Bowlers let the ball go at up
// to 9.4 m/s.
constexpr double kLowestHead = 1.2, kHighestHead = 2.1;       // m, median
constexpr double kShortestReach = 0.5, kLongestReach = 1.25;  // m, head to hand, at its largest
constexpr double kSlowestThrow = 3.0, kFastestHand = 10.5;    // m/s, hand at its fastest
constexpr double kRestingHand = 0.35;                         // m/s
constexpr double kFastestHead = 3.0;                          // m/s
constexpr double kLeastUpright = 0.7;  // cosine of the head's mean tilt before the release
constexpr double kMostRoll = 0.4;      // sine of the head's roll, but for a tenth of the time
constexpr double kMostUpward = 0.2;    // sine of its mean look upward: the target is on the floor
constexpr double kLeastAtBall = 0.5;   // cosine between look and ball as it is taken
constexpr double kLeastAlong = 0.906;  // cosine between look and throw from above, 25 degrees
constexpr double kLowestRate = 45.0, kHighestRate = 250.0;  // Hz
constexpr double kUsualRate = 59.0;                         // Hz; head-mounted displays: 60 and up
constexpr double kLongestGap = 0.1, kUsualGap = 0.05;       // s
constexpr std::size_t kFewestSamples = 100;
constexpr double kShortestDuration = 2.0;  // s

const Vec3 kUp = Vec3::UnitY();

Vec3 horizontal(const Vec3& v) {
  return Vec3(v.x(), 0.0, v.z());
}

/// Where the ball is in the hand: a scenario has that of a right hand, a left one mirrors it.
Vec3 grip_of(const Hand& hand, Side side) {
  const Vec3& p = hand.grip;
  return side == Side::left ? Vec3(-p.x(), p.y(), p.z()) : p;
}

Vec3 velocity(const std::vector<Time>& times, const std::vector<Pose>& track, std::size_t i) {
  const std::size_t before = i == 0 ? 0 : i - 1, after = std::min(i + 1, track.size() - 1);
  return (track[after].p - track[before].p) / seconds(times[after] - times[before]);
}

template <typename Score>
std::size_t best(std::size_t begin, std::size_t end, const Score& score) {
  std::size_t best = begin;
  for (std::size_t i = begin; i < end; ++i) {
    if (score(i) > score(best)) best = i;
  }
  return best;
}

constexpr Time kReadLate{28'000};  // so long after a sample its pose is used; see stand_thrower

/// As a session has it that reads the poses so late.
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

/// Of the hand, fitted as the ball's will be.
Vec3 hand_velocity_at(const MotionRecording& r, const Throw& found, const Hand& hand) {
  return ball_velocity(r, found.release, found.side, Vec3::Zero(), hand).v;
}

/// The second before the release, when the thrower has the ball in the air and the lane in sight.
std::pair<std::size_t, std::size_t> swing(const MotionRecording& r, const Throw& found) {
  constexpr Time kSwing{1'000'000};
  std::size_t begin = found.release;
  while (begin > 0 && r.times[begin - 1] >= r.times[found.release] - kSwing) --begin;
  return {begin, found.release + 1};
}

Vec3 mean_look(const MotionRecording& r, const Throw& found) {
  const auto [begin, end] = swing(r, found);
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = begin; i < end; ++i) sum += r.head[i].q * -Vec3::UnitZ();
  return sum / static_cast<double>(end - begin);
}

template <typename Value>
std::vector<double> values(const std::vector<Pose>& track, const Value& value) {
  std::vector<double> all;
  all.reserve(track.size());
  for (const Pose& pose : track) all.push_back(value(pose));
  return all;
}

double median_height(const std::vector<Pose>& track) {
  return quantile(values(track, [](const Pose& pose) { return pose.p.y(); }), 0.5);
}

double usual_roll(const std::vector<Pose>& head) {
  const auto roll = [](const Pose& pose) { return std::abs((pose.q * Vec3::UnitX()).y()); };
  return quantile(values(head, roll), 0.9);
}

double fastest(const MotionRecording& r, const std::vector<Pose>& track) {
  double speed = 0.0;
  for (std::size_t i = 0; i < track.size(); ++i) {
    speed = std::max(speed, velocity(r.times, track, i).norm());
  }
  return speed;
}

double longest_reach(const MotionRecording& r, const std::vector<Pose>& hand) {
  double reach = 0.0;
  for (std::size_t i = 0; i < hand.size(); ++i) {
    reach = std::max(reach, (hand[i].p - r.head[i].p).norm());
  }
  return reach;
}

/// How far a hand is to the right of the head, on average over the swing.
double mean_side(const MotionRecording& r, const Throw& found, const std::vector<Pose>& hand) {
  const auto [begin, end] = swing(r, found);
  double sum = 0.0;
  for (std::size_t i = begin; i < end; ++i) {
    const Vec3 look = horizontal(r.head[i].q * -Vec3::UnitZ()).normalized();
    sum += (hand[i].p - r.head[i].p).dot(look.cross(kUp));
  }
  return sum / static_cast<double>(end - begin);
}

std::vector<std::string> problems_of_length(const MotionRecording& r) {
  std::vector<std::string> problems;
  const std::size_t n = r.times.size();
  const double duration = n < 2 ? 0.0 : seconds(r.times.back() - r.times.front());
  if (n < kFewestSamples || duration < kShortestDuration) {
    problems.push_back(fmt::format("{} samples in {:.3g} s, expected at least {} in {} s", n,
                                   duration, kFewestSamples, kShortestDuration));
    return problems;
  }
  const double rate = static_cast<double>(n - 1) / duration;
  if (rate < kLowestRate || rate > kHighestRate) {
    problems.push_back(
        fmt::format("{:.4g} samples a second, expected {} to {}", rate, kLowestRate, kHighestRate));
  }
  for (std::size_t i = 1; i < n; ++i) {
    const double gap = seconds(r.times[i] - r.times[i - 1]);
    if (gap > kLongestGap) {
      problems.push_back(
          fmt::format("nothing for {:.3g} s from {:.3g} s on, expected no gap above {}", gap,
                      seconds(r.times[i - 1]), kLongestGap));
      break;
    }
  }
  return problems;
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
  // Lowest where it rests, other than at the end of the back swing; a hand that never does has had
  // the ball from the start.
  constexpr Time kForward{1'500'000};
  const Vec3 along = horizontal(hand_velocity(fastest));
  for (std::size_t i = 0; i < found.release; ++i) {
    const bool lower = found.grab == 0 || hand_height(i) < hand_height(found.grab);
    const bool swung_back =
        r.times[found.release] - r.times[i] < kForward && along.dot(track[i].p - r.head[i].p) < 0.0;
    if (hand_velocity(i).norm() < kRestingHand && lower && !swung_back) found.grab = i;
  }
  if (r.times[found.release] - window.least >= r.times.front()) {
    found.V_TB = ball_velocity(r, found.release, side, grip_of(hand, side), hand);
  }
  return found;
}

std::vector<std::string> why_no_throw(const MotionRecording& r, const Hand& hand, Side side) {
  const Side other = side == Side::left ? Side::right : Side::left;
  const std::vector<Pose>&throwing = throwing_hand(r, side), &resting = throwing_hand(r, other);
  const auto of_hand = [](Side which, const char* what) {
    return fmt::format("the {} hand{}", which == Side::left ? "left" : "right", what);
  };
  std::vector<std::string> problems = problems_of_length(r);
  if (throwing.empty()) problems.push_back(of_hand(side, " was not tracked"));
  if (!problems.empty()) return problems;  // nothing below can be measured

  const auto expect = [&](std::string_view what, double value, double low, double high,
                          const char* unit) {
    if (value >= low && value <= high) return;
    problems.push_back(
        fmt::format("{} {:.3g} {}, expected {} to {}", what, value, unit, low, high));
  };
  const auto claim = [&](bool holds, std::string otherwise) {
    if (!holds) problems.push_back(std::move(otherwise));
  };

  expect("the head is up", median_height(r.head), kLowestHead, kHighestHead, "m");
  expect(of_hand(side, " goes from the head up to"), longest_reach(r, throwing), kShortestReach,
         kLongestReach, "m");
  expect(of_hand(other, " goes from the head up to"), longest_reach(r, resting), 0.0, kLongestReach,
         "m");

  const Throw found = find_throw(r, hand, side);
  expect(of_hand(side, "'s fastest is"), found.peak_hand_speed, kSlowestThrow, kFastestHand, "m/s");
  expect(of_hand(other, "'s fastest is"), fastest(r, resting), 0.0, kFastestHand, "m/s");
  expect("the head's fastest is", fastest(r, r.head), 0.0, kFastestHead, "m/s");

  const Time release = r.times[found.release];
  if (release - r.times[found.grab] < Time{300'000} || r.times.back() - release < Time{100'000}) {
    problems.push_back(fmt::format(
        "the hand is fastest at {:.3g} s of {:.3g} to {:.3g} s: no room for lift, swing "
        "and follow-through",
        seconds(release), seconds(r.times.front()), seconds(r.times.back())));
    return problems;
  }

  const auto [begin, end] = swing(r, found);
  double upright = 0.0;
  for (std::size_t i = begin; i < end; ++i) upright += (r.head[i].q * kUp).y();
  upright /= static_cast<double>(end - begin);
  claim(upright > kLeastUpright,
        fmt::format("the head is not upright: its up axis rises by {:.2f} of its length, expected "
                    "more than {}",
                    upright, kLeastUpright));
  const double roll = usual_roll(r.head);
  claim(roll < kMostRoll,
        fmt::format("the head is held aslant: its right rises or falls by {:.2f} of its length, "
                    "expected less than {}",
                    roll, kMostRoll));
  const Vec3 look = mean_look(r, found);
  claim(look.y() < kMostUpward,
        fmt::format("the head looks up ({:.2f} of its line of sight), expected less than {}",
                    look.y(), kMostUpward));
  const Vec3 along = horizontal(hand_velocity_at(r, found, hand)).normalized();
  claim(horizontal(look).normalized().dot(along) > kLeastAlong,
        fmt::format("the head looks towards x {:.2f}, z {:.2f}, not along the throw towards x "
                    "{:.2f}, z {:.2f}",
                    look.x(), look.z(), along.x(), along.z()));
  const Pose& head = r.head[found.grab];
  const Vec3 at_ball = (throwing[found.grab].p - head.p).normalized();
  const double on_ball = at_ball.dot(head.q * -Vec3::UnitZ());
  claim(found.grab == 0 || on_ball > kLeastAtBall,
        fmt::format("the head does not look at the ball as the hand takes it: cosine {:.2f}, "
                    "expected more than {}",
                    on_ball, kLeastAtBall));
  if (resting.empty()) {
    const double aside = (side == Side::right ? 1.0 : -1.0) * mean_side(r, found, throwing);
    claim(aside > 0.0,
          fmt::format("{}: {:.2f} m of the head", of_hand(side, " is not on its side"), aside));
    return problems;
  }
  const double right = mean_side(r, found, r.right_hand), left = mean_side(r, found, r.left_hand);
  if (side == Side::right) {
    claim(right > 0.0 && right > left,
          fmt::format("the right hand is not on the right: {:.2f} m right of the head, the left "
                      "hand {:.2f} m",
                      right, left));
  } else {
    claim(left < 0.0 && left < right,
          fmt::format("the left hand is not on the left: {:.2f} m left of the head, the right hand "
                      "{:.2f} m",
                      -left, -right));
  }
  return problems;
}

namespace {

/// A common mistake, undone.
struct Remedy {
  const char* name;
  std::function<void(Time&)> time;
  std::function<void(Pose&)> pose;
};

MotionRecording remedied(MotionRecording r, const Remedy& remedy) {
  if (remedy.time) std::ranges::for_each(r.times, remedy.time);
  if (remedy.pose) {
    for (auto* track : {&r.head, &r.left_hand, &r.right_hand}) {
      std::ranges::for_each(*track, remedy.pose);
    }
  }
  return r;
}

std::vector<Remedy> remedies() {
  const auto scaled = [](double factor) { return [factor](Pose& pose) { pose.p *= factor; }; };
  const auto slower = [](double factor) {
    return [factor](Time& time) { time = microseconds(factor * seconds(time)); };
  };
  const auto mirrored = [](int axis) {
    return [axis](Pose& pose) { pose.p[axis] = -pose.p[axis]; };
  };
  // A mirror turns a rotation about its own axis on, the others back.
  const auto all_mirrored = [](int axis) {
    return [axis](Pose& pose) {
      pose.p[axis] = -pose.p[axis];
      const double kept = pose.q.vec()[axis];
      pose.q.vec() = -pose.q.vec();
      pose.q.vec()[axis] = kept;
    };
  };
  return {
      {"in centimetres", {}, scaled(0.01)},
      {"in metres", {}, scaled(100.0)},
      {"in millimetres", {}, scaled(0.1)},
      {"at a third of the size", {}, scaled(1.0 / 3.0)},
      {"at three times the size", {}, scaled(3.0)},
      {"with y and z exchanged", {}, [](Pose& pose) { std::swap(pose.p.y(), pose.p.z()); }},
      {"with x mirrored", {}, mirrored(0)},
      {"with y mirrored", {}, mirrored(1)},
      {"with z mirrored", {}, mirrored(2)},
      {"with x mirrored, rotations too", {}, all_mirrored(0)},
      {"with z mirrored, rotations too", {}, all_mirrored(2)},
      {"with its quaternions read as x, y, z, w",
       {},
       [](Pose& pose) { pose.q = Quat(pose.q.z(), pose.q.w(), pose.q.x(), pose.q.y()); }},
      {"with its quaternions inverted", {}, [](Pose& pose) { pose.q = pose.q.conjugate(); }},
      {"with time in seconds", slower(1000.0), {}},
      {"with time in microseconds", slower(0.001), {}},
      {"at half the speed", slower(2.0), {}},
      {"at twice the speed", slower(0.5), {}},
      {"at a tenth of the speed", slower(10.0), {}},
      {"at ten times the speed", slower(0.1), {}},
  };
}

}  // namespace

std::vector<std::string> doubts(const MotionRecording& r) {
  std::vector<std::string> said;
  const std::size_t n = r.times.size();
  if (n < 2) return said;
  const double rate = static_cast<double>(n - 1) / seconds(r.times.back() - r.times.front());
  if (rate < kUsualRate) {
    said.push_back(fmt::format("{:.3g} samples a second are few, below {} the release is less sure",
                               rate, kUsualRate));
  }
  double longest = 0.0;
  std::size_t at = 0;
  for (std::size_t i = 1; i < n; ++i) {
    const double gap = seconds(r.times[i] - r.times[i - 1]);
    if (gap > longest) longest = gap, at = i - 1;
  }
  if (longest > kUsualGap) {
    said.push_back(
        fmt::format("nothing for {:.3g} s from {:.3g} s on: what happened there is "
                    "guessed from both sides",
                    longest, seconds(r.times[at])));
  }
  return said;
}

std::vector<MotionRecording> split_throws(const MotionRecording& r, Side side) {
  constexpr Time kApart{1'500'000};  // a back swing is nearer to its throw, the next throw farther
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
  if (peaks.size() < 2) return {r};
  std::vector<MotionRecording> all;
  std::size_t begin = 0;
  for (std::size_t k = 0; k < peaks.size(); ++k) {
    std::size_t end = track.size();
    if (k + 1 < peaks.size()) {
      // The follow-through is this one's; the way back to the ball is the next one's.
      const Time until = r.times[peaks[k]] +
                         std::min(Time{1'000'000}, (r.times[peaks[k + 1]] - r.times[peaks[k]]) / 2);
      end = static_cast<std::size_t>(std::ranges::upper_bound(r.times, until) - r.times.begin());
    }
    MotionRecording one;
    for (std::size_t i = begin; i < end; ++i) {
      one.times.push_back(r.times[i] - r.times[begin]);
      one.head.push_back(r.head[i]);
      if (!r.left_hand.empty()) one.left_hand.push_back(r.left_hand[i]);
      if (!r.right_hand.empty()) one.right_hand.push_back(r.right_hand[i]);
    }
    all.push_back(std::move(one));
    begin = end;
  }
  return all;
}

Side throwing_side(const MotionRecording& r, const Hand& hand) {
  if (r.right_hand.empty()) return Side::left;
  if (r.left_hand.empty()) return Side::right;
  if (why_no_throw(r, hand, Side::right).empty()) return Side::right;
  if (why_no_throw(r, hand, Side::left).empty()) return Side::left;
  return r.times.size() > 1 && fastest(r, r.left_hand) > fastest(r, r.right_hand) ? Side::left
                                                                                  : Side::right;
}

void require_throw(const MotionRecording& recording, const Hand& hand, const std::string& where,
                   Side side) {
  const std::vector<std::string> problems = why_no_throw(recording, hand, side);
  if (problems.empty()) return;
  std::string message = fmt::format("{}: not a person's throw: {}", where, problems.front());
  const Side other = side == Side::left ? Side::right : Side::left;
  MotionRecording exchanged = recording;  // of one hand, which may be the other
  if (throwing_hand(recording, other).empty()) std::swap(exchanged.left_hand, exchanged.right_hand);
  if (why_no_throw(exchanged, hand, other).empty()) {
    message +=
        fmt::format("; it would be one by the {} hand", other == Side::left ? "left" : "right");
    throw std::invalid_argument(message);
  }
  for (const Remedy& remedy : remedies()) {
    if (why_no_throw(remedied(recording, remedy), hand, side).empty()) {
      message += fmt::format("; it would be one {}", remedy.name);
      break;
    }
  }
  throw std::invalid_argument(message);
}

Scenario stand_thrower(Scenario scenario, const MotionRecording& recording, const Throw& found,
                       Heading heading) {
  Vec3 ahead = -Vec3::UnitZ();
  if (heading == Heading::release) ahead = horizontal(found.V_TB.v).normalized();
  if (heading == Heading::gaze) ahead = horizontal(mean_look(recording, found)).normalized();
  // The world's x, y, z as they stand in the recording: right, ahead, up.
  Mat3 R_TW;
  R_TW << ahead.cross(kUp), ahead, kUp;
  const Quat q_WT(R_TW.transpose());

  scenario.hand.grip = grip_of(scenario.hand, found.side);
  const std::vector<Pose>& track = throwing_hand(recording, found.side);
  const Vec3 p_TB = track[found.release] * scenario.hand.grip;
  const Vec3 p_W = q_WT * -horizontal(p_TB);
  scenario.rig.X_WT = {q_WT.normalized(), Vec3(p_W.x(), p_W.y(), 0.0)};
  scenario.rig.head_station = devices::kHeadStation;  // as to_samples has them
  scenario.rig.hand_station = devices::kHandStation;
  scenario.rig.X_SD = {};
  scenario.rig.X_SH = {};
  scenario.rig.delay_s = nearest_seconds(kReadLate);
  scenario.ball.home = scenario.rig.X_WT * (track[found.grab] * scenario.hand.grip);
  return scenario;
}

std::vector<devices::Sample> to_samples(const MotionRecording& recording, const Throw& found) {
  constexpr std::int32_t kOtherHandStation = 3;
  const Side other = found.side == Side::left ? Side::right : Side::left;
  std::vector<devices::Sample> samples;
  for (std::size_t i = 0; i < recording.times.size(); ++i) {
    const auto tracker = [&](std::int32_t station, const Pose& X_TS) {
      devices::TrackerSample sample;
      sample.device_time = recording.times[i];
      sample.sequence = static_cast<std::int64_t>(i);
      sample.station = station;
      sample.X_TS = X_TS;
      samples.emplace_back(sample);
    };
    tracker(devices::kHeadStation, recording.head[i]);
    tracker(devices::kHandStation, throwing_hand(recording, found.side)[i]);
    const std::vector<Pose>& resting = throwing_hand(recording, other);
    if (!resting.empty()) tracker(kOtherHandStation, resting[i]);
    if (i == found.grab || i == found.release) {
      devices::MouseSample mouse;
      mouse.device_time = recording.times[i];
      mouse.trigger = i == found.grab;
      samples.emplace_back(mouse);
    }
  }
  return samples;
}

}  // namespace headpin::scene
