#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <string>

#include "base/output_file.h"
#include "devices/log/event_log.h"
#include "scene/record/log.h"
#include "scene/record/messages.h"
#include "tests/support/folder.h"

/// Short trials in a log, and what makes and damages their bytes.
namespace headpin::scene::test {

namespace fs = std::filesystem;

inline devices::Buffer read_bytes(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return devices::Buffer(std::istreambuf_iterator<char>(file), {});
}

inline void write_bytes(const fs::path& path, std::span<const std::uint8_t> bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
}

inline devices::TrackerSample tracker(int i) {
  devices::TrackerSample sample;
  sample.device_time = Time{8333 * i};
  sample.sequence = i / 2;
  sample.station = 1 + i % 2;
  sample.X_TS = {rotation(Vec3(0.1 * i, 0.2, -0.3)), Vec3(0.01 * i, -1.0 / 3.0, 1e-9)};
  sample.status = i == 3 ? 'W' : ' ';
  sample.buttons = static_cast<std::uint8_t>(i & 1);
  return sample;
}

inline TickState state(int tick) {
  TickState state{
      tick_time(tick, 240), tick, 0xfedcba9876543210u + static_cast<unsigned>(tick), tick % 3, {}};
  for (int b = 0; b < 3; ++b) {
    state.bodies.push_back({{rotation(Vec3(0.1 * b, 0.0, 0.0)), Vec3(b, 0.25, 0.125)},
                            {Vec3(0.0, 7.5, -0.1), Vec3(b, 1.0, 2.0)},
                            b == 1});
  }
  return state;
}

inline TrialHeader header() {
  TrialHeader h;
  h.participant = "P07";
  h.condition = "e=0.7 f=0.7";
  h.seed = 0xffffffffffffffffu;
  h.scenario = "[ball]\nmass = 7.0  # \xc3\xa4\n";
  h.body_names = {"ball", "skittle_1", "skittle_2"};
  return h;
}

inline Event event() {
  Event e{Time{5000},
          1,
          "first_contact",
          {"ball", "skittle_1"},
          Vec3(0.1, 5.0, 0.15),
          Vec3(0.0, -3.0, 0.5),
          6.5,
          ""};
  return e;
}

/// A short trial with some of everything: the header, then 12 samples, a button, an event, 6
/// states, a frame.
inline void record(const fs::path& path, const base::OutputFile::Options& options = {}) {
  Recorder recorder(base::OutputFile(path, options), header());
  for (int i = 0; i < 12; ++i) {
    recorder.write(devices::Sample(tracker(i)));
    if (i % 2 == 0) recorder.write(state(i / 2));
  }
  recorder.write(devices::Sample(devices::MouseSample{Time{100'000}, Time{}, false, true, true}));
  recorder.write(event());
  recorder.write(FrameRecord{Time{16'666}, 1, 4, {tracker(1).X_TS, tracker(2).X_TS}, {7u, ~0ull}});
  recorder.close();
}
inline constexpr int kMessages = 1 + 12 + 6 + 1 + 1 + 1;

inline devices::Buffer recorded() {
  const fs::path path = fresh_folder("log") / "trial.lcmlog";
  record(path);
  return read_bytes(path);
}

/// Where the field of 4 bytes at `offset` of the header of the `n`th event stands.
inline std::size_t header_field(const devices::Buffer& bytes, int n, std::size_t offset) {
  devices::LogReader reader(bytes);
  std::size_t start = 0;
  for (int i = 0; i <= n; ++i) {
    const auto event = reader.next();
    start =
        static_cast<std::size_t>(event->data.data() - bytes.data()) - event->channel.size() - 28;
  }
  return start + offset;
}

inline void put_int32(devices::Buffer& bytes, std::size_t at, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i) {
    bytes[at + i] = static_cast<std::uint8_t>(value >> (24 - 8 * i));
  }
}

/// A log of one event.
inline devices::Buffer one_event(const std::string& channel, const devices::Buffer& data) {
  devices::Buffer bytes(28 + channel.size() + data.size());
  put_int32(bytes, 0, 0xEDA1DA01u);
  put_int32(bytes, 20, static_cast<std::uint32_t>(channel.size()));
  put_int32(bytes, 24, static_cast<std::uint32_t>(data.size()));
  const auto rest = std::ranges::copy(channel, bytes.begin() + 28).out;
  std::ranges::copy(data, rest);
  return bytes;
}

/// Two minutes of a head and a hand, with states between.
inline devices::Buffer two_minutes() {
  const fs::path path = fresh_folder("log") / "trial.lcmlog";
  Recorder recorder(path, header());
  for (int i = 1; i <= 1200; ++i) {
    devices::TrackerSample sample = tracker(i);
    sample.device_time = Time{100'000 * i};
    sample.host_time = sample.device_time + Time{5'000};
    recorder.write(devices::Sample(sample));
    TickState at = state(24 * i);
    recorder.write(at);
  }
  recorder.close();
  return read_bytes(path);
}

}  // namespace headpin::scene::test
