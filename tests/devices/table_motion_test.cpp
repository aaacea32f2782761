// What the columns of a table are taken for, where several readings are possible.

#include "devices/recordings/table_motion.h"

#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/recordings/motion_files.h"

namespace headpin::devices {
namespace {

using testing::Contains;
using testing::Not;

constexpr double kQuarterTurn = 1.5707963267948966;

/// A table of forty rows at 100 Hz; `cells` are those of a row.
std::string rows(const std::string& header, const std::function<std::string(int)>& cells) {
  std::string text = header + "\n";
  for (int i = 0; i < 40; ++i) text += cells(i) + "\n";
  return text;
}

/// The track of a head or hand; empty if there is none.
std::vector<Stamped<Pose>> track_of(const MotionTracks& read, const std::string& name) {
  for (const auto& [its, track] : read.tracks) {
    if (its == name) return track.samples();
  }
  return {};
}

/// By how much a pose is turned [rad].
double turn_of(const Pose& pose) {
  return pose.q.angularDistance(Quat::Identity());
}

const std::string kAngles =
    "time,head_x,head_y,head_z,head_rx,head_ry,head_rz,"
    "right_x,right_y,right_z,right_rx,right_ry,right_rz";

// A hand that rested within a few degrees was read in radians beside a head in degrees.
TEST(TableAngles, OfAllPartsAreInTheSameUnit) {
  const std::string text = rows(
      kAngles, [](int i) { return fmt::format("{:.2f},0,1.6,0,0,90,0,0.2,1,0,3,0,0", 0.01 * i); });
  const MotionTracks read = parse_motion_table(text, "t.csv", {});
  ASSERT_EQ(track_of(read, "right hand").size(), 40u);
  EXPECT_NEAR(turn_of(track_of(read, "head")[0].value), kQuarterTurn, 1e-12);
  EXPECT_NEAR(turn_of(track_of(read, "right hand")[0].value), kQuarterTurn / 30.0, 1e-12);
  EXPECT_THAT(read.notes, Contains("rotations are angles: read as YXZ in degrees"));
  EXPECT_THAT(read.notes, Not(Contains("rotations are angles: read as YXZ in radians")));
}

TEST(TableAngles, OfAPartWithAUnitAreInThatUnit) {
  const std::string text = rows(
      "time,head_x,head_y,head_z,head_rx (deg),head_ry (deg),head_rz (deg),"
      "right_x,right_y,right_z,right_rx (rad),right_ry (rad),right_rz (rad)",
      [](int i) { return fmt::format("{:.2f},0,1.6,0,0,90,0,0.2,1,0,0.5,0,0", 0.01 * i); });
  const MotionTracks read = parse_motion_table(text, "t.csv", {});
  ASSERT_EQ(track_of(read, "right hand").size(), 40u);
  EXPECT_NEAR(turn_of(track_of(read, "head")[0].value), kQuarterTurn, 1e-12);
  EXPECT_NEAR(turn_of(track_of(read, "right hand")[0].value), 0.5, 1e-12);
}

}  // namespace
}  // namespace headpin::devices
