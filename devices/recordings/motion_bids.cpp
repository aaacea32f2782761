// Motion-BIDS: numbers in ..._motion.tsv, their meanings in ..._channels.tsv.

#include "devices/recordings/motion_bids.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "devices/recordings/column_names.h"
#include "devices/recordings/missing_values.h"
#include "devices/recordings/reading.h"
#include "devices/recordings/text_table.h"

namespace headpin::devices {
namespace {

/// Columns of one tracked point: x, y, z, then the quaternion's w, x, y, z, or three angles.
struct Point {
  std::array<std::optional<std::size_t>, 7> column;
  std::array<std::optional<std::size_t>, 3> angle;  ///< about x, y, z
  double unit_m = 1.0, unit_rad = 1.0;
  std::string frame = {};  ///< name of the reference frame; empty if no channel names one
  bool turns = true;       ///< its rotation is read

  bool whole() const {
    const auto all = [](auto begin, auto end) {
      return std::all_of(begin, end, [](const auto& c) { return c.has_value(); });
    };
    const auto quaternion = column.begin() + 3;
    return all(column.begin(), quaternion) &&
           (!turns || all(quaternion, column.end()) || all(angle.begin(), angle.end()));
  }
  bool has_quaternion() const { return turns && column[3].has_value(); }
  bool has_angles() const { return turns && angle[0].has_value(); }
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

double radians_of(std::string_view name, const TextTable& table) {
  if (name == "rad") return 1.0;
  if (name == "deg" || name == "degrees") return std::numbers::pi / 180.0;
  table.fail(fmt::format("units of an angle: expected deg or rad, found '{}'", name));
}

/// Takes the reference frame that a channel of a point names, if it does.
void take_frame(const TextTable& table, const std::string& name, Point& point) {
  const std::size_t column = table.column("reference_frame");
  if (column == table.names().size()) return;
  const std::string frame(table.text(column));
  if (frame.empty() || frame == "n/a") return;
  if (!point.frame.empty() && point.frame != frame) {
    table.fail(fmt::format(
        "reference_frame of tracked point {}: expected one for its POS and ORNT channels, found "
        "'{}' and '{}'",
        name, point.frame, frame));
  }
  point.frame = frame;
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
    take_frame(table, name, point->second);
    const auto place = std::ranges::find(kPlace, component);
    const auto quat = std::ranges::find(kQuat, component);
    if (type == "POS" && place != kPlace.end()) {
      point->second.column[static_cast<std::size_t>(place - kPlace.begin())] = index;
      point->second.unit_m = unit_of(table.text(at[4]), table);
    } else if (type == "ORNT" && quat != kQuat.end()) {
      point->second.column[3 + static_cast<std::size_t>(quat - kQuat.begin())] = index;
    } else if (type == "ORNT" && place != kPlace.end()) {
      point->second.angle[static_cast<std::size_t>(place - kPlace.begin())] = index;
      point->second.unit_rad = radians_of(table.text(at[4]), table);
    } else {
      table.fail(fmt::format("component '{}' of type {}: expected x, y, z{}", component, type,
                             type == "ORNT" ? ", or quat_x, quat_y, quat_z, quat_w" : ""));
    }
  }
  return columns;
}

/// A level of reference_frame: what it says of axes and rotations.
BidsFrame frame_of_level(const std::string& name, const nlohmann::json& level) {
  const auto said = [&](const char* key) {
    const bool there = level.is_object() && level.contains(key) && level[key].is_string();
    return there ? level[key].get<std::string>() : "";
  };
  BidsFrame frame{
      .name = name, .axes = said("SpatialAxes"), .rotation_order = said("RotationOrder")};
  const std::string rule = said("RotationRule");
  if (rule == "left-hand") frame.left_handed = true;
  if (rule == "right-hand") frame.left_handed = false;
  return frame;
}

std::vector<BidsFrame> frames_of_levels(std::string_view text) {
  const nlohmann::json channels = nlohmann::json::parse(text, nullptr, false);
  std::vector<BidsFrame> frames;
  if (!channels.is_object() || !channels.contains("reference_frame")) return frames;
  const nlohmann::json& frame = channels["reference_frame"];
  if (!frame.is_object() || !frame.contains("Levels") || !frame["Levels"].is_object())
    return frames;
  for (const auto& [name, level] : frame["Levels"].items())
    frames.push_back(frame_of_level(name, level));
  return frames;
}

bool same_meaning(const BidsFrame& a, const BidsFrame& b) {
  return a.axes == b.axes && a.rotation_order == b.rotation_order && a.left_handed == b.left_handed;
}

/// Rotations about the frame's fixed axes, one after the other.
class EulerOrder {
 public:
  EulerOrder(const BidsFrame& frame, std::string_view where) : sign_(sign_of(frame, where)) {
    std::string sorted = frame.rotation_order;
    std::ranges::sort(sorted);
    if (sorted != "XYZ") {
      throw std::invalid_argument(fmt::format(
          "{}: orientations are angles: expected RotationOrder in ..._channels.json, such as ZXY, "
          "found '{}'",
          where, frame.rotation_order.substr(0, 20)));
    }
    for (std::size_t i = 0; i < 3; ++i)
      axis_[i] = static_cast<std::size_t>(frame.rotation_order[i] - 'X');
  }

  /// @param angles  about x, y and z [rad]
  Quat operator()(const Vec3& angles) const {
    Quat q = Quat::Identity();
    for (const std::size_t axis : axis_) {
      const auto i = static_cast<Eigen::Index>(axis);
      q = rotation(sign_ * angles[i] * Vec3::Unit(i)) * q;
    }
    return q.normalized();
  }

 private:
  /// In the coordinates of left-handed axes a plain rotation already is one by the left hand; Axes
  /// mirrors it. So a rule reverses angles only where it is not of the axes' hand.
  static double sign_of(const BidsFrame& frame, std::string_view where) {
    const Axes axes(frame.turning.empty() ? frame.axes : frame.turning, where);
    return frame.left_handed.value_or(axes.left_handed()) == axes.left_handed() ? 1.0 : -1.0;
  }

  double sign_;
  std::array<std::size_t, 3> axis_{};
};

/// Reads the rows of a ..._motion.tsv.
class Rows {
 public:
  Rows(std::string_view motion, const Columns& columns, std::string_view where,
       const BidsFrame& frame)
      : table_(motion, where, '\t'),
        where_(where),
        columns_(columns),
        turned_(frame.axes, where),
        frame_(frame),
        missing_(frame.missing) {
    table_.set_names(columns.names);
    for (const auto& [name, point] : columns.points) {
      if (point.has_angles() && !point.has_quaternion() && !order_) order_.emplace(frame, where);
      read_.tracks.push_back({name, {}});
    }
    unturned_.resize(columns.points.size());
  }

  MotionTracks read() {
    read_.reading = {.axes = frame_.axes, .turning = frame_.axes};
    for (const auto& [name, point] : columns_.points) {
      read_.reading.unit_m = point.unit_m;
      if (point.has_quaternion()) read_.reading.quaternion = "wxyz";
    }
    std::int64_t row = 0;
    for (; table_.next(); ++row) {
      const std::optional<double> time =
          columns_.latency ? latency() : static_cast<double>(row) / frame_.rate_hz;
      if (time && !columns_.latency) table_.require_time("time by SamplingFrequency", *time);
      for (std::size_t i = 0; i < read_.tracks.size(); ++i) take(i, time);
    }
    tell_unturned(row);
    const auto note = [&](std::int64_t count, std::string_view what) {
      if (count > 0) read_.notes.push_back(fmt::format("{} samples {}: left out", count, what));
    };
    note(unknown_, fmt::format("are {0}, or have {0} in them", missing_.words()));
    note(again_, "are at the time of the one before");
    if (!columns_.latency && !frame_.rate_from.empty()) {
      read_.notes.push_back(fmt::format("no LATENCY channel: {:.6g} rows a second, as {} says",
                                        frame_.rate_hz, frame_.rate_from));
    }
    if (!frame_.others.empty()) {
      read_.notes.push_back(fmt::format("{} {} not in the reference frame '{}': left out",
                                        fmt::join(frame_.others, ", "),
                                        frame_.others.size() == 1 ? "is" : "are", frame_.name));
    }
    return std::move(read_);
  }

 private:
  /// The time of the row; nothing if it is not known.
  std::optional<double> latency() {
    if (missing_.is_but_for_zero(table_.text(*columns_.latency))) return std::nullopt;
    const double time = table_.number(*columns_.latency);
    if (missing_.is_time(time, latest_)) return std::nullopt;
    table_.require_time("LATENCY", time);
    latest_ = time;
    return time;
  }

  /// The three numbers of a place, or three angles; nothing if one of them is not known.
  std::optional<Vec3> three(std::span<const std::optional<std::size_t>, 3> columns) const {
    Vec3 all;
    for (std::size_t i = 0; i < 3; ++i) {
      if (missing_.is(table_.text(*columns[i]))) return std::nullopt;
      all[static_cast<Eigen::Index>(i)] = table_.number(*columns[i]);
    }
    return all;
  }

  /// The same of a quaternion.
  std::optional<Quat> quaternion(std::span<const std::optional<std::size_t>, 4> columns) const {
    std::array<double, 4> q{};
    for (std::size_t i = 0; i < q.size(); ++i) {
      if (missing_.is_but_for_zero(table_.text(*columns[i]))) return std::nullopt;
      q[i] = table_.number(*columns[i]);
    }
    if (missing_.is_part_of(q)) return std::nullopt;
    return Quat(q[0], q[1], q[2], q[3]);
  }

  std::optional<Pose> pose_of(std::size_t i) const {
    const Point& point = columns_.points[i].second;
    const std::optional<Vec3> p = three(std::span(point.column).first<3>());
    if (!p) return std::nullopt;
    Pose pose{Quat::Identity(), point.unit_m * *p};
    if (point.has_quaternion()) {
      const std::optional<Quat> q = quaternion(std::span(point.column).last<4>());
      if (!q) return std::nullopt;
      pose.q = *q;
    } else if (point.has_angles()) {
      const std::optional<Vec3> angles = three(std::span(point.angle));
      if (!angles) return std::nullopt;
      pose.q = (*order_)(point.unit_rad * *angles);
    }
    return pose;
  }

  /// Notes the samples without a rotation; refuses a point of which most are.
  void tell_unturned(std::int64_t rows) {
    for (std::size_t i = 0; i < unturned_.size(); ++i) {
      const auto& [count, line, length] = unturned_[i];
      if (count == 0) continue;
      const std::string& name = read_.tracks[i].first;
      if (2 * count > rows) {
        throw std::invalid_argument(fmt::format(
            "{}:{}: {}: expected a unit quaternion, found one of length {:.6g}; {} of {} rows have "
            "none",
            where_, line, name, length, count, rows));
      }
      read_.notes.push_back(
          fmt::format("{} samples of {} have no unit quaternion (the first, in line {}, one of "
                      "length {:.6g}): left out",
                      count, name, line, length));
    }
  }

  void take(std::size_t i, std::optional<double> time) {
    const std::optional<Pose> pose = time ? pose_of(i) : std::nullopt;
    if (!pose) {
      ++unknown_;
      return;
    }
    if (const double length = pose->q.norm(); !(std::abs(length - 1.0) < kUnitLength)) {
      Unturned& its = unturned_[i];
      if (its.count++ == 0) its = {.count = 1, .line = table_.line(), .length = length};
      return;
    }
    PoseTrack& track = read_.tracks[i].second;
    if (track.push(microseconds(*time), turned_.ours(*pose))) return;
    if (microseconds(*time) < track.samples().back().time) {
      table_.fail(fmt::format("LATENCY: time must advance, found {:.6g} s after {:.6g} s", *time,
                              seconds(track.samples().back().time)));
    }
    ++again_;
  }

  /// Samples of a point without a unit quaternion: how many, and the first of them.
  struct Unturned {
    std::int64_t count = 0;
    std::size_t line = 0;
    double length = 0.0;
  };

  TextTable table_;
  std::string_view where_;
  const Columns& columns_;
  Axes turned_;
  const BidsFrame& frame_;
  MissingValues missing_;
  std::optional<EulerOrder> order_;
  MotionTracks read_;
  std::int64_t unknown_ = 0, again_ = 0;  ///< samples that are left out
  std::vector<Unturned> unturned_;        ///< of each point
  std::optional<double> latest_;          ///< LATENCY
};

}  // namespace

namespace {

/// The only frame that is described, where no channel names one.
BidsFrame only_frame(const std::vector<BidsFrame>& described, std::string_view where) {
  if (described.empty()) return {};
  for (const BidsFrame& other : described) {
    if (same_meaning(other, described.front())) continue;
    throw std::invalid_argument(fmt::format(
        "{}: ..._channels.json describes the reference frames '{}' and '{}', which differ: "
        "expected a column reference_frame in ..._channels.tsv that says which one it is",
        where, described.front().name, other.name));
  }
  return described.front();
}

/// Whether a point without a whole place and rotation is one that a recording needs: one that the user
/// names; else a head or a hand, where no other point is one.
bool is_needed(const std::string& name, const Columns& columns,
               const std::array<std::string, 3>& names) {
  const auto is_told = [&](const std::string& told) {
    return !told.empty() && (name == told || name.ends_with(":" + told));
  };
  if (std::ranges::any_of(names, [](const std::string& told) { return !told.empty(); })) {
    return std::ranges::any_of(names, is_told);
  }
  const std::optional<std::size_t> part = part_of_name(name);
  if (!part) return false;
  return std::ranges::none_of(columns.points, [&](const auto& other) {
    const std::optional<std::size_t> its = part_of_name(other.first);
    return other.second.whole() && its && (*its == 0) == (*part == 0);
  });
}

/// Leaves out the points without a whole place and rotation. @return notes of them
/// @throws std::invalid_argument  for one that is needed
std::vector<std::string> leave_out_parts(Columns& columns, std::string_view where,
                                         const std::array<std::string, 3>& names) {
  std::vector<std::string> notes;
  for (const auto& [name, point] : columns.points) {
    if (point.whole()) continue;
    const std::string expected = fmt::format(
        "tracked point {}: expected x, y, z and a whole quaternion, or three angles", name);
    if (is_needed(name, columns, names)) {
      throw std::invalid_argument(fmt::format("{}: {}", where, expected));
    }
    notes.push_back(expected + ": left out");
  }
  std::erase_if(columns.points, [](const auto& point) { return !point.second.whole(); });
  return notes;
}

}  // namespace

BidsFrame bids_frame(std::string_view channels, std::string_view levels, std::string_view where,
                     const std::string& axes) {
  const Columns columns = read_columns(channels, where);
  const bool angles = std::ranges::any_of(
      columns.points, [](const auto& point) { return point.second.has_angles(); });
  std::vector<BidsFrame> described = frames_of_levels(levels);
  for (BidsFrame& frame : described) {
    if (!axes.empty()) frame.axes = axes;
    if (angles) continue;
    frame.rotation_order.clear();  // quaternions have none
    frame.left_handed.reset();
  }
  const auto names_frame = [](const auto& point) { return !point.second.frame.empty(); };
  if (std::ranges::none_of(columns.points, names_frame)) {
    BidsFrame frame = only_frame(described, where);
    if (!axes.empty()) frame.axes = axes;
    return frame;
  }
  std::vector<BidsFrame> frames;  // of different meaning, each with the points that are in it
  std::vector<std::vector<std::string>> points_in;
  for (const auto& entry : columns.points) {
    const std::string &point = entry.first, &name = entry.second.frame;
    if (name.empty()) continue;
    const auto level = std::ranges::find(described, name, &BidsFrame::name);
    const BidsFrame its = level == described.end() ? BidsFrame{.name = name, .axes = axes} : *level;
    const auto known = std::ranges::find_if(
        frames, [&](const BidsFrame& one) { return one.name == name || same_meaning(one, its); });
    if (known == frames.end()) {
      frames.push_back(its);
      points_in.push_back({point});
    } else {
      points_in[static_cast<std::size_t>(known - frames.begin())].push_back(point);
    }
  }
  const auto largest = std::ranges::max_element(points_in, {}, &std::vector<std::string>::size);
  const auto most = static_cast<std::size_t>(largest - points_in.begin());
  BidsFrame frame = frames[most];
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (i == most) continue;
    if (points_in[i].size() == largest->size()) {
      throw std::invalid_argument(fmt::format(
          "{}: expected most tracked points in reference frames with the same axes and rotations, "
          "found {} in '{}' and {} in '{}'",
          where, largest->front(), frame.name, points_in[i].front(), frames[i].name));
    }
    frame.others.insert(frame.others.end(), points_in[i].begin(), points_in[i].end());
  }
  return frame;
}

MotionTracks parse_motion_bids(std::string_view motion, std::string_view channels,
                               std::string_view where, const BidsFrame& frame,
                               const std::array<std::string, 3>& names, bool turns) {
  Columns columns = read_columns(channels, where);
  for (auto& [name, point] : columns.points) point.turns = turns;
  std::erase_if(columns.points, [&](const auto& point) {
    return std::ranges::find(frame.others, point.first) != frame.others.end();
  });
  const std::vector<std::string> notes = leave_out_parts(columns, where, names);
  Rows rows(motion, columns, where, frame);
  if (!columns.latency && !(frame.rate_hz > 0.0 && frame.rate_hz < 1e6)) {
    throw std::invalid_argument(
        fmt::format("{}: no times: expected a LATENCY channel, or SamplingFrequency", where));
  }
  MotionTracks read = rows.read();
  read.notes.insert(read.notes.end(), notes.begin(), notes.end());
  return read;
}

}  // namespace headpin::devices
