#include "devices/emulated/lcm_feed.h"

#include "devices/log/sample_messages.h"

namespace headpin::devices {

LcmFeed::LcmFeed(const std::string& url) : lcm_(*open_device("lcm:" + url, clocks_, {})) {
  for (int s = 0; s < kFastrakStations; ++s) {
    newest_[static_cast<std::size_t>(s)] = still_motion(s + 1, Time{});
  }
  lcm_.source->start();
}

std::vector<std::string> LcmFeed::poll(Time now) {
  samples_.clear();
  lcm_.source->poll(now, samples_);
  for (const Sample& sample : samples_) {
    if (const auto* mouse = std::get_if<MouseSample>(&sample)) {
      trigger_ = mouse->trigger;
      continue;
    }
    const auto& tracker = std::get<TrackerSample>(sample);
    if (tracker.station < 1 || tracker.station > kFastrakStations) continue;
    newest_[static_cast<std::size_t>(tracker.station - 1)] = {
        tracker.X_TS, (tracker.buttons & 1) != 0, status_letter(tracker)};
  }
  return faults_.take(lcm_.source->status(now).faults, now);
}

FastrakTruth LcmFeed::at(int station) const {
  FastrakTruth truth = newest_[static_cast<std::size_t>(station - 1)];
  truth.pressed = truth.pressed || trigger_;
  return truth;
}

}  // namespace headpin::devices
