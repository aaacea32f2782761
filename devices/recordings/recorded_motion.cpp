#include "devices/recordings/recorded_motion.h"

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <utility>

#include "devices/base/resample.h"
#include "devices/fastrak/codec.h"
#include "devices/fastrak/geometry.h"
#include "devices/log/sample_messages.h"

namespace headpin::devices {
namespace {

/// A value that is constant from one change to the next.
template <typename T>
class Steps {
 public:
  void push(Time time, T value) {
    if (newest_ && time < *newest_) return;
    newest_ = time;
    if (changes_.empty() || changes_.back().value != value) changes_.push_back({time, value});
  }
  T at(Time time, T before) const {
    const auto after = later_than(time);
    return after == changes_.begin() ? before : (after - 1)->value;
  }
  /// Removes older changes, except the last one before the time.
  void forget_before(Time time) {
    const auto after = later_than(time);
    if (after - changes_.begin() > 1) changes_.erase(changes_.begin(), after - 1);
  }

 private:
  auto later_than(Time time) const {
    return std::upper_bound(changes_.begin(), changes_.end(), time,
                            [](Time t, const auto& change) { return t < change.time; });
  }
  std::vector<Stamped<T>> changes_;
  std::optional<Time> newest_;
};

/// The pose at a time. Stamps are whole microseconds, so a sample within one microsecond is exact.
std::optional<Pose> pose_at(const PoseTrack& poses, Time time) {
  const auto& samples = poses.samples();
  const auto near = std::ranges::lower_bound(samples, time - Time{1}, {}, &Stamped<Pose>::time);
  if (near != samples.end() && near->time <= time + Time{1}) return near->value;
  return poses.at(time);
}

/// The measurements of one station.
struct StationTrack {
  PoseTrack poses;
  Steps<char> errors;
  Steps<bool> switches;
};

struct Recording {
  std::array<StationTrack, kFastrakStations> stations;
  Steps<bool> trigger;

  void take(const Sample& sample) {
    if (const auto* mouse = std::get_if<MouseSample>(&sample)) return take(*mouse);
    const auto& tracker = std::get<TrackerSample>(sample);
    if (tracker.station < 1 || tracker.station > kFastrakStations) return;
    StationTrack& station = stations[static_cast<std::size_t>(tracker.station - 1)];
    if (!station.poses.push(tracker.device_time, tracker.X_TS)) return;
    station.errors.push(tracker.device_time, status_letter(tracker));
    station.switches.push(tracker.device_time, (tracker.buttons & 1) != 0);
  }
  void take(const MouseSample& mouse) { trigger.push(mouse.device_time, mouse.trigger); }

  FastrakTruth at(int number, Time time) const {
    const StationTrack& station = stations[static_cast<std::size_t>(number - 1)];
    FastrakTruth truth = still_motion(number, time);
    truth.X_TS = pose_at(station.poses, time).value_or(truth.X_TS);
    truth.error = station.errors.at(time, ' ');
    truth.pressed = trigger.at(time, false);
    for (const StationTrack& each : stations) truth.pressed |= each.switches.at(time, false);
    return truth;
  }

  void forget_before(Time time) {
    for (StationTrack& station : stations) {
      station.poses.forget_before(time);
      station.errors.forget_before(time);
      station.switches.forget_before(time);
    }
  }
};

/// A recording on disk; only the part around the requested time is in memory.
class ForwardRecording {
 public:
  ForwardRecording(RecordingOnDisk on_disk, const std::vector<MouseSample>& buttons)
      : on_disk_(std::move(on_disk)) {
    for (const MouseSample& mouse : buttons) at_start_.take(mouse);
  }

  FastrakTruth at(int station, Time time) {
    if (!next_ || time < latest_ - kKept) rewind(time);
    latest_ = std::max(latest_, time);
    while (!knows(time)) read();
    recording_.forget_before(latest_ - kKept);
    return recording_.at(station, time);
  }

 private:
  static constexpr Time kKept{1'000'000};

  void rewind(Time time) {
    recording_ = at_start_;
    newest_ = {};
    latest_ = time;
    next_ = on_disk_.read();
    ended_ = false;
  }
  /// Whether no later sample can change the state at this time.
  bool knows(Time time) const {
    if (ended_) return true;
    for (const auto& [device, last] : on_disk_.last) {
      const std::int32_t station = station_of(device).value_or(0);
      if (station < 1 || station > kFastrakStations) continue;
      const std::optional<Time>& newest = newest_[static_cast<std::size_t>(station - 1)];
      if (!newest || (*newest <= time && *newest < last)) return false;
    }
    return true;
  }
  void read() {
    const std::optional<Sample> sample = next_();
    ended_ = !sample;
    const auto* tracker = sample ? std::get_if<TrackerSample>(&*sample) : nullptr;
    if (!tracker || tracker->station < 1 || tracker->station > kFastrakStations) return;
    recording_.take(*sample);
    std::optional<Time>& newest = newest_[static_cast<std::size_t>(tracker->station - 1)];
    newest = std::max(newest.value_or(tracker->device_time), tracker->device_time);
  }

  RecordingOnDisk on_disk_;
  Recording at_start_;  // with all changes of the trigger
  Recording recording_;
  std::function<std::optional<Sample>()> next_;
  std::array<std::optional<Time>, kFastrakStations> newest_;  // of the samples read so far
  Time latest_{};                                             // latest requested time
  bool ended_ = false;
};

/// Calls a function for every sample of a recording.
using Samples = std::function<void(const std::function<void(const Sample&)>&)>;

Samples samples_of(const std::vector<Sample>& samples) {
  return [&samples](const std::function<void(const Sample&)>& see) {
    for (const Sample& sample : samples) see(sample);
  };
}

Samples samples_of(const RecordingOnDisk& recording) {
  return [&recording](const std::function<void(const Sample&)>& see) {
    const auto next = recording.read();
    while (const std::optional<Sample> sample = next()) see(*sample);
  };
}

/// The range of good measurements.
struct Reach {
  bool any = false;
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();
  double farthest = 0.0;  ///< from a point
};

Reach reach_from(const Samples& samples, const Vec3& p_TP) {
  Reach e;
  samples([&](const Sample& sample) {
    const auto* tracker = std::get_if<TrackerSample>(&sample);
    if (!tracker || !tracker->good()) return;
    const Vec3& p = tracker->X_TS.p;
    e.low = e.any ? Vec3(e.low.cwiseMin(p)) : p;
    e.high = e.any ? Vec3(e.high.cwiseMax(p)) : p;
    e.farthest = std::max(e.farthest, (p - p_TP).norm());
    e.any = true;
  });
  return e;
}

FastrakPlace place_of(const Samples& samples) {
  constexpr double kAhead = 0.3;  // nearer to the transmitter, the field is not a dipole's [m]
  FastrakPlace place;
  const Reach e = reach_from(samples, place.p_TP);
  if (!e.any) return place;
  place.farthest = e.farthest;
  if (e.low.x() <= 0.0 || e.farthest > kFastrakRange) {
    place.p_TP =
        Vec3(e.low.x() - kAhead, 0.5 * (e.low.y() + e.high.y()), 0.5 * (e.low.z() + e.high.z()));
    place.farthest = reach_from(samples, place.p_TP).farthest;
  }
  const double widest = std::max((e.high - place.p_TP).cwiseAbs().maxCoeff(),
                                 (e.low - place.p_TP).cwiseAbs().maxCoeff());
  if (widest > place.envelope) place.envelope = kFastrakRange;
  return place;
}

/// Finds the earliest measurement, the last time, and the changes of the mouse.
void look_through(const Samples& samples, RecordedUnit& unit) {
  bool measured = false;
  samples([&](const Sample& sample) {
    unit.length = std::max(unit.length, device_time(sample));
    if (const auto* mouse = std::get_if<MouseSample>(&sample)) {
      const MouseSample* last = unit.buttons.empty() ? nullptr : &unit.buttons.back();
      const bool same = last && last->left_thumb == mouse->left_thumb &&
                        last->right_thumb == mouse->right_thumb && last->trigger == mouse->trigger;
      if (!same && (!last || mouse->device_time >= last->device_time)) {
        unit.buttons.push_back(*mouse);
      }
      return;
    }
    const auto& tracker = std::get<TrackerSample>(sample);
    if (!measured || tracker.device_time < unit.first.device_time) unit.first = tracker;
    measured = true;
  });
}

}  // namespace

FastrakMotion recorded_motion(const std::vector<Sample>& samples) {
  const auto recording = std::make_shared<Recording>();  // shared: a std::function is copied
  for (const Sample& sample : samples) recording->take(sample);
  return [recording](int station, Time time) { return recording->at(station, time); };
}

FastrakPlace place_for(const std::vector<Sample>& samples) {
  return place_of(samples_of(samples));
}

TrackerSample first_measurement(const std::vector<Sample>& samples) {
  RecordedUnit unit;
  look_through(samples_of(samples), unit);
  return unit.first;
}

Time last_time(const std::vector<Sample>& samples) {
  RecordedUnit unit;
  look_through(samples_of(samples), unit);
  return unit.length;
}

RecordedUnit recorded_unit(RecordingOnDisk recording) {
  RecordedUnit unit;
  look_through(samples_of(recording), unit);
  unit.place = place_of(samples_of(recording));
  const auto forward = std::make_shared<ForwardRecording>(std::move(recording), unit.buttons);
  unit.motion = [forward](int station, Time time) { return forward->at(station, time); };
  return unit;
}

}  // namespace headpin::devices
