// Records of the Fastrak decoded and encoded per second on one core, beside the C library as most
// of its drivers use it, and a whole simulated minute; logs written and read, beside liblcm, which
// leaves the messages as they are; and how long a sample takes through a live session to a frame.

#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <lcm/lcm.h>
#include <nlohmann/json.hpp>

#include "base/output_file.h"
#include "devices/base/sources.h"
#include "devices/fastrak/driver.h"
#include "devices/fastrak/serving.h"
#include "devices/log/event_log.h"
#include "scene/record/log.h"
#include "tests/bench/report.h"
#include "tests/support/folder.h"

namespace {

using namespace headpin;
using namespace std::chrono_literals;

constexpr int kRecords = 10'000;

/// Records of a circling receiver, one behind the other.
std::vector<std::uint8_t> stream_of(const devices::FastrakFormat& format, int noise_every = 0) {
  std::vector<std::uint8_t> stream;
  for (int i = 0; i < kRecords; ++i) {
    const Pose X = devices::circling_motion(1, tick_time(i, 120)).X_TS;
    devices::FastrakRecord record;
    record.position = X.p / format.metre_per_unit();
    record.quaternion = {X.q.w(), X.q.x(), X.q.y(), X.q.z()};
    record.angles_deg = devices::angles_deg(X.q);
    if (noise_every > 0 && i % noise_every == 0) stream.insert(stream.end(), {'0', '1', 0x7F});
    devices::encode_record(record, format, stream);
  }
  return stream;
}

/// Decodes the whole stream as a driver meets it; returns the sum of x.
double find_all(const std::vector<std::uint8_t>& stream, const devices::FastrakFormats& formats) {
  double sum = 0.0;
  bool in_step = true;
  for (devices::Bytes rest = stream; !rest.empty();) {
    const devices::FastrakFound found = devices::find_record(rest, formats, in_step, true);
    if (found.length > 0) sum += found.record.position.x();
    in_step = found.length > 0;
    rest = rest.subspan(found.skipped + found.length);
  }
  return sum;
}

/// As most drivers read a record: fixed columns through sscanf.
double scan_all(const std::vector<std::uint8_t>& stream, std::size_t length) {
  double sum = 0.0;
  for (std::size_t at = 0; at + length <= stream.size(); at += length) {
    std::array<char, 64> line{};
    std::memcpy(line.data(), stream.data() + at, length);
    double v[6];
    if (std::sscanf(line.data() + 3, "%7lf%7lf%7lf%7lf%7lf%7lf", v, v + 1, v + 2, v + 3, v + 4,
                    v + 5) == 6) {
      sum += v[0];
    }
  }
  return sum;
}

double encode_all(const std::vector<devices::FastrakRecord>& records,
                  const devices::FastrakFormat& format) {
  std::vector<std::uint8_t> out;
  out.reserve(records.size() * 64);
  for (const auto& record : records) devices::encode_record(record, format, out);
  return static_cast<double>(out.size());
}

double print_all(const std::vector<devices::FastrakRecord>& records) {
  std::string out;
  out.reserve(records.size() * 64);
  for (const auto& r : records) {
    std::array<char, 64> line{};
    const int n = std::snprintf(line.data(), line.size(), "0%d%c%7.2f%7.2f%7.2f%7.2f%7.2f%7.2f\r\n",
                                r.station, r.error, r.position.x(), r.position.y(), r.position.z(),
                                r.angles_deg.x(), r.angles_deg.y(), r.angles_deg.z());
    out.append(line.data(), static_cast<std::size_t>(n));
  }
  return static_cast<double>(out.size());
}

/// A minute of four receivers at 115200 baud, unit and driver together.
double stream_a_minute() {
  auto [unit_end, host_end] = devices::memory_streams();
  devices::FastrakEmulatorOptions options;
  options.receivers = 4;
  devices::FastrakEmulator unit(options, devices::circling_motion);
  devices::Clocks clocks;
  devices::FastrakDriver driver(std::move(host_end), clocks);
  std::vector<devices::Sample> samples;
  for (Time now{}; now < 60s; now += 1ms) {
    devices::serve(unit, *unit_end, now);
    driver.poll(now, samples);
  }
  return static_cast<double>(samples.size());
}

/// A folder for the time being.
struct Folder {
  bool run(const std::string& command) const {
    return std::system(("cd '" + path.string() + "' && " + command).c_str()) == 0;
  }
  std::string operator/(const char* name) const { return (path / name).string(); }

  std::filesystem::path path = fresh_folder("bench");
};

/// Reads it as its users do, message by message into a trial; returns the states.
double read_whole(const std::string& path) {
  return static_cast<double>(headpin::scene::read_trial(path).states.size());
}

/// Finds the events only.
double read_events(const std::string& path) {
  devices::FileWindow file(path);
  devices::LogReader reader(file);
  double sum = 0.0;
  while (const auto event = reader.next()) sum += static_cast<double>(event->data.size());
  return sum;
}

double read_by_liblcm(const std::string& path) {
  lcm_eventlog_t* log = lcm_eventlog_create(path.c_str(), "r");
  double sum = 0.0;
  while (lcm_eventlog_event_t* event = lcm_eventlog_read_next_event(log)) {
    sum += event->datalen;
    lcm_eventlog_free_event(event);
  }
  lcm_eventlog_destroy(log);
  return sum;
}

/// Encodes and writes it, safe after each message.
double write_whole(const scene::Trial& trial, const std::string& path) {
  scene::Recorder recorder(base::OutputFile(path, {.overwrite = true, .live = true}), trial.header);
  std::size_t sample = 0;
  for (const scene::TickState& state : trial.states) {
    for (; sample < trial.samples.size(); ++sample) {
      if (devices::available(trial.samples[sample]) > state.time) break;
      recorder.write(trial.samples[sample]);
    }
    recorder.write(state);
  }
  for (const scene::Event& event : trial.events) recorder.write(event);
  recorder.close();
  return static_cast<double>(sample);
}

/// Events as they lie in a log.
struct RawEvent {
  std::int64_t time;
  std::string channel;
  std::vector<std::uint8_t> data;
};

std::vector<RawEvent> raw_events(const std::string& path) {
  devices::FileWindow file(path);
  devices::LogReader reader(file);
  std::vector<RawEvent> events;
  while (const auto event = reader.next()) {
    events.push_back({event->time.count(),
                      std::string(event->channel),
                      {event->data.begin(), event->data.end()}});
  }
  return events;
}

/// Writes what is encoded already.
double write_by_liblcm(std::vector<RawEvent>& events, const std::string& path, bool safe) {
  lcm_eventlog_t* log = lcm_eventlog_create(path.c_str(), "w");
  for (RawEvent& raw : events) {
    lcm_eventlog_event_t event{};
    event.timestamp = raw.time;
    event.channellen = static_cast<std::int32_t>(raw.channel.size());
    event.datalen = static_cast<std::int32_t>(raw.data.size());
    event.channel = raw.channel.data();
    event.data = raw.data.data();
    lcm_eventlog_write_event(log, &event);
    if (safe) std::fflush(log->f);
  }
  lcm_eventlog_destroy(log);
  return static_cast<double>(events.size());
}

/// The bundled trial, simulated: megabytes of states.
std::vector<bench::Row> logs(const Folder& folder) {
  const std::string log = folder / "trial.lcmlog", out = folder / "out.lcmlog";
  if (!folder.run(HEADPIN_PROGRAM " replay " HEADPIN_SOURCE_DIR
                                  "/assets/trials/demo.lcmlog -o trial.lcmlog >/dev/null")) {
    throw std::runtime_error("headpin replay failed");
  }
  const scene::Trial trial = scene::read_trial(log);
  std::vector<RawEvent> events = raw_events(log);
  const std::vector<double> s =
      bench::interleaved({{"read", [&] { return read_whole(log); }},
                          {"events", [&] { return read_events(log); }},
                          {"read liblcm", [&] { return read_by_liblcm(log); }},
                          {"write", [&] { return write_whole(trial, out); }},
                          {"safe liblcm", [&] { return write_by_liblcm(events, out, true); }},
                          {"liblcm", [&] { return write_by_liblcm(events, out, false); }}},
                         31);
  const double MB = 1e-6 * static_cast<double>(std::filesystem::file_size(log));
  return {
      {"log read and decoded", "MB/s", MB / s[0], "liblcm, not decoded", MB / s[2]},
      {"log read, not decoded", "MB/s", MB / s[1], "liblcm, not decoded", MB / s[2]},
      {"log encoded and written, flushed", "MB/s", MB / s[3], "liblcm, encoded", MB / s[5]},
      {"log encoded and written, flushed", "MB/s", MB / s[3], "liblcm, encoded, flushed",
       MB / s[4]},
  };
}

/// A live session fed with the bundled trial by LCM's own player, in a network of its own; nothing
/// where that is not allowed.
std::vector<bench::Row> live(const Folder& folder) {
  std::ofstream(folder / "live.sh")
      << "ip link set lo up && ip link set lo multicast on && ip route add 224.0.0.0/4 dev lo || "
         "exit 1\n"
         "headpin='" HEADPIN_PROGRAM "'; demo='" HEADPIN_SOURCE_DIR
         "/assets/trials/demo.lcmlog'\n"
         "$headpin info $demo --scenario >room.toml || exit 1\n"
         "$headpin live --lcm '' --scenario room.toml --record live.lcmlog --json >live.json &\n"
         "until [ -s live.lcmlog ]; do sleep 0.1; done\n"
         "lcm-logplayer $demo >/dev/null && sleep 0.2 && kill -INT $! && wait $!\n";
  if (!folder.run("unshare -n sh live.sh 2>live.err")) {
    std::ifstream error(folder / "live.err");
    std::string line;
    std::getline(error, line);
    std::printf("latency of live: left out, as it needs a network of its own (unshare -n): %s\n",
                line.c_str());
    return {};
  }
  const auto j = nlohmann::json::parse(std::ifstream(folder / "live.json"));
  std::printf("live: %d ticks, %d samples, %d frames, %d late, %d overruns\n",
              j["ticks"].get<int>(), j["samples"].get<int>(), j["frames"].get<int>(),
              j["late_frames"].get<int>(), j["overruns"].get<int>());
  return {
      {"live, sample to frame, median", "ms", 1e3 * j["latency_median_s"].get<double>(), "goal",
       20.0},
      {"live, sample to frame, 99 %", "ms", 1e3 * j["latency_p99_s"].get<double>(), "goal", 40.0}};
}

}  // namespace

int main() {
  const devices::FastrakFormat binary{{2, 11, 16, 1}, true, true}, ascii{{2, 4, 1}, false, true};
  devices::FastrakFormats binaries, asciis;
  binaries.fill(binary);
  asciis.fill(ascii);
  const auto binary_stream = stream_of(binary), noisy_stream = stream_of(binary, 5),
             ascii_stream = stream_of(ascii);
  std::vector<devices::FastrakRecord> records;
  for (std::size_t at = 0; at < ascii_stream.size(); at += 47) {
    records.push_back(*devices::decode_record(devices::Bytes(ascii_stream).subspan(at, 47), ascii));
  }

  const std::vector<double> s =
      bench::interleaved({{"binary", [&] { return find_all(binary_stream, binaries); }},
                          {"noisy", [&] { return find_all(noisy_stream, binaries); }},
                          {"ascii", [&] { return find_all(ascii_stream, asciis); }},
                          {"sscanf", [&] { return scan_all(ascii_stream, 47); }},
                          {"encode binary", [&] { return encode_all(records, binary); }},
                          {"encode ascii", [&] { return encode_all(records, ascii); }},
                          {"snprintf", [&] { return print_all(records); }}},
                         31);
  const double minute = bench::interleaved({{"stream", stream_a_minute}}, 3)[0];

  constexpr double ns = 1e9 / kRecords;
  constexpr double kGoal = 1000.0;  // ns: a million records a second
  const char* goal = "goal, 1e6 records/s";
  std::vector<bench::Row> rows = {
      {"decode binary, 35 bytes", "ns/record", s[0] * ns, goal, kGoal},
      {"decode binary, noise at every 5th", "ns/record", s[1] * ns, goal, kGoal},
      {"decode ASCII, 47 bytes", "ns/record", s[2] * ns, goal, kGoal},
      {"decode ASCII, 47 bytes", "ns/record", s[2] * ns, "sscanf", s[3] * ns},
      {"encode binary, 35 bytes", "ns/record", s[4] * ns, goal, kGoal},
      {"encode ASCII, 47 bytes", "ns/record", s[5] * ns, "snprintf", s[6] * ns},
      {"unit and driver, 4 receivers, 1 minute", "s", minute, "real time", 60.0}};
  const Folder folder;
  for (const auto& more : {logs(folder), live(folder)}) {
    rows.insert(rows.end(), more.begin(), more.end());
  }
  std::printf("MB/s: more is better, so a ratio below 1 is in our favour; else less is\n");
  bench::publish("devices", rows);
}
