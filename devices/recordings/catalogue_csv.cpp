#include "devices/recordings/catalogue_csv.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "devices/recordings/text_table.h"

namespace headpin::devices {
namespace {

constexpr const char* kTimeColumn = "delta_time_ms";
constexpr std::array<const char*, 3> kTracked = {"head", "left_hand", "right_hand"};
constexpr std::array<const char*, 7> kPoseColumns = {"pos_x", "pos_y", "pos_z", "rot_w",
                                                     "rot_x", "rot_y", "rot_z"};

std::string pose_column(const std::string& tracked, std::size_t i) {
  return tracked + "_" + kPoseColumns[i];
}

/// @throws std::invalid_argument  naming every column of the catalogue that is not there
void require_columns(const TextTable& table) {
  std::vector<std::string> missing;
  for (const std::string& name : catalogue_columns()) {
    if (table.column(name) == table.names().size()) missing.push_back(name);
  }
  if (missing.empty()) return;
  table.fail(fmt::format("expected the {} columns of the catalogue, {} missing: {}",
                         catalogue_columns().size(),
                         missing.size() == 1 ? "one is" : fmt::format("{} are", missing.size()),
                         fmt::join(missing, ", ")));
}

/// The seven columns of one tracked object.
struct PoseColumns {
  std::string name;
  std::array<std::size_t, 7> columns;

  PoseColumns(const TextTable& table, const std::string& of) : name(of) {
    for (std::size_t i = 0; i < columns.size(); ++i) columns[i] = table.column(pose_column(of, i));
  }

  Pose read(const TextTable& table, double unit_m) const {
    const auto value = [&](std::size_t i) { return table.number(columns[i]); };
    const Pose pose{Quat(value(3), value(4), value(5), value(6)),
                    unit_m * Vec3(value(0), value(1), value(2))};
    if (!(std::abs(pose.q.norm() - 1.0) < 1e-3)) {
      table.fail(fmt::format("{}_rot: expected a unit quaternion, found one of length {:.6g}", name,
                             pose.q.norm()));
    }
    return pose;
  }
};

}  // namespace

std::vector<std::string> catalogue_columns() {
  std::vector<std::string> all = {kTimeColumn};
  for (const char* tracked : kTracked) {
    for (std::size_t i = 0; i < kPoseColumns.size(); ++i) all.push_back(pose_column(tracked, i));
  }
  return all;
}

std::string to_catalogue_csv(const MotionRecording& recording, double unit_m) {
  std::string text = fmt::format("{}\n", fmt::join(catalogue_columns(), ","));
  for (std::size_t i = 0; i < recording.times.size(); ++i) {
    text += fmt::format("{}", 1e3 * seconds(recording.times[i]));
    for (const auto* poses : {&recording.head, &recording.left_hand, &recording.right_hand}) {
      const Vec3 p = (*poses)[i].p / unit_m;
      const Quat& q = (*poses)[i].q;
      text += fmt::format(",{:.5f},{:.5f},{:.5f},{:.8f},{:.8f},{:.8f},{:.8f}", p.x(), p.y(), p.z(),
                          q.w(), q.x(), q.y(), q.z());
    }
    text += '\n';
  }
  return text;
}

MotionRecording parse_catalogue_csv(std::string_view text, std::string_view where, double unit_m) {
  TextTable table(text, where, ',');
  table.read_names();
  require_columns(table);
  const std::size_t time_ms = table.column(kTimeColumn);
  const PoseColumns head(table, kTracked[0]), left(table, kTracked[1]), right(table, kTracked[2]);

  MotionRecording recording;
  while (table.next()) {
    const double ms = table.number(time_ms);
    if (std::abs(ms) > 1e9) table.fail(fmt::format("delta_time_ms: {} is out of range", ms));
    const Time time = microseconds(1e-3 * ms);
    if (!recording.times.empty() && time <= recording.times.back()) {
      table.fail(fmt::format("delta_time_ms: time must advance, found {:.6g} s after {:.6g} s",
                             seconds(time), seconds(recording.times.back())));
    }
    recording.times.push_back(time);
    recording.head.push_back(head.read(table, unit_m));
    recording.left_hand.push_back(left.read(table, unit_m));
    recording.right_hand.push_back(right.read(table, unit_m));
  }
  return recording;
}

}  // namespace headpin::devices
