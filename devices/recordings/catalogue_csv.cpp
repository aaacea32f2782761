#include "devices/recordings/catalogue_csv.h"

#include <array>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace headpin::devices {
namespace {

constexpr const char* kTimeColumn = "delta_time_ms";
constexpr std::array<const char*, 3> kTracked = {"head", "left_hand", "right_hand"};
constexpr std::array<const char*, 7> kPoseColumns = {"pos_x", "pos_y", "pos_z", "rot_w",
                                                     "rot_x", "rot_y", "rot_z"};

std::string pose_column(const std::string& tracked, std::size_t i) {
  return tracked + "_" + kPoseColumns[i];
}

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

}  // namespace headpin::devices
