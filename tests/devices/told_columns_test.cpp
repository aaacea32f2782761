// Columns that a user tells beside those that were found: whose trigger it is, parts of a rotation, equal names.

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/recordings/table_columns.h"
#include "devices/recordings/table_motion.h"
#include "tests/support/folder.h"

namespace headpin::devices {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

/// Four rows of numbers under a header of one line.
std::string rows_under(const std::string& header) {
  std::string text = header + "\n";
  for (int row = 0; row < 4; ++row) {
    text += fmt::format("{:.2f}", 0.01 * row);
    for (int c = 0; c < std::ranges::count(header, ','); ++c) text += fmt::format(",{}", c);
    text += "\n";
  }
  return text;
}

MotionColumns with_told(const std::string& header, const ToldColumns& told) {
  return find_columns(read_any_table(rows_under(header), "t.csv"), told, false, "t.csv");
}

/// Where the columns of a rotation stand.
template <std::size_t N>
std::vector<std::size_t> places_at(const std::array<std::optional<std::size_t>, N>& columns) {
  std::vector<std::size_t> all;
  for (const auto& column : columns) all.push_back(column.value_or(999));
  return all;
}

const std::string kHeadAndHand = "time,hmd_x,hmd_y,hmd_z,right_x,right_y,right_z";

// The found trigger was taken.
TEST(ToldTrigger, OfBothHandsGoesBeforeOneThatWasFound) {
  const std::string names = kHeadAndHand + ",right_trigger,button_b";
  const ToldColumn general = {"trigger", "button_b"}, object = {"right", "right_*"};
  const std::vector<ToldColumns> ways = {{general}, {general, object}, {object, general}};
  for (const ToldColumns& told : ways) {
    const MotionColumns columns = with_told(names, told);
    EXPECT_EQ(columns.parts[2].trigger, 8u);
    EXPECT_EQ(columns.meanings[7], "");
  }
}

// It won only where the places of the hand were told too.
TEST(ToldTrigger, OfAHandGoesBeforeThatOfBoth) {
  const std::string names = kHeadAndHand + ",right_trigger,button_b,pull";
  const ToldColumn general = {"trigger", "button_b"}, own = {"right.trigger", "pull"};
  const ToldColumns places = {{"right.x", "right_x"}, {"right.y", "right_y"}, {"right.z", "#7"}};
  for (const ToldColumns& more : {ToldColumns{}, ToldColumns{{"right", "right_*"}}, places}) {
    ToldColumns first = {general, own}, last = more;
    first.insert(first.end(), more.begin(), more.end());
    last.insert(last.end(), {own, general});
    EXPECT_EQ(with_told(names, first).parts[2].trigger, 9u);
    EXPECT_EQ(with_told(names, last).parts[2].trigger, 9u);
  }
}

// It was not used, and a file of columns did not have it.
TEST(ToldTrigger, HoldsForATableWithARowForEachObject) {
  std::string text = "time,who,x,y,z,qw,qx,qy,qz,trigger,pull\n";
  for (int i = 0; i < 4; ++i) {
    for (const char* who : {"head", "right"})
      text += fmt::format("{:.2f},{},1,2,3,1,0,0,0,0,1\n", 0.01 * i, who);
  }
  const AnyTable table = read_any_table(text, "t.csv");
  const MotionColumns told = find_columns(table, {{"trigger", "pull"}}, false, "t.csv");
  EXPECT_EQ(told.object, 1u);
  EXPECT_EQ(told.parts[2].trigger, 10u);
  EXPECT_EQ(find_columns(table, mapping_of(table, told), false, "t.csv").parts[2].trigger, 10u);
}

/// What is said of a wrong column.
std::string told_refusal(const std::string& header, const ToldColumns& told) {
  return complaint([&] { with_told(header, told); });
}

// The first of them was taken.
TEST(ToldColumns, ByAWholeNameThatSeveralHaveAreRefused) {
  const std::string header = "time,x [m],y [m],z [m],x [mm],y [mm],z [mm]";
  EXPECT_EQ(
      told_refusal(header, {{"head.x", "x", "--columns"}}),
      "--columns: 2 columns of t.csv are called 'x'; expected one of them by its number, such "
      "as #2 or #5");
  EXPECT_EQ(told_refusal("time,x,y,z,x,y,z,x", {{"time", "x", "m.toml:1"}}),
            "m.toml:1: 3 columns of t.csv are called 'x'; expected one of them by its number, such "
            "as #2 or #5");
  // With its unit it is one.
  EXPECT_EQ(with_told(header, {{"time", "x [mm]"}}).time, 4u);
  EXPECT_EQ(with_told(header, {{"time", "#5"}}).time, 4u);
  EXPECT_EQ(with_told("time,x [mm],y,z,x", {{"time", "x"}}).time, 4u);
}

TEST(ToldColumns, ByANumberAreThoseThoughAnotherIsCalledSo) {
  const std::string text = rows_under("#3,hmd_x,hmd_y,hmd_z");
  const AnyTable table = read_any_table(text, "t.csv");
  const MotionColumns columns = find_columns(table, {{"time", "#1"}}, false, "t.csv");
  EXPECT_EQ(columns.time, 0u);
  EXPECT_EQ(find_columns(table, mapping_of(table, columns), false, "t.csv").time, 0u);
}

// W was not used, and the other three were read as angles.
TEST(ToldRotation, OfOneColumnCompletesWhatWasFound) {
  const std::string names = kHeadAndHand + ",W,hmd_qx,hmd_qy,hmd_qz";
  for (const ToldColumns& told :
       {ToldColumns{{"head.qw", "W"}}, {{"head", "hmd_*"}, {"head.qw", "W"}}}) {
    const PartColumns head = with_told(names, told).parts[0];
    EXPECT_EQ(head.rotation, RotationKind::quaternion);
    EXPECT_THAT(places_at(head.quaternion), ElementsAre(7u, 8u, 9u, 10u));
    EXPECT_THAT(places_at(head.position), ElementsAre(1u, 2u, 3u));
  }
}

// It was dropped.
TEST(ToldRotation, OfOneColumnReplacesTheOneThatWasFound) {
  const auto head = [](const std::string& names, const std::string& key) {
    return with_told(kHeadAndHand + "," + names + ",a", {{key, "a"}}).parts[0];
  };
  const PartColumns quaternion = head("hmd_qw,hmd_qx,hmd_qy,hmd_qz", "head.qx");
  EXPECT_EQ(quaternion.rotation, RotationKind::quaternion);
  EXPECT_THAT(places_at(quaternion.quaternion), ElementsAre(7u, 11u, 9u, 10u));
  for (const char* names : {"hmd_rx,hmd_ry,hmd_rz", "hmd_pitch,hmd_yaw,hmd_roll",
                            "hmd_rot_x,hmd_rot_y,hmd_rot_z", "hmd_qx,hmd_qy,hmd_qz"}) {
    const PartColumns angles = head(names, "head.ry");
    EXPECT_EQ(angles.rotation, RotationKind::angles) << names;
    EXPECT_THAT(places_at(angles.angles), ElementsAre(7u, 10u, 9u)) << names;
  }
  const PartColumns matrix =
      head("hmd_r11,hmd_r12,hmd_r13,hmd_r21,hmd_r22,hmd_r23,hmd_r31,hmd_r32,hmd_r33", "head.m11");
  EXPECT_EQ(matrix.rotation, RotationKind::matrix);
  EXPECT_THAT(places_at(matrix.matrix), ElementsAre(7u, 8u, 9u, 10u, 16u, 12u, 13u, 14u, 15u));
}

// The rotation that was found was used without a word.
TEST(ToldRotation, ThatIsNotWholeIsRefusedBesideAnotherOne) {
  const std::string names = kHeadAndHand + ",hmd_qw,hmd_qx,hmd_qy,hmd_qz,a,b";
  EXPECT_EQ(
      told_refusal(names, {{"head.ry", "a", "--columns"}, {"head.rx", "b", "--columns"}}),
      "--columns: head.ry = 'a' makes no whole rotation; expected all of qw, qx, qy, qz, or of "
      "rx, ry, rz, or m00 to m22");
  EXPECT_THAT(told_refusal(names, {{"head", "hmd_*"}, {"head.m00", "a", "m.toml:3"}}),
              HasSubstr("m.toml:3: head.m00 = 'a' makes no whole rotation"));
  // Where there is no other, a note says that there is none.
  EXPECT_THAT(with_told(kHeadAndHand + ",a", {{"head.ry", "a"}}).missing,
              Contains("the head has no rotation"));
}

TEST(ToldRotation, OfThreeAnglesIsNoQuaternionUnlessAFourthIsTold) {
  const std::string names = kHeadAndHand + ",hmd_qw,hmd_qx,hmd_qy,hmd_qz,a,b,c,d";
  ToldColumns told = {{"head.rx", "a"}, {"head.ry", "b"}, {"head.rz", "c"}};
  const PartColumns three = with_told(names, told).parts[0];
  EXPECT_EQ(three.rotation, RotationKind::angles);
  EXPECT_THAT(places_at(three.angles), ElementsAre(11u, 12u, 13u));
  told.push_back({"head.rw", "d"});
  const PartColumns four = with_told(names, told).parts[0];
  EXPECT_EQ(four.rotation, RotationKind::quaternion);
  EXPECT_THAT(places_at(four.quaternion), ElementsAre(14u, 11u, 12u, 13u));
  const PartColumns unnamed =
      with_told(kHeadAndHand + ",a,b,c", {{"head.qx", "a"}, {"head.qy", "b"}, {"head.qz", "c"}})
          .parts[0];
  EXPECT_EQ(unnamed.rotation, RotationKind::angles);
  EXPECT_THAT(places_at(unnamed.angles), ElementsAre(7u, 8u, 9u));
}

// The file had both rotations, and was read with the other one.
TEST(ToldRotation, OfAFileOfColumnsIsTheOneThatWasUsed) {
  const std::string text =
      rows_under(kHeadAndHand + ",hmd_qw,hmd_qx,hmd_qy,hmd_qz,hmd_yaw,hmd_pitch,hmd_roll");
  const AnyTable table = read_any_table(text, "t.csv");
  const ToldColumns told = {
      {"head.rx", "hmd_pitch"}, {"head.ry", "hmd_yaw"}, {"head.rz", "hmd_roll"}};
  const auto again = [&](const ToldColumns& first) {
    const MotionColumns columns = find_columns(table, first, false, "t.csv");
    return find_columns(table, mapping_of(table, columns), false, "t.csv").parts[0];
  };
  EXPECT_EQ(again({}).rotation, RotationKind::quaternion);
  EXPECT_FALSE(again({}).angles[0]);
  const PartColumns angles = again(told);
  EXPECT_EQ(angles.rotation, RotationKind::angles);
  EXPECT_THAT(places_at(angles.angles), ElementsAre(12u, 11u, 13u));
  EXPECT_FALSE(angles.quaternion[0]);
  // Also where none is used.
  const AnyTable parts =
      read_any_table(rows_under(kHeadAndHand + ",hmd_qw,hmd_qx,hmd_yaw,hmd_pitch"), "t.csv");
  const MotionColumns none = find_columns(parts, {}, false, "t.csv");
  EXPECT_EQ(none.parts[0].rotation, RotationKind::none);
  EXPECT_EQ(find_columns(parts, mapping_of(parts, none), false, "t.csv").parts[0].rotation,
            RotationKind::none);
}

/// A table with a row for each object.
AnyTable of_head_and_right(const std::string& text_after_place) {
  static std::string text;  // cells point into it
  text = "time,who,x,y,z," + text_after_place + "\n";
  for (int i = 0; i < 4; ++i) {
    for (const char* who : {"head", "right"})
      text += fmt::format("{:.2f},{},1,2,3,1,0,0,0\n", 0.01 * i, who);
  }
  return read_any_table(text, "t.csv");
}

// They were not used, and three of a quaternion were read as angles.
TEST(ToldRotation, CompletesThatOfATableWithARowForEachObject) {
  const AnyTable table = of_head_and_right("Q0,qx,qy,qz");
  const MotionColumns told = find_columns(table, {{"head.qw", "Q0"}}, false, "t.csv");
  const MotionColumns by_file = find_columns(table, mapping_of(table, told), false, "t.csv");
  for (const MotionColumns& columns : {told, by_file}) {
    EXPECT_EQ(columns.object, 1u);
    EXPECT_EQ(columns.parts[0].rotation, RotationKind::quaternion);
    EXPECT_THAT(places_at(columns.parts[0].quaternion), ElementsAre(5, 6, 7, 8));
    EXPECT_EQ(columns.parts[2].rotation, RotationKind::angles);
    EXPECT_THAT(places_at(columns.parts[2].angles), ElementsAre(6, 7, 8));
    EXPECT_EQ(columns.meanings[5], "head, quaternion w");
  }
  const ToldColumns both = {{"head.qw", "Q0"}, {"right.qw", "Q0"}, {"right.x", "qx"}};
  const MotionColumns moved = find_columns(table, both, false, "t.csv");
  EXPECT_EQ(moved.parts[2].rotation, RotationKind::quaternion);
  EXPECT_EQ(moved.parts[2].position[0], 6u);
  EXPECT_EQ(moved.parts[0].position[0], 2u);
}

TEST(ToldRotation, ThatIsNoWholeOneOfATableWithARowForEachObjectIsRefused) {
  const AnyTable table = of_head_and_right("qw,qx,qy,qz");
  EXPECT_EQ(complaint([&] {
              find_columns(table, {{"head.rx", "qx", "--columns"}}, false, "t.csv");
            }),
            "--columns: head.rx = 'qx' makes no whole rotation; expected all of qw, qx, qy, qz, or "
            "of rx, ry, rz, or m00 to m22");
}

// They were ignored.
TEST(ToldColumns, OfAPartThatIsNotFoundAreRefused) {
  const auto reading = [](const std::string& header, const ToldColumns& told) {
    MotionOptions options;
    options.columns = told;
    return complaint([&] { parse_motion_table(rows_under(header), "t.csv", options); });
  };
  const std::string names = kHeadAndHand + ",press";
  EXPECT_EQ(
      reading(names, {{"left.trigger", "press", "--columns"}}),
      "--columns: left.trigger = 'press' is of a left hand that was not found; expected left = "
      "'NAME*' or all of left.x, left.y and left.z as well");
  const ToldColumns beside = {{"right", "right_*"}, {"left.x", "press", "m.toml:4"}};
  EXPECT_THAT(reading(names, beside), HasSubstr("m.toml:4: left.x = 'press' is of a left hand"));
  EXPECT_THAT(reading("time,left_x,left_y,left_z,press", {{"right.qw", "press"}}),
              HasSubstr("no head was found"));
  EXPECT_THAT(told_refusal(names, {{"head.trigger", "press", "--columns"}}),
              HasSubstr("'head.trigger': a head has no trigger; expected trigger, left.trigger"));
}

/// A table with a row for each of these objects, with their places, rotations and triggers.
std::string with_a_row_for_each(const std::vector<std::string>& objects) {
  std::string text = "time,device,x,y,z,qw,qx,qy,qz,trigger\n";
  for (int i = 0; i < 300; ++i) {
    for (const std::string& object : objects)
      text +=
          fmt::format("{:.2f},{},0,1,{},1,0,0,0,{}\n", 0.01 * i, object, 0.001 * i, i / 100 % 2);
  }
  return text;
}

// A mapping that was written for a recording with both hands was refused for one with the right hand alone.
TEST(ToldColumns, OfAnObjectWithoutRowsAreNotedWhereEachHasItsOwn) {
  const std::string three = with_a_row_for_each({"head", "left_hand", "right_hand"});
  MotionOptions options;
  options.columns = inspect_table(three, "three.csv", {}).mapping;
  EXPECT_THAT(options.columns, Contains(testing::Field("key", &ToldColumn::key, "left.trigger")));
  for (const char* component : {"x", "y", "z"})  // as for a rotation that was told
    options.columns.push_back({fmt::format("left.{}", component), component});
  const std::string note = "no rows are of a left hand: what was told of its columns is not used";
  const MotionTracks of_two =
      parse_motion_table(with_a_row_for_each({"head", "right_hand"}), "two.csv", options);
  EXPECT_EQ(of_two.tracks.size(), 2u);
  EXPECT_FALSE(of_two.triggers[1].empty());
  EXPECT_EQ(std::ranges::count(of_two.notes, note), 1);
  const MotionTracks of_three = parse_motion_table(three, "three.csv", options);
  EXPECT_EQ(of_three.tracks.size(), 3u);
  EXPECT_FALSE(of_three.triggers[0].empty());
  EXPECT_EQ(std::ranges::count(of_three.notes, note), 0);
}

// The quaternion was used, and the angles were ignored.
TEST(ToldRotation, OfTwoKindsIsRefused) {
  const std::string names = kHeadAndHand + ",a,b,c,d,e,f,g";
  const ToldColumns places = {{"head.x", "hmd_x"}, {"head.y", "hmd_y"}, {"head.z", "hmd_z"}};
  const ToldColumns quaternion = {
      {"head.qw", "a"}, {"head.qx", "b"}, {"head.qy", "c"}, {"head.qz", "d"}};
  const ToldColumns angles = {
      {"head.rx", "e", "m.toml:9"}, {"head.ry", "f", "m.toml:10"}, {"head.rz", "g", "m.toml:11"}};
  const auto joined = [](const std::vector<ToldColumns>& parts) {
    ToldColumns all;
    for (const ToldColumns& part : parts) all.insert(all.end(), part.begin(), part.end());
    return all;
  };
  const std::string says =
      "m.toml:9: head.qw = 'a' and head.rx = 'e' are of two rotations; expected one rotation: "
      "columns of qw, qx, qy, qz, or of rx, ry, rz, or m00 to m22";
  EXPECT_EQ(told_refusal(names, joined({places, quaternion, angles})), says);
  EXPECT_EQ(told_refusal(names, joined({angles, quaternion})), says);
  EXPECT_THAT(told_refusal(names, {{"head.ry", "a", "--columns"}, {"head.m00", "b", "--columns"}}),
              HasSubstr("--columns: head.ry = 'a' and head.m00 = 'b' are of two rotations"));
  // Each part may have its own kind, and the last column of a matrix is a place.
  const ToldColumns other = {{"right.rx", "e"}, {"right.ry", "f"}, {"right.rz", "g"}};
  const MotionColumns both = with_told(names, joined({quaternion, other}));
  EXPECT_EQ(both.parts[0].rotation, RotationKind::quaternion);
  EXPECT_EQ(both.parts[2].rotation, RotationKind::angles);
  const ToldColumns fourth = {{"head.m03", "e"}, {"head.m13", "f"}, {"head.m23", "g"}};
  EXPECT_EQ(with_told(names, joined({quaternion, fourth})).parts[0].rotation,
            RotationKind::quaternion);
}

// Files of columns were once written so, and were refused.
TEST(ToldRotation, OfTwoKindsIsTakenWhereNoneIsRead) {
  const std::string text = rows_under(kHeadAndHand + ",hmd_qw,hmd_qx,hmd_qy,hmd_qz,a,b,c");
  MotionOptions options;
  options.rotations = "none";
  options.columns = {{"head.x", "hmd_x"},   {"head.y", "hmd_y"},   {"head.z", "hmd_z"},
                     {"head.qw", "hmd_qw"}, {"head.qx", "hmd_qx"}, {"head.qy", "hmd_qy"},
                     {"head.qz", "hmd_qz"}, {"head.rx", "a"},      {"head.ry", "b"},
                     {"head.rz", "c"}};
  EXPECT_THAT(parse_motion_table(text, "t.csv", options).without_rotation, Contains("head"));
  options.rotations.reset();
  EXPECT_THAT(complaint([&] { parse_motion_table(text, "t.csv", options); }),
              HasSubstr("head.qw = 'hmd_qw' and head.rx = 'a' are of two rotations"));
}

}  // namespace
}  // namespace headpin::devices
