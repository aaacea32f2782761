#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "devices/lcm/link.h"

namespace headpin::devices {

/// Publishes the buttons of the 3D mouse on MOUSE3D, because a Fastrak's records have no room for
/// them: at each change, and for a trial also ten times per second, from which listeners estimate
/// the delay of messages.
class EmulatedMouse {
 public:
  /// @param recorded  samples of a trial in order of time, which are replayed
  EmulatedMouse(const LcmUrl& url, std::vector<MouseSample> recorded)
      : link_(url), recorded_(std::move(recorded)) {}

  MouseSample typed;  ///< buttons that are pressed beside the recorded ones

  /// @param now  current time on the clock of the messages
  /// @param at   current time in the trial
  void publish(Time now, Time at);

 private:
  void tell(Time time);

  static constexpr Time kAgain{100'000};

  LcmLink link_;
  std::vector<MouseSample> recorded_;
  std::size_t told_ = 0;  ///< number of them that were published
  MouseSample then_;      ///< the last published one
  std::optional<std::array<bool, 3>> told_last_;
  Time told_at_{};
};

}  // namespace headpin::devices
