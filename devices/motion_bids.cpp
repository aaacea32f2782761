// Motion-BIDS: numbers in ..._motion.tsv, what they are in ..._channels.tsv.

#include <map>
#include <stdexcept>

#include <fmt/format.h>

#include "devices/motion_axes.h"
#include "devices/motion_files.h"
#include "devices/text_table.h"

namespace headpin::devices {
namespace {

/// Of one tracked point: x, y, z, then the quaternion's w, x, y, z.
struct Point {
  std::array<std::optional<std::size_t>, 7> column;
  double unit_m = 1.0;
};

struct Columns {
  std::vector<std::string> names;
  std::vector<std::pair<std::string, Point>> points;
  std::optional<std::size_t> latency;
};

double unit_of(std::string_view name, const TextTable& table) {
  if (name == "m") return 1.0;
  if (name == "cm") return 0.01;
  if (name == "mm") return 0.001;
  table.fail(fmt::format("units of a position: expected m, cm or mm, found '{}'", name));
}

Columns read_columns(std::string_view text, std::string_view where) {
  const std::string channels = fmt::format("channels of {}", where);
  TextTable table(text, channels, '\t');
  table.read_names();
  std::array<std::size_t, 5> at{};
  constexpr std::array kNeeded = {"name", "component", "type", "tracked_point", "units"};
  for (std::size_t i = 0; i < at.size(); ++i) {
    at[i] = table.column(kNeeded[i]);
    if (at[i] == table.names().size()) table.fail(fmt::format("column {} is missing", kNeeded[i]));
  }
  constexpr std::array<std::string_view, 4> kQuat = {"quat_w", "quat_x", "quat_y", "quat_z"};
  constexpr std::array<std::string_view, 3> kPlace = {"x", "y", "z"};
  Columns columns;
  while (table.next()) {
    const std::size_t index = columns.names.size();
    columns.names.emplace_back(table.text(at[0]));
    const std::string_view component = table.text(at[1]), type = table.text(at[2]);
    if (type == "LATENCY") columns.latency = index;
    if (type != "POS" && type != "ORNT") continue;
    const std::string name(table.text(at[3]));
    auto point = std::ranges::find(columns.points, name, &std::pair<std::string, Point>::first);
    if (point == columns.points.end()) {
      point = columns.points.insert(columns.points.end(), {name, {}});
    }
    const auto place = std::ranges::find(kPlace, component);
    const auto quat = std::ranges::find(kQuat, component);
    if (type == "POS" && place != kPlace.end()) {
      point->second.column[static_cast<std::size_t>(place - kPlace.begin())] = index;
      point->second.unit_m = unit_of(table.text(at[4]), table);
    } else if (type == "ORNT" && quat != kQuat.end()) {
      point->second.column[3 + static_cast<std::size_t>(quat - kQuat.begin())] = index;
    } else {
      table.fail(
          fmt::format("component '{}' of type {}: expected x, y, z, or quat_x, quat_y, "
                      "quat_z, quat_w",
                      component, type));
    }
  }
  return columns;
}

}  // namespace

std::vector<std::pair<std::string, PoseTrack>> parse_motion_bids(std::string_view motion,
                                                                 std::string_view channels,
                                                                 std::string_view where,
                                                                 const std::string& axes,
                                                                 double rate_hz) {
  const Columns columns = read_columns(channels, where);
  const Axes turned(axes, where);
  TextTable table(motion, where, '\t');
  table.set_names(columns.names);
  std::vector<std::pair<std::string, PoseTrack>> tracks;
  for (const auto& [name, point] : columns.points) {
    for (const auto& column : point.column) {
      if (!column) {
        throw std::invalid_argument(fmt::format(
            "{}: tracked point {}: expected x, y, z and a whole quaternion", where, name));
      }
    }
    tracks.push_back({name, {}});
  }
  if (!columns.latency && !(rate_hz > 0.0 && rate_hz < 1e6)) {
    throw std::invalid_argument(
        fmt::format("{}: no times: expected a LATENCY channel, or SamplingFrequency", where));
  }
  for (std::int64_t row = 0; table.next(); ++row) {
    const double time =
        columns.latency ? table.number(*columns.latency) : static_cast<double>(row) / rate_hz;
    if (std::abs(time) > 1e9) table.fail(fmt::format("LATENCY: {} is out of range", time));
    for (std::size_t i = 0; i < tracks.size(); ++i) {
      const Point& point = columns.points[i].second;
      const auto value = [&](std::size_t k) { return table.number(*point.column[k]); };
      const Pose pose{Quat(value(3), value(4), value(5), value(6)),
                      point.unit_m * Vec3(value(0), value(1), value(2))};
      if (!(std::abs(pose.q.norm() - 1.0) < 1e-3)) {
        table.fail(fmt::format("{}: expected a unit quaternion, found one of length {:.6g}",
                               tracks[i].first, pose.q.norm()));
      }
      if (!tracks[i].second.push(microseconds(time), turned.ours(pose))) {
        table.fail(fmt::format("LATENCY: time must advance, found {:.6g} s", time));
      }
    }
  }
  return tracks;
}

}  // namespace headpin::devices
