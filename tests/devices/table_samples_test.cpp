// The samples and findings that a foreign table is read into.

#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/recordings/motion_files.h"
#include "devices/recordings/table_motion.h"
#include "tests/support/folder.h"

namespace headpin::devices {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

const std::string kPlaces = "head_x,head_y,head_z,right_x,right_y,right_z";
const std::string kPlace = "0,1.5,0,0.2,1,0";

/// A table of rows, with the number of a row.
std::string lines_of_table(const std::string& header, int rows,
                           const std::function<std::string(int)>& line) {
  std::string text = header + "\n";
  for (int i = 0; i < rows; ++i) text += line(i) + "\n";
  return text;
}

/// A table whose parts are placed alike in each row; `more` are the columns behind them.
std::string placed(const std::string& names_of_more, const std::string& more, int rows = 10) {
  return lines_of_table("time_s," + kPlaces + names_of_more, rows,
                        [&](int i) { return fmt::format("{:.2f},{}{}", 0.01 * i, kPlace, more); });
}

MotionTracks tracks_read(const std::string& text, const MotionOptions& options = {}) {
  return parse_motion_table(text, "t.csv", options);
}

std::vector<Stamped<Pose>> samples_in(const MotionTracks& read, std::string_view name) {
  for (const auto& [its, track] : read.tracks) {
    if (its == name) return track.samples();
  }
  return {};
}

/// The first rotation of the head, as an angle [rad].
double first_turn(const MotionTracks& read) {
  return samples_in(read, "head").at(0).value.q.angularDistance(Quat::Identity());
}

const std::string kHeadAngles = ",head_rx{0},head_ry{0},head_rz{0}";

TEST(TableSamples, AreOfThePartsOfAPerson) {
  const MotionTracks read = tracks_read(placed("", ""));
  EXPECT_TRUE(read.by_part);
  EXPECT_THAT(read.without_rotation, ElementsAre("head", "right hand"));
  EXPECT_EQ(read.reading.quaternion, "");
  EXPECT_EQ(read.reading.angles, "");
  EXPECT_EQ(samples_in(read, "head").size(), 10u);
  EXPECT_TRUE(samples_in(read, "left hand").empty());
}

TEST(TableSamples, HaveTheTimesOfUnixInMilliseconds) {
  const std::string text = lines_of_table("time_ms," + kPlaces, 10, [](int i) {
    return fmt::format("{},{}", 1'790'000'000'000 + 10 * i, kPlace);
  });
  const auto head = samples_in(tracks_read(text), "head");
  ASSERT_EQ(head.size(), 10u);
  EXPECT_EQ(head[9].time, Time{1'790'000'000'090'000});
}

TEST(TableSamples, WithoutATimeAreNoted) {
  const std::string text = lines_of_table("time_s," + kPlaces, 20, [](int i) {
    const std::string time = i == 3   ? ""
                             : i == 7 ? "100000000000"  // 3200 years
                                      : fmt::format("{:.2f}", 0.01 * i);
    return time + "," + kPlace;
  });
  const MotionTracks read = tracks_read(text);
  EXPECT_EQ(samples_in(read, "head").size(), 18u);
  EXPECT_THAT(read.notes, Contains("2 rows have no time: ignored"));
}

TEST(TableSamples, FurtherThanABillionUnitsAreNoPlaces) {
  const auto lost = [](const char* x) {
    const std::string text = lines_of_table("time_s," + kPlaces, 10, [&](int i) {
      return fmt::format("{:.2f},{},1.5,0,0.2,1,0", 0.01 * i, i == 4 ? x : "0");
    });
    return 10 - samples_in(tracks_read(text), "head").size();
  };
  EXPECT_EQ(lost("1e9"), 0u);
  EXPECT_EQ(lost("-1000000001"), 1u);
}

TEST(TableSamples, OfACoarseClockAreNotedWhereMoreThanOneInFiftyHasTheTimeOfAnother) {
  const auto notes = [](int rows) {
    const std::string text = lines_of_table("time_s," + kPlaces, rows, [](int i) {
      return fmt::format("{:.2f},{}", 0.01 * (i == 7 ? 6 : i), kPlace);
    });
    return tracks_read(text).notes;
  };
  const std::string coarse = "the clock of the rows is coarse: speeds are less accurate";
  EXPECT_THAT(notes(49), Contains(coarse));
  EXPECT_THAT(notes(50), AllOf(Not(Contains(coarse)), Contains("1 samples of the head have the "
                                                               "time of another one: ignored")));
}

// The last line may have been cut within a number.
TEST(TableSamples, AreOfWholeLines) {
  const std::string text = lines_of_table("time_s," + kPlaces, 10, [](int i) {
    return fmt::format("{:.2f},0,1.5,0,0.2,1,0.{}5", 0.01 * i, i);
  });
  const std::string note =
      "the last line has no end, so its last number may be incomplete; the line is ignored";
  EXPECT_THAT(tracks_read(text).notes, Not(Contains(note)));
  const MotionTracks cut = tracks_read(text + "0.10,0,1.5,0,0.2,1,0.");
  EXPECT_THAT(cut.notes, Contains(note));
  const auto hand = samples_in(cut, "right hand");
  ASSERT_EQ(hand.size(), 10u);
  EXPECT_EQ(hand[9].value.p.z(), 0.95);
}

TEST(TableAnglesUnit, IsSaidByAColumnElseByAnAngleBeyondAFullTurn) {
  const auto turn = [](const char* unit, const char* angle) {
    return first_turn(tracks_read(
        placed(fmt::format(fmt::runtime(kHeadAngles), unit), fmt::format(",0,{},0", angle))));
  };
  const double degree = std::acos(-1.0) / 180.0;
  EXPECT_NEAR(turn("", "1.5"), 1.5, 1e-9);
  EXPECT_NEAR(turn("", "6.28"), 360 * degree - 6.28, 1e-9);
  EXPECT_NEAR(turn("", "6.29"), 6.29 * degree, 1e-9);
  for (const char* radians : {" (rad)", " (radians)"})
    EXPECT_NEAR(turn(radians, "7"), 7 - 360 * degree, 1e-9) << radians;
  for (const char* degrees : {" (deg)", " (degrees)"})
    EXPECT_NEAR(turn(degrees, "3"), 3 * degree, 1e-9) << degrees;
}

// Seven radians of a head that says so are no hint at degrees of a hand that says nothing.
TEST(TableAnglesUnit, OfOnePartSaysNothingOfAnother) {
  const MotionTracks read = tracks_read(
      placed(fmt::format(fmt::runtime(kHeadAngles), " (rad)") + ",right_rx,right_ry,right_rz",
             ",0,7,0,0,1,0"));
  EXPECT_NEAR(samples_in(read, "right hand").at(0).value.q.angularDistance(Quat::Identity()), 1.0,
              1e-9);
}

TEST(TableRotations, MayBeToldToBeVectorsOrInAnotherOrder) {
  const std::string text = placed(fmt::format(fmt::runtime(kHeadAngles), " (rad)"), ",0.3,0.4,1.2");
  const MotionTracks vectors = tracks_read(text, {.rotations = "vector"});
  EXPECT_NEAR(first_turn(vectors), 1.3, 1e-9);  // 5, 12, 13
  EXPECT_EQ(vectors.reading.angles, "vector,rad");
  const MotionTracks none = tracks_read(text, {.rotations = "none"});
  EXPECT_EQ(none.reading.angles, "none");
  EXPECT_EQ(first_turn(none), 0.0);
  const auto product = [](const char* order) {
    Quat q = Quat::Identity();
    for (const char axis : std::string(order)) {
      q = q * (axis == 'X'   ? Quat(Eigen::AngleAxisd(0.3, Vec3::UnitX()))
               : axis == 'Y' ? Quat(Eigen::AngleAxisd(0.4, Vec3::UnitY()))
                             : Quat(Eigen::AngleAxisd(1.2, Vec3::UnitZ())));
    }
    return q;
  };
  for (const char* order : {"ZXY", "XYZ", "YXZ"}) {
    const MotionTracks told = tracks_read(text, {.rotations = order});
    EXPECT_NEAR(samples_in(told, "head").at(0).value.q.angularDistance(product(order)), 0.0, 1e-7);
    EXPECT_EQ(told.reading.angles, fmt::format("{},rad", order));
  }
}

TEST(TableRotations, OfMotiveHaveTheOrderThatTheFileStates) {
  const auto order = [](const char* type) {
    return tracks_read(fmt::format("Format Version,1.23,Rotation Type,{}\n", type) +
                       placed(fmt::format(fmt::runtime(kHeadAngles), " (rad)"), ",0.3,0.4,1.2"))
        .reading.angles;
  };
  for (const char* stated : {"XYZ", "ZYX", "YZX", "zxy"}) {
    std::string capitals = stated;
    if (capitals == "zxy") capitals = "ZXY";
    EXPECT_EQ(order(stated), capitals + ",rad");
  }
  for (const char* none : {"XXY", "Quaternion", "ABC", "XYZW"})
    EXPECT_EQ(order(none), "YXZ,rad") << none;
}

TEST(TableRotations, ThatAreQuaternionsMayHaveTwoOrders) {
  const auto reading = [](const char* right) {
    const bool w_first = std::string(right).find("qw") < 10;
    return tracks_read(placed(",head_qw,head_qx,head_qy,head_qz," + std::string(right),
                              std::string(",1,0,0,0,") + (w_first ? "1,0,0,0" : "0,0,0,1")))
        .reading;
  };
  const Reading one = reading("right_qw,right_qx,right_qy,right_qz");
  EXPECT_EQ(one.quaternion, "wxyz");
  EXPECT_FALSE(one.own_orders);
  const Reading two = reading("right_qx,right_qy,right_qz,right_qw");
  EXPECT_EQ(two.quaternion, "wxyz");
  EXPECT_TRUE(two.own_orders);
  const Reading hand =
      tracks_read(placed(",right_qx,right_qy,right_qz,right_qw", ",0,0,0,1")).reading;
  EXPECT_EQ(hand.quaternion, "xyzw");
  EXPECT_FALSE(hand.own_orders);
}

// The catalogue's tables have centimetres, and times since the start where they begin within a second of it.
TEST(TableOfTheCatalogue, IsOneByTheNamesOfItsTimeAndItsHead) {
  const auto table = [](const std::string& time, const std::string& head, int from_ms) {
    return tracks_read(lines_of_table(
        fmt::format("{0},{1}_x,{1}_y,{1}_z,right_hand_pos_x,right_hand_pos_y,right_hand_pos_z",
                    time, head),
        10, [&](int i) { return fmt::format("{},0,150,0,20,100,0", from_ms + 10 * i); }));
  };
  EXPECT_EQ(table("delta_time_ms", "head_pos", 0).reading.unit_m, 0.01);
  EXPECT_EQ(table("delta_time_ms", "head", 0).reading.unit_m, 1.0);
  EXPECT_EQ(table("time_ms", "head_pos", 0).reading.unit_m, 1.0);
  EXPECT_TRUE(table("delta_time_ms", "head_pos", 0).since_start);
  EXPECT_TRUE(table("delta_time_ms", "head_pos", 999).since_start);
  EXPECT_FALSE(table("delta_time_ms", "head_pos", 1000).since_start);
  EXPECT_FALSE(table("time_ms", "head_pos", 0).since_start);
}

TEST(TableWithoutAHand, IsRefusedForItAlsoWhereTheHeadIsTold) {
  const std::string text = lines_of_table(
      "time_s,a,b,c,d", 10, [](int i) { return fmt::format("{:.2f},0,1.5,0,7", 0.01 * i); });
  const auto refused = [&](const MotionOptions& options) {
    return complaint([&] { tracks_read(text, options); });
  };
  EXPECT_THAT(refused({}), StartsWith("t.csv: no head was found"));
  EXPECT_THAT(refused({.p_head = Vec3(0, 1.5, 0)}), StartsWith("t.csv: no hand was found"));
  EXPECT_THAT(complaint([] {
                tracks_read(
                    lines_of_table("time_s,head_x,head_y,head_z", 10,
                                   [](int i) { return fmt::format("{:.2f},0,1.5,0", 0.01 * i); }),
                    {.p_head = Vec3(0, 1.5, 0)});
              }),
              StartsWith("t.csv: no hand was found"));
}

TEST(TableFindingsOf, SayTheKindAndWhatIsMissing) {
  const std::string text =
      "Segments\n100\nFrame,head_x,head_y,head_z,word\n1,0,1.5,0,\n2,0,1.5,0,a\n";
  const TableFindings found = inspect_table(text, "t.csv", {});
  EXPECT_EQ(found.kind, "Vicon");
  EXPECT_EQ(found.rows, 2u);
  EXPECT_EQ(found.columns.at(4).first, "a");
  EXPECT_THAT(found.missing, ElementsAre(HasSubstr("no hand was found"), "the head has no rotation",
                                         HasSubstr("not understood: word")));
}

}  // namespace
}  // namespace headpin::devices
