// What the columns of a table are taken for, where several readings are possible.

#include "devices/recordings/table_motion.h"

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
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
  EXPECT_EQ(
      refused(once_more(0.002)),
      "t.csv:42: the time starts again, at 0.002 s after 0.780 s (two recordings in one file, or "
      "a clock that was set back): expected one recording, or its rows in order of time");
  EXPECT_EQ(refused(once_more(0.8)), "");

  // The rows of one object may stand below those of another, but not twice.
  const std::string header = "object,time,x,y,z,qw,qx,qy,qz\n";
  const auto both = [](double height) {
    std::string text;
    for (const char* object : {"head", "right"}) {
      for (int i = 0; i < 40; ++i)
        text += fmt::format("{},{:.2f},0,{},0,1,0,0,0\n", object, 0.02 * i, height);
    }
    return text;
  };
  EXPECT_EQ(refused(header + both(1.6)), "");
  EXPECT_THAT(refused(header + both(1.6) + both(1.5)),
              testing::StartsWith("t.csv:82: the time starts again"));

  // A few rows that are late are put in order.
  const MotionTracks late =
      parse_motion_table(rows("time," + kPoses,
                              [&](int i) {
                                return at(i == 18 ? 0.005 : i == 19 ? 0.015 : 0.04 * i);
                              }),
                         "t.csv", {});
  EXPECT_EQ(track_of(late, "head").size(), 40u);
  EXPECT_THAT(late.notes,
              Contains("1 rows are earlier than the row before (the furthest by 0.675 s, at line "
                       "20): put in order"));
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

/// A table of rows at these times, in this order; the hand is as far to the right as the time says.
std::string at_times(const std::vector<double>& times_s) {
  std::string text = "time_s," + kPoses + "\n";
  for (const double t : times_s)
    text += fmt::format("{:.3f},0,1.6,0,1,0,0,0,{:.3f},1,0,1,0,0,0\n", t, t);
  return text;
}

/// Times at 50 Hz from a moment on.
std::vector<double> times_from(double begin_s, int rows) {
  std::vector<double> times;
  for (int i = 0; i < rows; ++i) times.push_back(begin_s + 0.02 * i);
  return times;
}

std::vector<double> joined(std::vector<double> first, const std::vector<double>& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

/// The hand's samples; none, with a failure of the test, for a table that is refused.
std::vector<Stamped<Pose>> hand_in(const std::string& text) {
  try {
    return track_of(parse_motion_table(text, "t.csv", {}), "right hand");
  } catch (const std::invalid_argument& error) {
    ADD_FAILURE() << error.what();
    return {};
  }
}

// Rows that a spreadsheet sorted by their text, blocks that changed places and one wrong time were taken for a
// second recording.
TEST(TableTime, OfRowsInAnotherOrderIsThatOfOneRecording) {
  const std::vector<double> all = times_from(8.0, 200);  // from 8 to 12 s
  const auto in_order = hand_in(at_times(all));
  ASSERT_EQ(in_order.size(), 200u);
  const auto part = [&](std::ptrdiff_t from, std::ptrdiff_t to) {
    return std::vector<double>(all.begin() + from, all.begin() + to);
  };
  const auto expect_same = [&](const std::string& text, const char* what) {
    const auto samples = hand_in(text);
    ASSERT_EQ(samples.size(), in_order.size()) << what;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      EXPECT_EQ(samples[i].time, in_order[i].time) << what;
      EXPECT_NEAR(samples[i].value.p.x(), seconds(samples[i].time), 1e-9) << what;
    }
  };
  expect_same(at_times(joined(part(100, 200), part(0, 100))), "sorted by text: 10 before 8");
  expect_same(at_times(joined(part(0, 60), joined(part(130, 200), part(60, 130)))), "blocks");
  expect_same(at_times({all.rbegin(), all.rend()}), "the newest row first");
  expect_same(at_times(all) + at_times(part(50, 120)).substr(at_times({}).size()),
              "rows that were written once more");

  std::vector<double> arrived, late;  // every seventh row at the end
  for (std::size_t i = 0; i < all.size(); ++i) (i % 7 == 3 ? late : arrived).push_back(all[i]);
  expect_same(at_times(joined(arrived, late)), "rows that were sent once more");

  std::vector<double> stray = all;
  for (std::size_t i = 2; i < 5; ++i) stray[i] += 0.61;
  EXPECT_EQ(hand_in(at_times(stray)).size(), 200u);
}

// Rows of one device may stand below all those of another, without a column that names it.
TEST(TableTime, OfEachPartIsThatOfTheRowsWithItsSamples) {
  std::string text = "time_s," + kPoses + "\n";
  for (const double t : times_from(0.0, 60))
    text += fmt::format("{:.3f},0,1.6,0,1,0,0,0,,,,,,,\n", t);
  for (const double t : times_from(0.0, 60))
    text += fmt::format("{:.3f},,,,,,,,0.2,1,0,1,0,0,0\n", t);
  EXPECT_EQ(hand_in(text).size(), 60u);
}

// A short second recording, and one that begins before the first one, were sorted into it.
TEST(TableTime, ThatComesBackToRowsAboveIsASecondRecording) {
  const auto refused = [](const std::vector<double>& times_s) -> std::string {
    try {
      parse_motion_table(at_times(times_s), "t.csv", {});
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  const std::vector<double> first = times_from(5.0, 200);
  for (const double begin_s : {5.005, 6.005, 4.505}) {
    EXPECT_THAT(refused(joined(first, times_from(begin_s, 200))),
                testing::StartsWith(fmt::format(
                    "t.csv:202: the time starts again, at {:.3f} s after 8.980 s", begin_s)));
  }
  EXPECT_THAT(refused(joined(first, times_from(7.005, 10))), testing::StartsWith("t.csv:202:"));
  EXPECT_EQ(refused(joined(first, times_from(7.005, 4))), "");
}

// A table was refused for a time that starts again at each cue, though it has the clock beside it.
TEST(TableTime, ThatStartsAgainIsPassedOverForAnotherThatGoesOn) {
  const auto table = [](const char* clock, int from) {
    return rows(fmt::format("trial_time_s,{},{}", clock, kPoses), [&](int i) {
      const int of_trial = i < 25 ? i : i - 25;
      return fmt::format("{:.2f},{:.3f},{}", 0.04 * of_trial,
                         100.0 + (i < from ? 0.04 * i : 0.04 * of_trial + 0.001), kPose);
    });
  };
  const MotionTracks read = parse_motion_table(table("unix_time_s", 40), "t.csv", {});
  ASSERT_EQ(track_of(read, "head").size(), 40u);
  EXPECT_EQ(track_of(read, "head").front().time, Time{100'000'000});
  EXPECT_EQ(track_of(read, "head").back().time, Time{101'560'000});
  EXPECT_THAT(read.notes,
              Contains("the time 'trial_time_s' starts again: 'unix_time_s' is read instead"));
  const ToldColumns found = inspect_table(table("unix_time_s", 40), "t.csv", {}).mapping;
  EXPECT_EQ(found.at(0).column, "unix_time_s");

  const auto refused = [](const std::string& text, const MotionOptions& options) -> std::string {
    try {
      parse_motion_table(text, "t.csv", options);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  const std::string others = "in order of time; other columns of a time: unix_time_s";
  EXPECT_THAT(refused(table("unix_time_s", 40), {.columns = {{"time", "trial_time_s"}}}),
              testing::EndsWith(others));
  EXPECT_THAT(refused(table("unix_time_s", 25), {}), testing::EndsWith(others));
  EXPECT_THAT(refused(table("remark", 40), {}), testing::EndsWith("in order of time"));
}

// One row with a wrong time was taken for a second recording; among others its pose would be a jump.
TEST(TableTime, OfOneRowThatIsFarFromThoseAroundItIsLeftOut) {
  const std::vector<double> all = times_from(8.0, 200);
  for (const double by_s : {0.61, -0.61, 99.0}) {
    std::vector<double> times = all;
    times[50] += by_s;
    times[120] += by_s;
    const MotionTracks read = parse_motion_table(at_times(times), "t.csv", {});
    EXPECT_THAT(read.notes, Contains("2 rows have a time far from those around them: ignored"));
    const auto samples = track_of(read, "right hand");
    ASSERT_EQ(samples.size(), 198u);
    EXPECT_EQ(samples[49].time, Time{8'980'000});
    EXPECT_EQ(samples[50].time, Time{9'020'000});
  }
}

// A head without a unit beside hands in millimetres may be in metres.
TEST(TableUnits, OfAPartThatSaysNoneAreUnclearWhereAnotherSaysAnother) {
  const auto reading = [](const char* head, const char* left, const char* right,
                          MotionOptions options = {}) {
    const std::string text = rows(
        fmt::format("time,head_x{0},head_y{0},head_z{0},left_x{1},left_y{1},left_z{1},right_x{2},"
                    "right_y{2},right_z{2}",
                    head, left, right),
        [](int i) { return fmt::format("{:.2f},0,1.5,0,0,1,0,200,1000,0", 0.01 * i); });
    return parse_motion_table(text, "t.csv", options).reading;
  };
  using Parts = std::array<bool, 3>;
  const Reading head = reading("", " [mm]", " [mm]");
  EXPECT_EQ(head.without_unit, (Parts{true, false, false}));
  EXPECT_EQ(head.other_units_m, std::vector<double>{1.0});
  EXPECT_EQ(head.unit_m, 0.001);
  const Reading right = reading(" [m]", " [cm]", "");
  EXPECT_EQ(right.without_unit, (Parts{false, false, true}));
  EXPECT_EQ(right.other_units_m, std::vector<double>{0.01});
  EXPECT_EQ(reading("", "", "").without_unit, Parts{});
  EXPECT_EQ(reading(" [m]", "", " [m]").without_unit, Parts{});
  EXPECT_EQ(reading("", " [mm]", " [mm]", {.reading = {.unit_m = 0.01}}).without_unit, Parts{});
}

// With a unit of numbers, the seconds of a date became milliseconds.
TEST(TableTimes, ThatAreDatesHaveNoUnit) {
  const std::string text = rows("time," + kPoses, [](int i) {
    return fmt::format("2026-11-25T13:57:27.{:03},{}", 10 * i, kPose);
  });
  const std::vector<std::optional<double>> units = {std::nullopt, 1e-3, 1.0 / 90.0};
  for (const std::optional<double>& told : units) {
    const MotionTracks read = parse_motion_table(text, "t.csv", {.reading = {.time_unit_s = told}});
    const std::vector<Stamped<Pose>> head = track_of(read, "head");
    ASSERT_EQ(head.size(), 40u);
    EXPECT_EQ(head.back().time - head.front().time, Time{390'000});
    EXPECT_EQ(read.reading.time_unit_s, 1.0);
  }
}

// A recording that lies wholly before the first one, or a clock that was set back, can be seen in the note.
TEST(TableTime, OfRowsThatAreEarlierIsSaidByHowMuchAndWhere) {
  std::vector<double> times = joined(times_from(0.0, 100), times_from(-8.0, 60));
  std::swap(times[10], times[11]);
  EXPECT_THAT(parse_motion_table(at_times(times), "t.csv", {}).notes,
              Contains("2 rows are earlier than the row before (the furthest by 9.980 s, at line "
                       "102): put in order"));
  const std::string resting = ",0,1.6,0,1,0,0,0,0.2,1,0,1,0,0,0\n";
  std::string text = "time_s," + kPoses + "\n";
  for (const double t : joined(times_from(3600.0, 100), times_from(0.0, 60)))
    text += fmt::format("{:.3f}{}", t, resting);
  EXPECT_THAT(parse_motion_table(text, "t.csv", {}).notes,
              Contains("1 rows are earlier than the row before (the furthest by 3601.980 s, at "
                       "line 102): put in order"));
}

}  // namespace
}  // namespace headpin::devices
