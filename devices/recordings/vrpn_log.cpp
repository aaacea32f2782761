// Logs of VRPN's connections: a cookie of 24 bytes, then messages. A message has type, sender,
// seconds, microseconds, length and 0 as big-endian int32, and then as many bytes as the length
// says. Names of types and senders are also messages, of type -2 and -1; their sender is the number
// that gets the name.

#include "devices/recordings/vrpn_log.h"

#include <bit>
#include <map>
#include <stdexcept>

#include <fmt/format.h>

#include "devices/base/bytes.h"

namespace headpin::devices {
namespace {

constexpr std::size_t kCookie = 24, kHeader = 24;

std::int32_t int32_at(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::int32_t>(big_endian(bytes.subspan(at, 4)));
}

/// A name: its length, its text, and usually a NUL.
std::string name_in(std::span<const std::uint8_t> data) {
  if (data.size() < 4) return "";
  const std::size_t size = std::min<std::size_t>(big_endian(data.first(4)), data.size() - 4);
  std::string name(reinterpret_cast<const char*>(data.data()) + 4, size);
  return name.substr(0, name.find('\0'));
}

/// A report of a tracker: sensor, padding, position, quaternion x, y, z, w.
constexpr std::size_t kReport = 8 + 7 * 8;

bool is_same_pose(const Pose& a, const Pose& b) {
  return a.p == b.p && a.q.coeffs() == b.q.coeffs();
}

}  // namespace

std::vector<std::pair<std::string, PoseTrack>> parse_vrpn(std::span<const std::uint8_t> bytes,
                                                          std::string_view where, double unit_m,
                                                          std::vector<std::string>& notes,
                                                          bool turns) {
  std::map<std::int32_t, std::string> types, senders;
  std::vector<std::pair<std::string, PoseTrack>> tracks;
  std::optional<Time> first;
  std::size_t again = 0;
  const auto fail = [&](std::size_t at, const std::string& what) {
    throw std::invalid_argument(fmt::format("{}: byte {}: {}", where, at, what));
  };
  std::size_t at = kCookie;
  while (at + kHeader <= bytes.size()) {
    const std::int32_t type = int32_at(bytes, at), sender = int32_at(bytes, at + 4);
    const Time time = Time{1'000'000} * int32_at(bytes, at + 8) + Time{int32_at(bytes, at + 12)};
    const std::int32_t size = int32_at(bytes, at + 16);
    if (size < 0) fail(at, fmt::format("expected the length of a message, found {}", size));
    if (static_cast<std::size_t>(size) > bytes.size() - at - kHeader) break;
    const std::span<const std::uint8_t> data =
        bytes.subspan(at + kHeader, static_cast<std::size_t>(size));
    if (type == -1) senders[sender] = name_in(data);
    if (type == -2) types[sender] = name_in(data);
    const auto known = types.find(type);
    const bool report = known != types.end() && (known->second == "vrpn_Tracker Pos_Quat" ||
                                                 known->second == "Tracker Pos/Quat");
    if (report) {
      if (data.size() < kReport) {
        fail(at, fmt::format("expected a tracker's report of {} bytes, found {}", kReport,
                             data.size()));
      }
      std::array<double, 7> v{};
      for (std::size_t i = 0; i < v.size(); ++i) {
        v[i] = std::bit_cast<double>(big_endian(data.subspan(8 + 8 * i, 8)));
      }
      const Quat q = turns ? Quat(v[6], v[3], v[4], v[5]) : Quat::Identity();
      const Pose pose{q, unit_m * Vec3(v[0], v[1], v[2])};
      if (!pose.p.allFinite() || !(std::abs(pose.q.norm() - 1.0) < 1e-3)) {
        fail(at, "expected a finite position and a unit quaternion");
      }
      const std::string name = fmt::format("{}:{}", senders[sender], int32_at(data, 0));
      auto track = std::ranges::find(tracks, name, &std::pair<std::string, PoseTrack>::first);
      if (track == tracks.end()) {
        constexpr std::size_t kMostSensors = 1000;
        if (tracks.size() == kMostSensors) fail(at, "more than 1000 sensors");
        track = tracks.insert(tracks.end(), {name, {}});
      }
      if (!first) first = time;
      PoseTrack& poses = track->second;
      if (!poses.push(time - *first, pose)) {
        const Stamped<Pose>& last = poses.samples().back();
        if (time - *first < last.time) fail(at, fmt::format("{}: time must advance", name));
        // VRPN sometimes repeats a report; the repetition is not a new one.
        again += is_same_pose(pose, last.value) ? 0 : 1;
      }
    }
    at += kHeader + static_cast<std::size_t>(size);
  }
  if (again > 0) {
    notes.push_back(
        fmt::format("{} reports have another pose at the time of the one before: ignored", again));
  }
  if (at < bytes.size()) {  // it was not closed, or not copied whole
    notes.push_back(fmt::format("the log ends within a message: {} bytes at its end are left out",
                                bytes.size() - at));
  }
  return tracks;
}

}  // namespace headpin::devices
