#include "devices/fastrak_motion.h"

#include <algorithm>
#include <array>
#include <memory>
#include <numbers>

#include "devices/fastrak_geometry.h"
#include "devices/resample.h"

namespace headpin::devices {
namespace {

/// A value that stays what it is until the next change.
template <typename T>
class Steps {
 public:
  void push(Time time, T value) {
    if (changes_.empty() || (changes_.back().value != value && changes_.back().time <= time)) {
      changes_.push_back({time, value});
    }
  }
  T at(Time time, T before) const {
    const auto after = std::upper_bound(changes_.begin(), changes_.end(), time,
                                        [](Time t, const auto& change) { return t < change.time; });
    return after == changes_.begin() ? before : (after - 1)->value;
  }

 private:
  std::vector<Stamped<T>> changes_;
};

struct Recording {
  std::array<PoseTrack, 4> poses;
  std::array<Steps<char>, 4> errors;
  std::array<Steps<bool>, 4> switches;
  Steps<bool> trigger;
};

}  // namespace

FastrakTruth still_motion(int station, Time) {
  FastrakTruth truth;
  truth.X_TS.p = Vec3(0.4, 0.1 * (station - 2), -0.1);
  return truth;
}

FastrakTruth circling_motion(int station, Time time) {
  constexpr Time kTurn{4'000'000};
  const double angle = 2.0 * std::numbers::pi * seconds(time % kTurn) / seconds(kTurn);
  const SinCos at = sin_cos(angle);
  FastrakTruth truth = still_motion(station, time);
  truth.X_TS.p += Vec3(0.2 * at.cos, 0.2 * at.sin, 0.0);
  truth.X_TS.q = rotation(angle * Vec3::UnitZ());
  return truth;
}

FastrakMotion recorded_motion(const std::vector<Sample>& samples) {
  auto recording = std::make_shared<Recording>();  // shared: a std::function is copied
  for (const Sample& sample : samples) {
    if (const auto* mouse = std::get_if<MouseSample>(&sample)) {
      recording->trigger.push(mouse->device_time, mouse->trigger);
    } else {
      const auto& tracker = std::get<TrackerSample>(sample);
      if (tracker.station < 1 || tracker.station > 4) continue;
      const auto s = static_cast<std::size_t>(tracker.station - 1);
      recording->poses[s].push(tracker.device_time, tracker.X_TS);
      recording->errors[s].push(tracker.device_time, tracker.status);
      recording->switches[s].push(tracker.device_time, (tracker.buttons & 1) != 0);
    }
  }
  return [recording](int station, Time time) {
    const auto s = static_cast<std::size_t>(station - 1);
    FastrakTruth truth = still_motion(station, time);
    truth.X_TS = recording->poses[s].at(time).value_or(truth.X_TS);
    truth.error = recording->errors[s].at(time, ' ');
    truth.pressed = recording->trigger.at(time, false);
    for (const Steps<bool>& each : recording->switches) truth.pressed |= each.at(time, false);
    return truth;
  };
}

FastrakPlace place_for(const std::vector<Sample>& samples) {
  constexpr double kAhead = 0.3;  // nearer to the transmitter the field is no dipole's [m]
  std::vector<Vec3> all;
  for (const Sample& sample : samples) {
    const auto* tracker = std::get_if<TrackerSample>(&sample);
    if (tracker && tracker->good()) all.push_back(tracker->X_TS.p);
  }
  FastrakPlace place;
  if (all.empty()) return place;
  Vec3 low = all.front(), high = all.front();
  for (const Vec3& p : all) low = low.cwiseMin(p), high = high.cwiseMax(p);
  const auto farthest = [&] {
    double most = 0.0;
    for (const Vec3& p : all) most = std::max(most, (p - place.p_TP).norm());
    return most;
  };
  if (low.x() <= 0.0 || farthest() > kFastrakRange) {
    place.p_TP = Vec3(low.x() - kAhead, 0.5 * (low.y() + high.y()), 0.5 * (low.z() + high.z()));
  }
  place.farthest = farthest();
  const double widest =
      std::max((high - place.p_TP).cwiseAbs().maxCoeff(), (low - place.p_TP).cwiseAbs().maxCoeff());
  if (widest > place.envelope) place.envelope = kFastrakRange;
  return place;
}

FastrakMotion seen_from(const FastrakPlace& place, FastrakMotion motion) {
  return [p_TP = place.p_TP, motion = std::move(motion)](int station, Time time) {
    FastrakTruth truth = motion(station, time);
    truth.X_TS.p -= p_TP;
    return truth;
  };
}

TrackerSample first_measurement(const std::vector<Sample>& samples) {
  const TrackerSample* first = nullptr;
  for (const Sample& sample : samples) {
    const auto* tracker = std::get_if<TrackerSample>(&sample);
    if (tracker && (!first || tracker->device_time < first->device_time)) first = tracker;
  }
  return first ? *first : TrackerSample{};
}

Time last_time(const std::vector<Sample>& samples) {
  Time last{};
  for (const Sample& sample : samples) last = std::max(last, device_time(sample));
  return last;
}

}  // namespace headpin::devices
