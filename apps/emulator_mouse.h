#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "devices/lcm/link.h"

namespace headpin::apps {

/// The buttons of the 3D mouse, which a Fastrak's line has no room for: on MOUSE3D, at each change;
/// those of a trial ten times a second too, by which listeners learn how late messages are.
class EmulatedMouse {
 public:
  /// @param recorded  of a trial, in the order of time; its buttons are pressed as they were
  EmulatedMouse(const std::string& url, std::vector<devices::MouseSample> recorded)
      : link_(url), recorded_(std::move(recorded)) {}

  devices::MouseSample typed;  ///< what --control holds down beside the trial

  /// @param now  on the clock that messages are stamped by; a trial's changes are as exact as it is
  /// @param at   in the trial
  void publish(Time now, Time at);

 private:
  void tell(Time time);

  static constexpr Time kAgain{100'000};

  devices::LcmLink link_;
  std::vector<devices::MouseSample> recorded_;
  std::size_t told_ = 0;       ///< of these
  devices::MouseSample then_;  ///< the last of them
  std::optional<std::array<bool, 3>> told_last_;
  Time told_at_{};
};

}  // namespace headpin::apps
