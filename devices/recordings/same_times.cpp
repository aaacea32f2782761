#include "devices/recordings/same_times.h"

#include <algorithm>
#include <stdexcept>

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

/// When all are tracked, from and to.
std::pair<Time, Time> all_tracked(const PartTracks& tracks, std::string_view where) {
  Time begin = Time::min(), end = Time::max();
  for (std::size_t i = 0; i < 3; ++i) {
    if (!tracks[i]) continue;
    const std::vector<Stamped<Pose>>& samples = tracks[i]->samples();
    if (samples.empty()) {
      throw std::invalid_argument(fmt::format("{}: no samples of the {}", where, kPartNames[i]));
    }
    begin = std::max(begin, samples.front().time);
    end = std::min(end, samples.back().time);
  }
  return {begin, end};
}

/// Refuses a hand that was not tracked for too long while the head was.
void require_hands(const PartTracks& tracks, Time begin, Time end, std::string_view where) {
  const std::vector<Stamped<Pose>>& head = tracks[0]->samples();
  for (std::size_t i = 1; i < 3; ++i) {
    if (!tracks[i]) continue;
    const std::vector<Stamped<Pose>>& samples = tracks[i]->samples();
    for (std::size_t k = 1; k < samples.size(); ++k) {
      const Time from = samples[k - 1].time, gap = samples[k].time - from;
      if (gap <= kLongestMixed || from >= end || samples[k].time <= begin) continue;
      const auto mixed = std::ranges::upper_bound(head, from, {}, &Stamped<Pose>::time);
      if (mixed == head.end() || mixed->time >= samples[k].time) continue;
      throw std::invalid_argument(fmt::format(
          "{}: no samples of the {} for {:.3g} s from {:.3g} s, expected no gap above 0.1 s", where,
          kPartNames[i], seconds(gap), seconds(from)));
    }
  }
}

/// The last sample up to a time that is not before the first.
const Stamped<Pose>* last_until(const PoseTrack& track, Time time) {
  const std::vector<Stamped<Pose>>& all = track.samples();
  return &*std::prev(std::ranges::upper_bound(all, time, {}, &Stamped<Pose>::time));
}

/// Notes the tracks of another rate: more than a twentieth more or fewer samples than there are times.
void note_rates(const PartTracks& tracks, std::size_t timer, Time begin, Time end,
                MotionRecording& recording) {
  const std::size_t times = recording.times.size();
  for (std::size_t i = 0; i < 3; ++i) {
    if (!tracks[i] || i == timer) continue;
    const auto count = static_cast<std::size_t>(std::ranges::count_if(
        tracks[i]->samples(),
        [&](const Stamped<Pose>& sample) { return sample.time >= begin && sample.time <= end; }));
    if (20 * std::max(count, times) <= 21 * std::min(count, times)) continue;
    recording.notes.push_back(
        fmt::format("{} samples of the {} are interpolated at the {} times of the {}", count,
                    kPartNames[i], times, kPartNames[timer]));
  }
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

MotionRecording together(const PartTracks& tracks, std::size_t timer, std::string_view where) {
  const auto [head, left, right] = tracks;
  const auto [begin, end] = all_tracked(tracks, where);
  require_hands(tracks, begin, end, where);
  MotionRecording recording;
  recording.start = begin;
  std::vector<Time> left_out;
  for (const Stamped<Pose>& sample : tracks[timer]->samples()) {
    if (sample.time < begin || sample.time > end) continue;
    const Stamped<Pose>* const before = last_until(*head, sample.time);
    const bool same = before->time == sample.time;
    if (!same && before[1].time - before->time > kLongestMixed) {
      left_out.push_back(before->time);
      continue;
    }
    recording.times.push_back(sample.time - begin);
    recording.head.push_back(same ? before->value : *head->at(sample.time));
    if (left) recording.left_hand.push_back(*left->at(sample.time));
    if (right) recording.right_hand.push_back(*right->at(sample.time));
  }
  if (recording.times.empty()) {
    throw std::invalid_argument(
        fmt::format("{}: head and hands were never recorded at the same time", where));
  }
  if (!left_out.empty()) {
    recording.notes.push_back(fmt::format(
        "no samples of the head for more than {:.3g} s from {:.3g} s: {} samples of the {} in such "
        "gaps are left out",
        seconds(kLongestMixed), seconds(left_out.front()), left_out.size(), kPartNames[timer]));
  }
  note_rates(tracks, timer, begin, end, recording);
  return recording;
}

}  // namespace headpin::devices
