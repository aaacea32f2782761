#include "devices/catalogue_csv.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace headpin::devices {
namespace {

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r";
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

/// Takes what stands before `separator` off the front of `text`.
std::string_view take(std::string_view& text, char separator) {
  const std::size_t end = text.find(separator);
  const std::string_view front = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  return front;
}

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> fields;
  do fields.push_back(trimmed(take(line, ',')));
  while (!line.empty());
  return fields;
}

constexpr const char* kTimeColumn = "delta_time_ms";
constexpr std::array<const char*, 3> kTracked = {"head", "left_hand", "right_hand"};
constexpr std::array<const char*, 7> kPoseColumns = {"pos_x", "pos_y", "pos_z", "rot_w",
                                                     "rot_x", "rot_y", "rot_z"};

std::string pose_column(const std::string& tracked, std::size_t i) {
  return tracked + "_" + kPoseColumns[i];
}

/// The file at hand: its column names, and the fields of one line.
class Table {
 public:
  /// @throws std::invalid_argument  naming every column of the catalogue that is not there
  Table(std::string_view where, std::string_view header) : where_(where), names_(split(header)) {
    std::vector<std::string> missing;
    for (const std::string& name : catalogue_columns()) {
      if (column(name) == names_.size()) missing.push_back(name);
    }
    if (missing.empty()) return;
    throw std::invalid_argument(
        fmt::format("{}:1: expected the {} columns of the catalogue, {} missing: {}", where_,
                    catalogue_columns().size(),
                    missing.size() == 1 ? "one is" : fmt::format("{} are", missing.size()),
                    fmt::join(missing, ", ")));
  }

  std::size_t column(const std::string& name) const {
    return static_cast<std::size_t>(std::ranges::find(names_, name) - names_.begin());
  }

  void read(std::string_view line, std::size_t number) {
    fields_ = split(line);
    line_ = number;
    if (fields_.size() != names_.size()) {
      fail(fmt::format("expected {} fields, found {}", names_.size(), fields_.size()));
    }
  }

  double value(std::size_t column) const {
    const std::string_view field = fields_[column];
    double number = 0.0;
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), number);
    if (error != std::errc{} || end != field.data() + field.size() || !std::isfinite(number)) {
      fail(fmt::format("{}: expected a finite number, found '{}'", names_[column],
                       field.substr(0, 40)));
    }
    return number;
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw std::invalid_argument(fmt::format("{}:{}: {}", where_, line_, what));
  }

 private:
  std::string_view where_;
  std::vector<std::string_view> names_;
  std::vector<std::string_view> fields_;
  std::size_t line_ = 1;
};

/// The seven columns of one tracked thing.
struct PoseColumns {
  std::string name;
  std::array<std::size_t, 7> columns;

  PoseColumns(const Table& table, const std::string& of) : name(of) {
    for (std::size_t i = 0; i < columns.size(); ++i) columns[i] = table.column(pose_column(of, i));
  }

  Pose read(const Table& table, double unit_m) const {
    const auto value = [&](std::size_t i) { return table.value(columns[i]); };
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
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  Table table(where, take(text, '\n'));
  const std::size_t time_ms = table.column(kTimeColumn);
  const PoseColumns head(table, kTracked[0]), left(table, kTracked[1]), right(table, kTracked[2]);

  MotionRecording recording;
  for (std::size_t line = 2; !text.empty(); ++line) {
    const std::string_view row = trimmed(take(text, '\n'));
    if (row.empty()) continue;
    table.read(row, line);
    const double ms = table.value(time_ms);
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
