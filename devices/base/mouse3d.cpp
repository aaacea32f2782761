#include "devices/base/mouse3d.h"

#include <algorithm>
#include <utility>

namespace headpin::devices {

namespace {
constexpr Time kLongestHeld{25'000};  // a longer time between two records counts as this
}

std::optional<MouseSample> StylusTrigger::update(const TrackerSample& sample) {
  if (station_ != 0 && sample.station != station_) return std::nullopt;
  const bool down = (sample.buttons & 1) != 0;
  const Time before = std::exchange(before_, sample.device_time).value_or(sample.device_time);
  if (down == down_) return std::nullopt;
  down_ = down;
  MouseSample mouse;
  mouse.device_time =
      sample.device_time - std::clamp(sample.device_time - before, Time{0}, kLongestHeld) / 2;
  mouse.host_time = sample.host_time;
  mouse.trigger = down;
  return mouse;
}

void StylusMouse::poll(Time now, std::vector<Sample>& out) {
  polled_.clear();
  tracker_->poll(now, polled_);
  for (Sample& sample : polled_) {
    std::optional<MouseSample> mouse;
    if (const auto* tracker = std::get_if<TrackerSample>(&sample)) {
      if (!own_line_) mouse = trigger_.update(*tracker);
    } else {
      own_line_ = true;
    }
    out.push_back(std::move(sample));
    if (mouse) out.emplace_back(*mouse);
  }
}

}  // namespace headpin::devices
