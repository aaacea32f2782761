#include "scene/people/throw_readings.h"

#include <algorithm>
#include <array>
#include <span>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "scene/people/throw_checks.h"
#include "scene/people/throw_motion.h"

// Finds out whether a recording would be a person's throw if its numbers were read in another way.
namespace headpin::scene {
namespace {

using devices::MotionRecording;
using devices::Reading;

/// Another way to read the numbers.
struct Candidate {
  Reading reading;
  std::string what;
};

using NamedUnit = std::pair<double, std::string_view>;

constexpr std::array<NamedUnit, 5> kLengths = {{{0.01, "in centimetres"},
                                                {1.0, "in metres"},
                                                {0.001, "in millimetres"},
                                                {0.0254, "in inches"},
                                                {0.3048, "in feet"}}};
constexpr std::array<NamedUnit, 4> kTimes = {{{1.0, "with time in seconds"},
                                              {1e-3, "with time in milliseconds"},
                                              {1e-6, "with time in microseconds"},
                                              {1e-9, "with time in nanoseconds"}}};

/// Other values of one number of a reading.
std::vector<Candidate> others(const Reading& was, double Reading::*number,
                              std::span<const NamedUnit> values) {
  std::vector<Candidate> all;
  for (const auto& [value, what] : values) {
    if (value == was.*number) continue;
    all.push_back({was, std::string(what)});
    all.back().reading.*number = value;
  }
  return all;
}

std::vector<Candidate> other_units(const Reading& was) {
  if (was.own_units) return {};
  return others(was, &Reading::unit_m, kLengths);
}

std::vector<Candidate> other_times(const Reading& was) {
  return others(was, &Reading::time_unit_s, kTimes);
}

std::vector<Candidate> other_quaternions(const Reading& was) {
  std::vector<Candidate> all;
  for (const auto& [order, words] : {std::pair{"xyzw", "x, y, z, w"}, {"wxyz", "w, x, y, z"}}) {
    if (was.quaternion.empty() || was.own_orders || was.quaternion == order) continue;
    all.push_back({was, fmt::format("with its quaternions read as {}", words)});
    all.back().reading.quaternion = order;
  }
  all.push_back({was, was.quaternion.empty() ? "with its rotations inverted"
                                             : "with its quaternions inverted"});
  all.back().reading.inverted = !was.inverted;
  return all;
}

/// All frames, those with few other letters first.
std::vector<std::string> frames_near(const std::string& letters) {
  std::vector<std::string> all;
  constexpr std::array<std::string_view, 3> kPairs = {"RL", "SI", "AP"};
  std::array<std::size_t, 3> order = {0, 1, 2};
  do {
    for (std::size_t signs = 0; signs < 8; ++signs) {
      std::string frame;
      for (std::size_t i = 0; i < 3; ++i) frame += kPairs[order[i]][(signs >> i) & 1];
      if (frame != letters) all.push_back(frame);
    }
  } while (std::ranges::next_permutation(order).found);
  const auto differences = [&](const std::string& frame) {
    int n = 0;
    for (std::size_t i = 0; i < 3; ++i) n += frame[i] != letters[i];
    return n;
  };
  std::ranges::stable_sort(all, {}, differences);
  return all;
}

std::string directions(const std::string& frame) {
  const auto word = [](char letter) {
    return letter == 'R'   ? "right"
           : letter == 'L' ? "left"
           : letter == 'S' ? "up"
           : letter == 'I' ? "down"
           : letter == 'A' ? "ahead"
                           : "back";
  };
  return fmt::format("with +x {}, +y {} and +z {}", word(frame[0]), word(frame[1]), word(frame[2]));
}

std::vector<Candidate> other_axes(const Reading& was) {
  std::vector<Candidate> both, positions, rotations;
  for (const std::string& frame : frames_near(was.axes)) {
    both.push_back({was, directions(frame)});
    both.back().reading.axes = both.back().reading.turning = frame;
    positions.push_back({was, directions(frame) + ", positions alone"});
    positions.back().reading.axes = frame;
  }
  for (const std::string& frame : frames_near(was.turning)) {
    rotations.push_back({was, directions(frame) + ", rotations alone"});
    rotations.back().reading.turning = frame;
  }
  both.insert(both.end(), positions.begin(), positions.end());
  both.insert(both.end(), rotations.begin(), rotations.end());
  return both;
}

/// Units and axes of positions and rotations together.
std::vector<Candidate> other_units_and_axes(const Reading& was) {
  std::vector<Candidate> all;
  for (const Candidate& unit : other_units(was)) {
    for (const std::string& frame : frames_near(was.axes)) {
      all.push_back({unit.reading, unit.what + ", " + directions(frame)});
      all.back().reading.axes = all.back().reading.turning = frame;
    }
  }
  return all;
}

/// Corrections that no reading of the numbers makes.
const char* other_scale(const MotionRecording& recording, const Hand& hand, Side side) {
  struct Scale {
    double size, pace;
    const char* what;
  };
  for (const Scale& scale :
       {Scale{1.0 / 3.0, 1.0, "at a third of the size"}, Scale{3.0, 1.0, "at three times the size"},
        Scale{1.0, 2.0, "at half the speed"}, Scale{1.0, 0.5, "at twice the speed"},
        Scale{1.0, 10.0, "at a tenth of the speed"}, Scale{1.0, 0.1, "at ten times the speed"}}) {
    Reading reading = recording.reading;
    reading.unit_m *= scale.size;
    reading.time_unit_s *= scale.pace;
    if (why_no_throw(read_again(recording, reading), hand, side).empty()) return scale.what;
  }
  return nullptr;
}

/// The 20 s around the hand's fastest motion: enough to judge by, in a recording of hours.
MotionRecording around_the_throw(const MotionRecording& r, Side side) {
  constexpr std::size_t kMost = 5000;
  const std::vector<Pose>& hand = throwing_hand(r, side);
  if (r.times.size() <= kMost || hand.empty()) return r;
  std::size_t fastest = 0;
  double most = 0.0;
  for (std::size_t i = 0; i < hand.size(); ++i) {
    if (const double speed = velocity(r.times, hand, i).norm(); speed > most)
      most = speed, fastest = i;
  }
  const std::size_t begin =
      std::min(fastest - std::min(fastest, kMost / 2), r.times.size() - kMost);
  return samples_of(r, begin, begin + kMost);
}

/// The recording with the positions that say no unit in another one.
MotionRecording with_unit(MotionRecording r, double unit_m) {
  const std::array<std::vector<Pose>*, 3> parts = {&r.head, &r.left_hand, &r.right_hand};
  for (std::size_t part = 0; part < 3; ++part) {
    if (!r.reading.without_unit[part]) continue;
    for (Pose& pose : *parts[part])
      pose.p = r.p_origin + unit_m / r.reading.unit_m * (pose.p - r.p_origin);
  }
  r.reading.own_units = true;
  r.reading.without_unit = {};
  return r;
}

/// The first unit of the positions that say none in which a recording is what is wanted; none if there is no such.
std::optional<double> unit_where(const auto& is_wanted, const MotionRecording& r) {
  if (is_wanted(r)) return r.reading.unit_m;
  const std::vector<double>& others = r.reading.other_units_m;
  const auto found =
      std::ranges::find_if(others, [&](double unit_m) { return is_wanted(with_unit(r, unit_m)); });
  return found == others.end() ? std::nullopt : std::optional(*found);
}

/// Whether one of the recording's throws, by the motion of either hand, is a person's.
bool has_throw(MotionRecording r, const Hand& hand) {
  r.triggers = {};
  for (const Side side : {Side::right, Side::left}) {
    if (r.times.size() < devices::kFewestSamples || throwing_hand(r, side).empty()) continue;
    const std::vector<MotionRecording> throws = split_throws(r, side);
    if (std::ranges::any_of(throws,
                            [&](const auto& one) { return why_no_throw(one, hand, side).empty(); }))
      return true;
  }
  return false;
}

}  // namespace

MotionRecording in_likely_units(MotionRecording r, const Hand& hand, bool head_alone) {
  constexpr std::array<std::string_view, 3> kParts = {"the head", "the left hand",
                                                      "the right hand"};
  if (!r.head_moves) r.reading.without_unit[0] = false;  // its place was told
  std::vector<std::string_view> unsaid;
  for (std::size_t part = 0; part < 3; ++part) {
    if (r.reading.without_unit[part]) unsaid.push_back(kParts[part]);
  }
  if (unsaid.empty()) return r;
  const auto is_throw = [&](const MotionRecording& one) { return has_throw(one, hand); };
  const auto is_head = [](const MotionRecording& one) { return why_no_head(one).empty(); };
  std::optional<double> likely_m = head_alone ? std::nullopt : unit_where(is_throw, r);
  if (!likely_m) likely_m = unit_where(is_head, r);  // what is said of it is then of a person
  const double unit_m = likely_m.value_or(r.reading.unit_m);
  if (unit_m != r.reading.unit_m) r = with_unit(std::move(r), unit_m);
  const auto named = std::ranges::find(kLengths, unit_m, &NamedUnit::first);
  r.notes.push_back(fmt::format("positions of {} have no unit: read {}", fmt::join(unsaid, " and "),
                                named->second));
  return r;
}

MotionRecording read_again(MotionRecording r, const Reading& reading) {
  const devices::Again again(r.reading, reading, "the recording");
  for (Time& time : r.times) time = again(time);
  for (auto* track : {&r.head, &r.left_hand, &r.right_hand}) {
    if (track == &r.head && !r.head_moves) continue;
    for (Pose& pose : *track) {
      pose = again(Pose{pose.q, pose.p - r.p_origin});
      pose.p += r.p_origin;
    }
  }
  for (auto& trigger : r.triggers) {
    for (Stamped<bool>& change : trigger) change.time = again(change.time);
  }
  r.reading = reading;
  return r;
}

std::optional<Reading> reading_of_a_throw(const MotionRecording& recording, const Hand& hand,
                                          Side side, std::string& what) {
  const MotionRecording part = around_the_throw(recording, side);
  const bool all_axes = part.head_turns && part.head_moves;  // else many axes would do
  for (const auto& candidates :
       {other_units, other_times, other_quaternions, other_axes, other_units_and_axes}) {
    if (!all_axes && (candidates == other_axes || candidates == other_units_and_axes)) continue;
    for (const Candidate& other : candidates(part.reading)) {
      if (!why_no_throw(read_again(part, other.reading), hand, side).empty()) continue;
      what = other.what;
      return other.reading;
    }
  }
  return std::nullopt;
}

void require_throw(const MotionRecording& recording, const Hand& hand, const std::string& where,
                   Side side) {
  const std::vector<std::string> problems = why_no_throw(recording, hand, side);
  if (problems.empty()) return;
  const std::string problem = fmt::format("{}: not a person's throw: {}", where, problems.front());
  MotionRecording by_motion = recording;
  by_motion.triggers = {};
  if (!recording.triggers[side == Side::left ? 0 : 1].empty() &&
      why_no_throw(by_motion, hand, side).empty()) {
    throw NoThrow(problem + "; it would be one without its trigger, by the motion alone");
  }
  const Side other = side == Side::left ? Side::right : Side::left;
  MotionRecording exchanged = recording;  // with the hands exchanged
  if (throwing_hand(recording, other).empty()) {
    std::swap(exchanged.left_hand, exchanged.right_hand);
    std::swap(exchanged.triggers[0], exchanged.triggers[1]);
  }
  if (why_no_throw(exchanged, hand, other).empty()) {
    throw NoThrow(fmt::format("{}; it would be one by the {} hand{}", problem,
                              other == Side::left ? "left" : "right",
                              recording.head_turns ? "" : ", or with mirrored axes"));
  }
  std::string what;
  if (const auto reading = reading_of_a_throw(recording, hand, side, what)) {
    NoThrow error(fmt::format("{}; it would be one {}", problem, what));
    error.would_be = reading;
    throw error;
  }
  if (const char* scale = other_scale(recording, hand, side)) {
    throw NoThrow(fmt::format("{}; it would be one {}", problem, scale));
  }
  throw NoThrow(problem);
}

}  // namespace headpin::scene
