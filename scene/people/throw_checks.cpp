#include "scene/people/throw_checks.h"

#include <algorithm>
#include <functional>
#include <stdexcept>

#include <fmt/format.h>

#include "scene/people/throw_motion.h"
#include "scene/play/quantile.h"

// Checks whether a recording is a person's throw, and finds a correction if it is not.
namespace headpin::scene {
namespace {

using devices::MotionRecording;

// Limits of the human body. Standing adults' eyes are 1.4 to 1.8 m up (5th percentile of women to
// 95th of men); the range is wider for young and tall people and for headsets that are worn high.
// Bowlers release the ball at up to 9.4 m/s.
constexpr double kLowestHead = 1.2, kHighestHead = 2.1;       // m, median
constexpr double kShortestReach = 0.5, kLongestReach = 1.25;  // m, head to hand, at its largest
constexpr double kFastestHand = 10.5;                         // m/s, hand at its fastest
constexpr double kSlowestTriggered = 1.0;                     // m/s, ball as the trigger says
constexpr double kFastestHead = 3.0;                          // m/s
constexpr double kMostFastHead = 0.1;  // share of the time in which a head alone may be faster
constexpr double kLeastUpright = 0.7;  // cosine of the head's mean tilt before the release
constexpr double kMostRoll = 0.4;      // sine of the head's roll, but for a tenth of the time
constexpr double kMostUpward = 0.2;    // sine of its mean gaze upward: the target is on the floor
constexpr double kLeastAtBall = 0.5;   // cosine between gaze and ball as it is taken
constexpr double kLeastAlong = 0.906;  // cosine between gaze and throw from above, 25 degrees
constexpr double kLowestRate = 45.0, kHighestRate = 250.0;  // Hz
constexpr double kUsualRate = 59.0;                         // Hz; head-mounted displays: 60 and up
constexpr double kUsualGap = 0.05;                          // s
constexpr double kMostRepeated = 0.1;
constexpr double kShortestDuration = 2.0;  // s

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

double longest_reach(const MotionRecording& r, const std::vector<Pose>& hand) {
  double reach = 0.0;
  for (std::size_t i = 0; i < hand.size(); ++i) {
    reach = std::max(reach, (hand[i].p - r.head[i].p).norm());
  }
  return reach;
}

/// Mean distance of a hand to the right of the head in the swing.
double mean_side(const MotionRecording& r, const Throw& found, const std::vector<Pose>& hand) {
  const auto [begin, end] = samples_of_swing(r, found);
  double sum = 0.0;
  for (std::size_t i = begin; i < end; ++i) {
    const Vec3 gaze = horizontal(r.head[i].q * -Vec3::UnitZ()).normalized();
    sum += (hand[i].p - r.head[i].p).dot(gaze.cross(kUp));
  }
  return sum / static_cast<double>(end - begin);
}

/// How upright the head is in the swing: the mean height of its unit up axis.
double mean_upright(const MotionRecording& r, const Throw& found) {
  const auto [begin, end] = samples_of_swing(r, found);
  double upright = 0.0;
  for (std::size_t i = begin; i < end; ++i) upright += (r.head[i].q * kUp).y();
  return upright / static_cast<double>(end - begin);
}

std::vector<std::string> problems_of_length(const MotionRecording& r) {
  std::vector<std::string> problems;
  const std::size_t n = r.times.size();
  const double duration = n < 2 ? 0.0 : seconds(r.times.back() - r.times.front());
  if (n < devices::kFewestSamples || duration < kShortestDuration) {
    problems.push_back(fmt::format("{} samples in {:.3g} s, expected at least {} in {} s", n,
                                   duration, devices::kFewestSamples, kShortestDuration));
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
          fmt::format("no samples for {:.3g} s from {:.3g} s, expected no gap above {} s", gap,
                      seconds(r.times[i - 1]), kLongestGap));
      break;
    }
  }
  return problems;
}

/// The complaints about one recording.
class Complaints {
 public:
  void expect(std::string_view what, double value, double low, double high, const char* unit) {
    claim(value >= low && value <= high, [&] {
      return fmt::format("{} {:.3g} {}, expected {} to {}", what, value, unit, low, high);
    });
  }
  template <typename Otherwise>
  void claim(bool holds, const Otherwise& otherwise) {
    if (!holds) all.push_back(otherwise());
  }

  std::vector<std::string> all;
};

std::string of_hand(Side side, const char* what) {
  return fmt::format("the {} hand{}", side == Side::left ? "left" : "right", what);
}

Side other_than(Side side) {
  return side == Side::left ? Side::right : Side::left;
}

/// Checks the height of the head, and reach and speed of the hands.
void check_body(const MotionRecording& r, const Throw& found, Complaints& out) {
  const Side other = other_than(found.side);
  const std::vector<Pose>&throwing = throwing_hand(r, found.side),
        &resting = throwing_hand(r, other);
  out.expect("the head is up", median_height(r.head), kLowestHead, kHighestHead, "m");
  out.expect(of_hand(found.side, " goes from the head up to"), longest_reach(r, throwing),
             kShortestReach, kLongestReach, "m");
  out.expect(of_hand(other, " goes from the head up to"), longest_reach(r, resting), 0.0,
             kLongestReach, "m");
  out.expect(of_hand(found.side, "'s fastest is"), found.peak_hand_speed, kSlowestThrow,
             kFastestHand, "m/s");
  out.expect(of_hand(other, "'s fastest is"), fastest(r, resting), 0.0, kFastestHand, "m/s");
  out.expect("the head's fastest is", fastest(r, r.head), 0.0, kFastestHead, "m/s");
}

/// Checks that the head is upright and level, and looks along the throw and at the ball.
void check_head(const MotionRecording& r, const Throw& found, const Hand& hand, Complaints& out) {
  const double upright = mean_upright(r, found), roll = usual_roll(r.head);
  out.claim(upright > kLeastUpright, [&] {
    return fmt::format(
        "the head is not upright: its up axis rises by {:.2f} of its length, expected more than {}",
        upright, kLeastUpright);
  });
  out.claim(roll < kMostRoll, [&] {
    return fmt::format(
        "the head is tilted sideways: its right axis rises or falls by {:.2f} of its length, "
        "expected less "
        "than {}",
        roll, kMostRoll);
  });
  const Vec3 gaze = mean_gaze(r, found);
  out.claim(gaze.y() < kMostUpward, [&] {
    return fmt::format("the head looks up ({:.2f} of its line of sight), expected less than {}",
                       gaze.y(), kMostUpward);
  });
  const Vec3 along = horizontal(hand_velocity_at(r, found, hand)).normalized();
  out.claim(horizontal(gaze).normalized().dot(along) > kLeastAlong, [&] {
    return fmt::format(
        "the head looks towards x {:.2f}, z {:.2f}, not along the throw towards x {:.2f}, z {:.2f}",
        gaze.x(), gaze.z(), along.x(), along.z());
  });
  const Pose& head = r.head[found.grab];
  const Vec3 at_ball = (throwing_hand(r, found.side)[found.grab].p - head.p).normalized();
  const double on_ball = at_ball.dot(head.q * -Vec3::UnitZ());
  out.claim(found.grab == 0 || !r.head_turns || on_ball > kLeastAtBall, [&] {
    return fmt::format(
        "the head does not look at the ball as the hand takes it: cosine {:.2f}, expected more "
        "than {}",
        on_ball, kLeastAtBall);
  });
}

/// Checks that the throwing hand is on its own side of the head and of the other hand.
void check_side(const MotionRecording& r, const Throw& found, Complaints& out) {
  const double sign = found.side == Side::right ? 1.0 : -1.0;
  const std::vector<Pose>& resting = throwing_hand(r, other_than(found.side));
  const double aside = sign * mean_side(r, found, throwing_hand(r, found.side));
  if (resting.empty()) {
    out.claim(aside > 0.0, [&] {
      return fmt::format("{}: {:.2f} m of the head", of_hand(found.side, " is not on its side"),
                         aside);
    });
    return;
  }
  const double others = sign * mean_side(r, found, resting);
  out.claim(aside > 0.0 && aside > others, [&] {
    return fmt::format(
        "the {0} hand is not on the {0}: {1:.2f} m {0} of the head, the {2} hand "
        "{3:.2f} m",
        found.side == Side::right ? "right" : "left", aside,
        found.side == Side::right ? "left" : "right", others);
  });
}

}  // namespace

MotionRecording looking_along(MotionRecording r, const Hand& hand, Side side) {
  if (r.head_turns || r.times.size() < 10 || throwing_hand(r, side).empty()) return r;
  const Vec3 along = horizontal(hand_velocity_at(r, find_throw(r, hand, side), hand));
  if (along.norm() == 0.0) return r;
  // -z turned about y by half the angle to the throw.
  const Vec3 ahead = along.normalized();
  const double half = std::sqrt(std::max(0.0, 0.5 * (1.0 + ahead.z())));
  const Quat q(std::sqrt(std::max(0.0, 0.5 * (1.0 - ahead.z()))), 0.0,
               ahead.x() > 0.0 ? -half : half, 0.0);
  for (Pose& head : r.head) head.q = q;
  return r;
}

std::vector<std::string> why_no_throw(const MotionRecording& recording, const Hand& hand,
                                      Side side) {
  Complaints out;
  out.all = problems_of_length(recording);
  out.claim(!throwing_hand(recording, side).empty(),
            [&] { return of_hand(side, " was not tracked"); });
  if (!out.all.empty()) return out.all;  // nothing below can be measured

  const MotionRecording r = looking_along(recording, hand, side);
  const Throw found = find_throw(r, hand, side);
  if (const double speed = found.V_TB.v.norm(); found.by_trigger && speed < kSlowestTriggered) {
    out.all.push_back(fmt::format(
        "the trigger is released at {:.3f} s, when the ball has {:.2f} m/s, expected at least {}",
        seconds(found.release_time), speed, kSlowestTriggered));
    return out.all;
  }
  check_body(r, found, out);
  const Time release = r.times[found.release];
  if (release - r.times[found.grab] < Time{300'000} || r.times.back() - release < Time{100'000}) {
    out.all.push_back(
        fmt::format("the hand is fastest at {:.3g} s of {:.3g} to {:.3g} s: too near an end for "
                    "lift, swing and follow-through",
                    seconds(release), seconds(r.times.front()), seconds(r.times.back())));
    return out.all;
  }
  check_head(r, found, hand, out);
  check_side(r, found, out);
  return out.all;
}

namespace {

/// The share of samples within a quarter of a second of a hand's fastest motion that repeat the one before.
double repeated(const MotionRecording& r, const std::vector<Pose>& hand) {
  if (hand.size() < 2) return 0.0;
  std::size_t fastest = 0;
  double most = 0.0;
  for (std::size_t i = 0; i < hand.size(); ++i) {
    if (const double speed = velocity(r.times, hand, i).norm(); speed > most)
      most = speed, fastest = i;
  }
  if (most < kSlowestThrow) return 0.0;  // a hand that rests
  constexpr Time kAround{250'000};
  std::size_t all = 0, same = 0;
  for (std::size_t i = 1; i < hand.size(); ++i) {
    if (std::chrono::abs(r.times[i] - r.times[fastest]) > kAround) continue;
    ++all;
    same += hand[i].p == hand[i - 1].p && hand[i].q.coeffs() == hand[i - 1].q.coeffs();
  }
  return all == 0 ? 0.0 : static_cast<double>(same) / static_cast<double>(all);
}

/// The longest time between two neighbouring samples, and the first of both.
struct Gap {
  Time length{};
  std::size_t from = 0;
};

/// The longest gap that reaches into [from, until].
Gap longest_gap(const std::vector<Time>& times, Time from, Time until) {
  Gap longest;
  for (std::size_t i = 1; i < times.size(); ++i) {
    if (times[i] < from || times[i - 1] > until) continue;
    const Time length = times[i] - times[i - 1];
    if (length > longest.length) longest = {length, i - 1};
  }
  return longest;
}

/// What is said of the longest gap of all, and of the longest among the samples that the release uses
/// (docs/release.md).
void doubt_gaps(const MotionRecording& r, const Throw& found, std::vector<std::string>& said) {
  constexpr Time kBefore{120'000}, kAfter{40'000};
  const auto add = [&](const Gap& gap, std::string_view what) {
    said.push_back(fmt::format("no samples for {:.3g} s from {:.3g} s{}", seconds(gap.length),
                               seconds(r.times[gap.from]), what));
  };
  const Gap at_release =
      longest_gap(r.times, found.release_time - kBefore, found.release_time + kAfter);
  const Gap longest = longest_gap(r.times, r.times.front(), r.times.back());
  const bool is_near = seconds(at_release.length) > kUsualGap;
  if (is_near && found.known == Known::extrapolated) {
    add(at_release,
        fmt::format(
            ", at the release: the ball's velocity is extrapolated by {:.0f} ms and less certain",
            1e3 * seconds(found.extrapolated)));
  } else if (is_near) {
    add(at_release, ", at the release: the ball's velocity is less certain");
  }
  const bool told = is_near && longest.from == at_release.from;
  if (!told && seconds(longest.length) > kUsualGap)
    add(longest, ": the motion there is interpolated");
}

}  // namespace

std::vector<std::string> doubts(const MotionRecording& r, const Throw& found) {
  std::vector<std::string> said;
  const std::size_t n = r.times.size();
  if (n < 2) return said;
  const double rate = static_cast<double>(n - 1) / seconds(r.times.back() - r.times.front());
  if (rate < kUsualRate) {
    said.push_back(fmt::format("{:.3g} samples per second: below {} the release is less accurate",
                               rate, kUsualRate));
  }
  doubt_gaps(r, found, said);
  for (const auto& [hand, name] : {std::pair{&r.left_hand, "left"}, {&r.right_hand, "right"}}) {
    const double share = repeated(r, *hand);
    if (share < kMostRepeated) continue;
    said.push_back(
        fmt::format("the {} hand repeats its pose in {:.0f} % of the samples of its swing: its "
                    "tracker is slower "
                    "than the recording, and the release is less accurate",
                    name, 100.0 * share));
  }
  return said;
}

namespace {

/// How often a head is too fast, and its fastest motion.
struct HeadSpeed {
  double share = 0.0;    ///< of all moments, above kFastestHead
  double fastest = 0.0;  ///< [m/s]
  Time at{};
};

/// Measured over kHeadOver or a little more, so that times of arrival, in bursts, do not make a head fast. Of two
/// neighbouring ends the faster one counts: in two recordings whose samples alternate, one of both is of the other
/// recording.
HeadSpeed speed_of_head(const MotionRecording& r) {
  constexpr Time kHeadOver{50'000};
  HeadSpeed found;
  std::size_t end = 0, moments = 0, fast = 0;
  for (std::size_t i = 0; i < r.times.size(); ++i) {
    while (end < r.times.size() && r.times[end] - r.times[i] < kHeadOver) ++end;
    if (end == r.times.size()) break;
    double speed = 0.0;
    for (std::size_t k = end; k < std::min(end + 2, r.times.size()); ++k) {
      const double over = seconds(r.times[k] - r.times[i]);
      speed = std::max(speed, (r.head[k].p - r.head[i].p).norm() / over);
    }
    ++moments;
    if (!(speed <= kFastestHead)) ++fast;
    if (speed > found.fastest) found.fastest = speed, found.at = r.times[i];
  }
  if (moments > 0) found.share = static_cast<double>(fast) / static_cast<double>(moments);
  return found;
}

}  // namespace

std::string why_no_head(const MotionRecording& r) {
  const double height = r.head.front().p.y();
  if (!(height > 1.0 && height < 2.2))
    return fmt::format("it is up {:.3g} m at first, expected 1 to 2.2", height);
  const HeadSpeed speed = speed_of_head(r);
  if (speed.share > kMostFastHead) {
    return fmt::format(
        "it is faster than {} m/s in {:.0f} % of the time (the fastest is {:.3g} m/s, at {:.3f} "
        "s), expected at most {:.0f} %; two recordings in one file look like this",
        kFastestHead, 100.0 * speed.share, speed.fastest, seconds(speed.at), 100.0 * kMostFastHead);
  }
  return "";
}

std::vector<std::string> doubts_about_head(const MotionRecording& r) {
  const HeadSpeed speed = speed_of_head(r);
  if (speed.share == 0.0 || speed.share > kMostFastHead) return {};
  return {fmt::format(
      "the head's fastest is {:.3g} m/s, at {:.3f} s: above {} m/s it is no person's motion",
      speed.fastest, seconds(speed.at), kFastestHead)};
}

Side throwing_side(const MotionRecording& r, const Hand& hand) {
  if (r.right_hand.empty()) return Side::left;
  if (r.left_hand.empty()) return Side::right;
  if (why_no_throw(r, hand, Side::right).empty()) return Side::right;
  if (why_no_throw(r, hand, Side::left).empty()) return Side::left;
  return r.times.size() > 1 && fastest(r, r.left_hand) > fastest(r, r.right_hand) ? Side::left
                                                                                  : Side::right;
}

}  // namespace headpin::scene
