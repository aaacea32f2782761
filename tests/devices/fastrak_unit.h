#pragma once

#include <string>
#include <string_view>
#include <utility>

#include "devices/fastrak/emulator.h"

namespace headpin::devices {

/// An emulated unit on a bench: what is typed, what comes back, and a clock that the test turns.
class Unit {
 public:
  explicit Unit(FastrakEmulatorOptions options = quiet(), FastrakMotion motion = still_motion)
      : emulator(std::move(options), std::move(motion)) {}

  /// Options without noise.
  static FastrakEmulatorOptions quiet() {
    FastrakEmulatorOptions options;
    options.faults.noise = 0.0;
    return options;
  }

  void type(std::string_view text) {
    emulator.receive({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, now);
  }

  /// What comes within `span`, read every millisecond.
  std::string listen(Time span) {
    std::string heard;
    for (const Time end = now + span; now < end;) {
      now += Time{1000};
      const Bytes due = emulator.due(now);
      heard.append(due.begin(), due.end());
      emulator.taken(due.size());
    }
    return heard;
  }

  /// The answer to `text`, given 100 ms.
  std::string ask(std::string_view text) {
    type(text);
    return listen(Time{100'000});
  }

  Time now{};
  FastrakEmulator emulator;
};

}  // namespace headpin::devices
