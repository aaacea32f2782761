// Records of the Fastrak decoded and encoded per second on one core, beside the C library as most
// of its drivers use it, and a whole simulated hour.

#include <array>
#include <cstdio>
#include <cstring>

#include "devices/fastrak.h"
#include "devices/fastrak_emulator.h"
#include "tests/bench/report.h"

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
  devices::FastrakDriver driver(std::move(host_end));
  std::vector<devices::Sample> samples;
  for (Time now{}; now < 60s; now += 1ms) {
    devices::serve(unit, *unit_end, now);
    driver.poll(now, samples);
  }
  return static_cast<double>(samples.size());
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
  bench::publish("devices",
                 {{"decode binary, 35 bytes", "ns/record", s[0] * ns, goal, kGoal},
                  {"decode binary, noise at every 5th", "ns/record", s[1] * ns, goal, kGoal},
                  {"decode ASCII, 47 bytes", "ns/record", s[2] * ns, goal, kGoal},
                  {"decode ASCII, 47 bytes", "ns/record", s[2] * ns, "sscanf", s[3] * ns},
                  {"encode binary, 35 bytes", "ns/record", s[4] * ns, goal, kGoal},
                  {"encode ASCII, 47 bytes", "ns/record", s[5] * ns, "snprintf", s[6] * ns},
                  {"unit and driver, 4 receivers, 1 minute", "s", minute, "real time", 60.0}});
}
