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

// Angles before a quaternion of the same object were taken for three of its four columns.
TEST(TableColumns, OfAnglesBesideAQuaternionAreNotMixedWithIt) {
  const std::string text = rows(
      "time,head_x,head_y,head_z,head_rot_x,head_rot_y,head_rot_z,head_qx,head_qy,head_qz,head_qw,"
      "right_x,right_y,right_z,right_qx,right_qy,right_qz,right_qw",
      [](int i) {
        return fmt::format("{:.2f},0,1.6,0,0,-90,0,0,0.6,0,0.8,0.2,1,0,0,0,0,1", 0.01 * i);
      });
  const MotionTracks read = parse_motion_table(text, "t.csv", {});
  ASSERT_EQ(track_of(read, "head").size(), 40u);
  const Quat q = track_of(read, "head")[0].value.q;
  EXPECT_NEAR(q.y(), 0.6, 1e-12);
  EXPECT_NEAR(q.w(), 0.8, 1e-12);
}

const std::string kPoses =
    "head_x,head_y,head_z,head_qw,head_qx,head_qy,head_qz,"
    "right_x,right_y,right_z,right_qw,right_qx,right_qy,right_qz";
const std::string kPose = "0,1.6,0,1,0,0,0,0.2,1,0,1,0,0,0";

// The time since the row before was taken for the time, and most rows were not later than others.
TEST(TableColumns, OfTheTimeIsTheOneThatAdvances) {
  const auto last_of = [](const std::string& header, const std::function<std::string(int)>& cells) {
    const std::string text =
        rows(header + "," + kPoses, [&](int i) { return cells(i) + "," + kPose; });
    return track_of(parse_motion_table(text, "t.csv", {}), "head").back().time;
  };
  const auto delta = [](int i) { return i % 2 == 0 ? "0.012" : "0.008"; };
  EXPECT_EQ(last_of("delta_time,time_s",
                    [&](int i) { return fmt::format("{},{:.2f}", delta(i), 0.01 * i); }),
            Time{390'000});
  EXPECT_EQ(last_of("time_s,delta_time",
                    [&](int i) { return fmt::format("{:.2f},{}", 0.01 * i, delta(i)); }),
            Time{390'000});
  EXPECT_EQ(last_of("timestamp,elapsed_ms",  // a date to the second
                    [](int i) { return fmt::format("2026-11-25 13:57:0{},{}", i / 20, 10 * i); }),
            Time{390'000});
}

// Two recordings in one file were merged sample by sample, and the trial jumped between them.
TEST(TableTime, ThatStartsAgainIsASecondRecording) {
  const auto refused = [](const std::string& text) -> std::string {
    try {
      parse_motion_table(text, "t.csv", {});
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  const auto at = [](double time_s) { return fmt::format("{:.3f},{}", time_s, kPose); };
  const auto once_more = [&](double from_s) {
    std::string text = rows("time," + kPoses, [&](int i) { return at(0.02 * i); });
    for (int i = 0; i < 40; ++i) text += at(from_s + 0.02 * i) + "\n";
    return text;
  };
  EXPECT_EQ(refused(once_more(0.002)),
            "t.csv:42: the time starts again, at 0.002 s after 0.780 s: expected one recording");
  EXPECT_EQ(refused(once_more(0.8)), "");

  // The rows of one object may stand below those of another, but not twice.
  const std::string header = "object,time,x,y,z,qw,qx,qy,qz\n";
  std::string one;
  for (const char* object : {"head", "right"}) {
    for (int i = 0; i < 40; ++i)
      one += fmt::format("{},{:.2f},0,1.6,0,1,0,0,0\n", object, 0.02 * i);
  }
  EXPECT_EQ(refused(header + one), "");
  EXPECT_THAT(refused(header + one + one), testing::StartsWith("t.csv:82: the time starts again"));

  // A few rows that are late are put in order.
  const MotionTracks late =
      parse_motion_table(rows("time," + kPoses,
                              [&](int i) {
                                return at(i == 18 ? 0.005 : i == 19 ? 0.015 : 0.04 * i);
                              }),
                         "t.csv", {});
  EXPECT_EQ(track_of(late, "head").size(), 40u);
  EXPECT_THAT(late.notes, Contains("1 rows are earlier than the row before: put in order"));
}

TEST(TableAngles, OfPartsInTwoUnitsAreNotSaidToBeInOne) {
  const auto angles = [](const char* unit) {
    const std::string text = rows(
        fmt::format("time,head_x,head_y,head_z,head_rx (rad),head_ry (rad),head_rz (rad),right_x,"
                    "right_y,right_z,right_rx ({0}),right_ry ({0}),right_rz ({0})",
                    unit),
        [](int i) { return fmt::format("{:.2f},0,1.6,0,0,1,0,0.2,1,0,0.5,0,0", 0.01 * i); });
    return parse_motion_table(text, "t.csv", {}).reading.angles;
  };
  EXPECT_EQ(angles("rad"), "YXZ,rad");
  EXPECT_EQ(angles("deg"), "YXZ");
}

// The unit of the first column was taken for that of all.
TEST(TableUnits, AreThoseOfEachColumn) {
  const auto read = [](const std::string& head, const std::string& hand,
                       MotionOptions options = {}) {
    const std::string text =
        rows(fmt::format("time,head_x{0},head_y{0},head_z{0},right_x{1},right_y{1},right_z{1}",
                         head, hand),
             [](int i) { return fmt::format("{:.2f},0,1.5,0,200,1000,0", 0.01 * i); });
    return parse_motion_table(text, "t.csv", options);
  };
  const auto height = [](const MotionTracks& tracks, const char* name) {
    return track_of(tracks, name).at(0).value.p.y();
  };
  for (const char* unit : {" [mm]", " [millimeter]", " [millimetres]"}) {
    const MotionTracks mixed = read(" [m]", unit);
    EXPECT_DOUBLE_EQ(height(mixed, "head"), 1.5);
    EXPECT_DOUBLE_EQ(height(mixed, "right hand"), 1.0);
    EXPECT_TRUE(mixed.reading.own_units);
  }
  EXPECT_DOUBLE_EQ(height(read(" [foot]", " [centimetre]"), "head"), 1.5 * 0.3048);
  const MotionTracks alike = read(" [mm]", "");
  EXPECT_DOUBLE_EQ(height(alike, "right hand"), 1.0);
  EXPECT_FALSE(alike.reading.own_units);
  const MotionTracks told = read(" [m]", " [mm]", {.reading = {.unit_m = 0.01}});
  EXPECT_DOUBLE_EQ(height(told, "head"), 0.015);
  EXPECT_DOUBLE_EQ(height(told, "right hand"), 10.0);
  EXPECT_FALSE(told.reading.own_units);
}

TEST(TableAngles, ThatNoColumnHasAreNotTold) {
  const std::string text =
      rows("time," + kPoses, [](int i) { return fmt::format("{:.2f},{}", 0.01 * i, kPose); });
  const auto told = [&](const MotionOptions& options) -> std::string {
    try {
      parse_motion_table(text, "t.csv", options);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(told({.rotations = "YXZ"}),
            "t.csv: expected angles to read as YXZ; found other rotations, or none");
  EXPECT_EQ(told({.degrees = false}),
            "t.csv: expected angles to read as rad; found other rotations, or none");
  EXPECT_EQ(told({.rotations = "none"}), "");
}

}  // namespace
}  // namespace headpin::devices
