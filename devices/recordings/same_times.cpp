#include "devices/recordings/same_times.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "devices/recordings/column_names.h"

namespace headpin::devices {
namespace {

constexpr Time kLongestMixed{100'000};  // as long as any gap may be

/// The greatest speed of a track over some 50 ms, in its units of length.
double top_speed(const PoseTrack& track) {
  constexpr Time kOver{50'000};
  const std::vector<Stamped<Pose>>& all = track.samples();
  double most = 0.0;
  for (std::size_t from = 0, to = 1; to < all.size(); ++to) {
    while (all[to].time - all[from + 1].time >= kOver) ++from;
    const Time over = all[to].time - all[from].time;
    if (over < kOver) continue;
    most = std::max(most, (all[to].value.p - all[from].value.p).norm() / seconds(over));
  }
  return most;
}

/// When head and throwing hand are both tracked, from and to.
std::pair<Time, Time> both_tracked(const PartTracks& tracks, std::size_t thrower,
                                   std::string_view where) {
  Time begin = Time::min(), end = Time::max();
  for (const std::size_t i : {std::size_t{0}, thrower}) {
    const std::vector<Stamped<Pose>>& samples = tracks[i]->samples();
    if (samples.empty()) {
      throw std::invalid_argument(fmt::format("{}: no samples of the {}", where, kPartNames[i]));
    }
    begin = std::max(begin, samples.front().time);
    end = std::min(end, samples.back().time);
  }
  return {begin, end};
}

/// The last sample up to a time that is not before the first.
const Stamped<Pose>* last_until(const PoseTrack& track, Time time) {
  const std::vector<Stamped<Pose>>& all = track.samples();
  return &*std::prev(std::ranges::upper_bound(all, time, {}, &Stamped<Pose>::time));
}

/// The sample before a time that lies in a gap of a track; null for a time that does not.
const Stamped<Pose>* before_gap(const PoseTrack& track, Time time) {
  const Stamped<Pose>* const before = last_until(track, time);
  if (before->time == time || before == &track.samples().back()) return nullptr;
  return before[1].time - before->time > kLongestMixed ? before : nullptr;
}

/// Notes the tracks of another rate: more than a twentieth more or fewer samples than there are times
/// while they are tracked.
void note_rates(const PartTracks& tracks, std::size_t timer, MotionRecording& recording) {
  const std::vector<Time>& times = recording.times;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!tracks[i] || tracks[i]->samples().empty() || i == timer) continue;
    const std::vector<Stamped<Pose>>& samples = tracks[i]->samples();
    const Time begin = std::max(recording.start + times.front(), samples.front().time);
    const Time end = std::min(recording.start + times.back(), samples.back().time);
    const auto is_between = [&](Time time) { return time >= begin && time <= end; };
    const auto count =
        static_cast<std::size_t>(std::ranges::count_if(samples, is_between, &Stamped<Pose>::time));
    const auto read = static_cast<std::size_t>(std::ranges::count_if(
        times, [&](Time time) { return is_between(recording.start + time); }));
    if (20 * std::max(count, read) <= 21 * std::min(count, read)) continue;
    recording.notes.push_back(
        fmt::format("{} samples of the {} are interpolated at the {} times of the {}", count,
                    kPartNames[i], read, kPartNames[timer]));
  }
}

/// Notes where an idle hand was not tracked for longer than 0.1 s, and which pose it has there.
void note_idle_hand(const PoseTrack& track, std::string_view name, MotionRecording& recording) {
  const Time first = track.samples().front().time, last = track.samples().back().time;
  const Stamped<Pose>* gap = nullptr;  // the sample before the first one
  std::size_t before = 0, in_gaps = 0, after = 0;
  for (const Time since_start : recording.times) {
    const Time time = recording.start + since_start;
    before += time < first - kLongestMixed;
    after += time > last + kLongestMixed;
    if (time < first || time > last) continue;
    const Stamped<Pose>* const its = before_gap(track, time);
    if (!its) continue;
    ++in_gaps;
    if (!gap) gap = its;
  }
  std::vector<std::string>& notes = recording.notes;
  if (before > 0) {
    notes.push_back(
        fmt::format("no samples of the {} before {} s: its first pose is held there ({} times)",
                    name, nearest_seconds(first), before));
  }
  if (in_gaps > 0) {
    notes.push_back(
        fmt::format("no samples of the {} for {:.3g} s from {} s: its poses in such gaps are "
                    "interpolated ({} times)",
                    name, seconds(gap[1].time - gap->time), nearest_seconds(gap->time), in_gaps));
  }
  if (after > 0) {
    notes.push_back(
        fmt::format("no samples of the {} after {} s: its last pose is held there ({} times)", name,
                    nearest_seconds(last), after));
  }
}

/// Notes where the throwing hand was not tracked for longer than 0.1 s while the head was.
void note_throwing_hand(const PoseTrack& hand, const PoseTrack& head, std::string_view name,
                        MotionRecording& recording) {
  const std::vector<Stamped<Pose>>& all = hand.samples();
  const Time last = recording.start + recording.times.back();
  for (std::size_t i = 1; i < all.size() && all[i].time <= last; ++i) {
    const Time from = all[i - 1].time, gap = all[i].time - from;
    if (from < recording.start || gap <= kLongestMixed) continue;
    const auto mixed = std::ranges::upper_bound(head.samples(), from, {}, &Stamped<Pose>::time);
    if (mixed == head.samples().end() || mixed->time >= all[i].time) continue;
    recording.notes.push_back(
        fmt::format("no samples of the {} for {:.3g} s from {} s: the recording has a gap there",
                    name, seconds(gap), nearest_seconds(from)));
  }
}

/// The times of a part at which head and throwing hand are known, since the start. Notes those that
/// are left out.
void take_times(const PartTracks& tracks, std::size_t thrower, std::size_t timer,
                std::pair<Time, Time> range, MotionRecording& recording) {
  std::array<std::vector<Time>, 3> left_out;  // where the gaps of each part begin
  for (const Stamped<Pose>& sample : tracks[timer]->samples()) {
    if (sample.time < range.first || sample.time > range.second) continue;
    bool known = true;
    for (const std::size_t i : {std::size_t{0}, thrower}) {
      const Stamped<Pose>* const gap = known ? before_gap(*tracks[i], sample.time) : nullptr;
      if (!gap) continue;
      left_out[i].push_back(gap->time);
      known = false;
    }
    if (known) recording.times.push_back(sample.time - range.first);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    if (left_out[i].empty()) continue;
    recording.notes.push_back(fmt::format(
        "no samples of the {} for more than {:.3g} s from {} s: {} samples of the {} in such "
        "gaps are left out",
        kPartNames[i], seconds(kLongestMixed), nearest_seconds(left_out[i].front()),
        left_out[i].size(), kPartNames[timer]));
  }
}

/// The poses of a track at the times of a recording.
std::vector<Pose> poses_at(const PoseTrack& track, const MotionRecording& recording) {
  std::vector<Pose> poses;
  for (const Time time : recording.times) poses.push_back(*track.at(recording.start + time));
  return poses;
}

}  // namespace

std::size_t throwing_part(const PartTracks& tracks, std::optional<bool> left_throws) {
  const PoseTrack *const left = tracks[1], *const right = tracks[2];
  if (!left || !right) return left ? 1 : right ? 2 : 0;
  return left_throws.value_or(top_speed(*left) > top_speed(*right)) ? 1 : 2;
}

std::size_t timing_part(const PartTracks& tracks, std::size_t thrower) {
  constexpr double kFastest = 250.0;  // samples a second
  const auto is_too_fast = [](const PoseTrack& track) {
    const std::vector<Stamped<Pose>>& all = track.samples();
    if (all.size() < 2) return false;
    const double spans = static_cast<double>(all.size() - 1);
    return spans > kFastest * seconds(all.back().time - all.front().time);
  };
  return is_too_fast(*tracks[thrower]) && !is_too_fast(*tracks[0]) ? 0 : thrower;
}

MotionRecording together(const PartTracks& tracks, std::size_t thrower, std::size_t timer,
                         std::string_view where) {
  const std::pair<Time, Time> range = both_tracked(tracks, thrower, where);
  MotionRecording recording;
  recording.start = range.first;
  take_times(tracks, thrower, timer, range, recording);
  if (recording.times.empty()) {
    throw std::invalid_argument(fmt::format("{}: {} were never recorded at the same time", where,
                                            thrower == 0
                                                ? std::string("the samples of the head")
                                                : fmt::format("head and {}", kPartNames[thrower])));
  }
  recording.head = poses_at(*tracks[0], recording);
  for (std::size_t i = 1; i < 3; ++i) {
    if (!tracks[i]) continue;
    if (tracks[i]->samples().empty()) {  // an idle hand
      recording.notes.push_back(fmt::format("no samples of the {}: left out", kPartNames[i]));
      continue;
    }
    (i == 1 ? recording.left_hand : recording.right_hand) = poses_at(*tracks[i], recording);
    if (i != thrower) note_idle_hand(*tracks[i], kPartNames[i], recording);
  }
  if (thrower != 0 && timer == thrower) {
    note_throwing_hand(*tracks[thrower], *tracks[0], kPartNames[thrower], recording);
  }
  note_rates(tracks, timer, recording);
  return recording;
}

}  // namespace headpin::devices
