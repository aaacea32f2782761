#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

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

/// One receiver at rest where the test puts it.
inline FastrakMotion at(const Vec3& p_TS, const Quat& q_TS = Quat::Identity()) {
  return [=](int, Time) { return FastrakTruth{{q_TS, p_TS}}; };
}

inline FastrakEmulatorOptions one_receiver() {
  FastrakEmulatorOptions options = Unit::quiet();
  options.receivers = 1;
  return options;
}

inline FastrakRecord ascii_record(const std::string& line, std::vector<int> items = {2, 4, 1},
                                  bool centimetres = false) {
  const std::vector<std::uint8_t> bytes(line.begin(), line.end());
  const auto record = decode_record(bytes, {std::move(items), false, centimetres});
  EXPECT_TRUE(record.has_value()) << line;
  return record.value_or(FastrakRecord{});
}

}  // namespace headpin::devices
