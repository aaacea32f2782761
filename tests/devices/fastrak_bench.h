#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <poll.h>

#include "devices/fastrak/driver.h"
#include "devices/fastrak/serving.h"

/// An emulated unit and a driver on one line.
namespace headpin::devices::test {

using namespace std::chrono_literals;

#ifdef HEADPIN_SANITIZED
inline constexpr int kLess = 10;  // sanitizers run the long ones shorter
#else
inline constexpr int kLess = 1;
#endif

inline FastrakEmulatorOptions unit(const std::string& faults = "", int receivers = 2) {
  FastrakEmulatorOptions options;
  options.receivers = receivers;
  options.faults = parse_faults(faults);
  options.seed = 7;
  return options;
}

struct Ends {
  std::unique_ptr<ByteStream> unit, host;
};

inline Ends memory() {
  auto [a, b] = memory_streams();
  return {std::move(a), std::move(b)};
}

/// A unit and a driver at the two ends of a line, and a clock that the test turns.
struct Bench {
  Bench(FastrakEmulatorOptions unit_options, FastrakOptions options, Ends ends = memory(),
        FastrakMotion motion = circling_motion)
      : line(std::move(ends.unit)),
        emulator(listened(std::move(unit_options)), std::move(motion)),
        driver(std::move(ends.host), clocks, std::move(options)) {}
  Bench(const Bench&) = delete;
  Bench& operator=(const Bench&) = delete;

  FastrakEmulatorOptions listened(FastrakEmulatorOptions options) {
    options.on_record = [this](const FastrakSent& record) { sent.push_back(record); };
    return options;
  }

  void run(Time span, Time step = 1ms) {
    for (const Time end = now + span; now < end;) {
      now += step;
      if (!emulator.due(now).empty()) {
        serve(emulator, *line, now);
        settle(driver.descriptor());
      } else {
        serve(emulator, *line, now);
      }
      driver.poll(now, samples);
    }
  }

  // A terminal hands bytes on a moment later, outside of the test's clock: wait for it.
  static void settle(int descriptor) {
    if (descriptor < 0) return;
    pollfd state{descriptor, POLLIN, 0};
    ::poll(&state, 1, 100);
  }

  bool run_until_streaming(Time patience = 60s) {
    for (const Time end = now + patience; now < end && !driver.streaming();) run(5ms);
    return driver.streaming();
  }

  std::vector<FastrakSent> sent;
  std::vector<Sample> samples;
  Time now{};
  std::unique_ptr<ByteStream> line;
  FastrakEmulator emulator;
  Clocks clocks;
  FastrakDriver driver;
};

inline const TrackerSample& tracker(const Sample& sample) {
  return std::get<TrackerSample>(sample);
}

}  // namespace headpin::devices::test
