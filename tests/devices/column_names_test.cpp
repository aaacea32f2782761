#include "devices/recordings/column_names.h"

#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/recordings/any_table.h"
#include "devices/recordings/marker_file.h"
#include "devices/recordings/table_time.h"
#include "tests/support/folder.h"

namespace headpin::devices {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(ColumnNames, AreSplitIntoWords) {
  EXPECT_THAT(words_of("leftHand.position.x"), ElementsAre("left", "hand", "position", "x"));
  EXPECT_THAT(words_of("HMDPosX"), ElementsAre("hmd", "pos", "x"));
  EXPECT_THAT(words_of("head_m01"), ElementsAre("head", "m", "01"));
  EXPECT_THAT(words_of("/user/hand/right RX"), ElementsAre("user", "hand", "right", "rx"));
  EXPECT_THAT(words_of("--"), ElementsAre());
}

struct NamedComponent {
  const char* name;
  Quantity quantity;
  std::size_t index;
  const char* object;
};

void expect_components(std::initializer_list<NamedComponent> all) {
  for (const NamedComponent& one : all) {
    const Component found = component_of(one.name);
    EXPECT_EQ(found.quantity, one.quantity) << one.name;
    EXPECT_EQ(found.index, one.index) << one.name;
    EXPECT_EQ(found.object, one.object) << one.name;
  }
}

TEST(ColumnNames, SayObjectAndComponent) {
  expect_components({
      {"HMD_x", Quantity::position, 0, "hmd"},
      {"HMD_qw", Quantity::quaternion, 0, "hmd"},
      {"head_rot_z", Quantity::quaternion, 3, "head"},
      {"leftHand.position.y", Quantity::position, 1, "left hand"},
      {"leftHand.rotation.eulerAngles.y", Quantity::angle, 1, "left hand"},
      {"Head Rotation W", Quantity::quaternion, 0, "head"},
      {"ctrl_r_x", Quantity::position, 0, "ctrl r"},
      {"wand_yaw", Quantity::angle, 1, "wand"},
      {"hmd_m23", Quantity::matrix, 23, "hmd"},
      {"hmd_pose_r11", Quantity::matrix, 11, "hmd"},
      {"head_x_m", Quantity::position, 0, "head"},
      {"head_x_mm", Quantity::position, 0, "head"},
      {"right_trigger", Quantity::trigger, 0, "right"},
      {"right_trigger_value", Quantity::trigger, 0, "right"},
      {"qx", Quantity::quaternion, 1, ""},
      {"head_pos_w", Quantity::none, 0, ""},
      {"battery", Quantity::none, 0, ""},
      {"t", Quantity::none, 0, ""},
  });
}

TEST(ColumnNames, SayThePart) {
  for (const char* head :
       {"hmd", "Main Camera", "CenterEyeAnchor", "helmet", "view", "XR Headset"}) {
    EXPECT_EQ(part_of_name(head), 0u) << head;
  }
  for (const char* hand : {"left hand", "LHand", "ctrl l", "LeftHandAnchor"}) {
    EXPECT_EQ(part_of_name(hand), 1u) << hand;
  }
  EXPECT_EQ(part_of_name("controller right"), 2u);
  for (const char* other : {"LeftEyeAnchor", "ahead", "ball", "wall"}) {
    EXPECT_FALSE(part_of_name(other)) << other;
  }
}

TEST(AnyTable, FindsSeparatorDecimalSignAndHeader) {
  const AnyTable table =
      read_any_table("My recording\nt;\"a; b\";c [mm];d\n0,5;1;-2e3;x\n1,5;;3;y\n", "t.csv");
  EXPECT_EQ(table.separator, ';');
  EXPECT_TRUE(table.decimal_comma);
  ASSERT_EQ(table.columns.size(), 4u);
  EXPECT_EQ(table.columns[1].name, "a; b");
  EXPECT_EQ(table.columns[2].name, "c");
  EXPECT_EQ(table.columns[2].unit, "mm");
  ASSERT_EQ(table.rows.size(), 2u);
  EXPECT_EQ(table.rows[1].line, 4u);
  EXPECT_EQ(table.number(table.rows[0].cells[0]), 0.5);
  EXPECT_EQ(table.number(table.rows[0].cells[2]), -2000.0);
  EXPECT_FALSE(table.number(table.rows[1].cells[1]));
  EXPECT_FALSE(table.number("1e999"));
  EXPECT_THAT(complaint([] { read_any_table("a,b\n1,2\n", "t.csv"); }),
              HasSubstr("t.csv: expected a table"));
}

TEST(AnyTable, ARowOfNumbersIsNoHeaderHoweverShort) {
  const AnyTable table = read_any_table("a,b,c,d,e\n1,2,3,4\n1,2,3,4,5\n2,3,4,5,6\n", "t.csv");
  EXPECT_EQ(table.columns[0].name, "a");
  EXPECT_EQ(table.rows.size(), 2u);
  EXPECT_THAT(table.notes, ElementsAre(HasSubstr("the first is line 2")));
}

TEST(TableTime, IsADateOrANumberOfUnits) {
  EXPECT_EQ(time_of("1970-01-02T00:00:01.5Z", 1.0), 86401.5);
  EXPECT_EQ(time_of("2026-11-25 09:59:52", 1.0), time_of("2026-11-25T09:59:51", 1.0).value() + 1.0);
  EXPECT_EQ(time_of("01:02:03", 1.0), 3723.0);
  EXPECT_EQ(time_of("1500", 1e-3), 1.5);
  EXPECT_EQ(time_of("1,5", 1.0), 1.5);
  for (const char* none :
       {"", "2026-13-01T00:00:00", "2026-02-30T00:00:00", "12:60:00", "soon", "2026-1"}) {
    EXPECT_FALSE(time_of(none, 1.0)) << none;
  }
}

TEST(TableTime, GoesOnOverMidnightAndBeginsBehindBlanks) {
  const std::string text =
      "time,x,y,z\n,0,0,0\n23:59:59.980,1,2,3\n00:00:00.000,1,2,3\n23:59:59.990,1,2,3\n"
      "00:00:00.020,1,2,3\n";
  const AnyTable table = read_any_table(text, "t.csv");
  std::vector<std::string> notes;
  const TableTimes times = read_times(table, 0, {}, "t.csv", notes);
  EXPECT_EQ(times.unit_s, 1.0);
  ASSERT_EQ(times.of_row.size(), 5u);
  EXPECT_FALSE(times.of_row[0]);
  EXPECT_NEAR(*times.of_row[1], 86399.98, 1e-9);
  EXPECT_NEAR(*times.of_row[2], 86400.0, 1e-9);
  EXPECT_NEAR(*times.of_row[3], 86399.99, 1e-9);
  EXPECT_NEAR(*times.of_row[4], 86400.02, 1e-9);
}

TEST(Markers, AreGrabsAndReleasesInOrder) {
  const auto read = [](const std::string& text) { return parse_markers(text, "m.csv", 1.0); };
  const std::vector<Stamped<bool>> found =
      read("2.5 thrown\n# a remark\n1.0 picked up\n9 end\n1.5 grabbed\n");
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].time, Time{1'000'000});
  EXPECT_TRUE(found[0].value);
  EXPECT_EQ(found[1].time, Time{2'500'000});
  EXPECT_FALSE(found[1].value);
  EXPECT_EQ(read("1,2 grab\n3,962 release\n").at(1).time, Time{3'962'000});
  EXPECT_EQ(read("1, grab\n3, release\n").at(1).time, Time{3'000'000});
  EXPECT_EQ(read("duration,onset,what\n7,1,grab\n8,2,let go\n").at(1).time, Time{2'000'000});
  for (const std::string before : {"", "# made by a script\n", "\n", "\n# one\n \n# two\n"}) {
    const auto timed = read(before + "sample,time,word\n100,1.222,grab\n300,3.96,release\n");
    EXPECT_EQ(timed.at(0).time, Time{1'222'000}) << before;
    EXPECT_EQ(timed.at(1).time, Time{3'960'000}) << before;
  }
  // A remark behind the event says nothing of it.
  const auto remarked = read("1.3,grab,throw 1\n3.9,release,hold 1\n");
  EXPECT_TRUE(remarked.at(0).value);
  EXPECT_EQ(remarked.at(1).time, Time{3'900'000});
  EXPECT_EQ(read("1.3 pressed\n3.9 not pressed\n").at(1).time, Time{3'900'000});
  EXPECT_THAT(complaint([&] { read("grab,release\n"); }), HasSubstr("m.csv:1: expected a time"));
}

// Where a time tells its zone it is of UTC, so files of two zones tell one moment.
TEST(TimesOfDay, AreOfTheirZones) {
  const double noon = 1714903200.0;  // of 2024-05-05 10:00:00 UTC
  for (const std::string_view same :
       {"2024-05-05T10:00:00Z", "2024-05-05 12:00:00+02:00", "2024-05-05T12:00:00.000+0200",
        "2024-05-05T04:30:00-05:30", "2024-05-05 10:00:00", "2024-05-05 10:00:00 AM",
        "2024-05-05T10:00:00 +00", "2024-05-05 10:00:00 UTC"}) {
    EXPECT_EQ(time_of(same, 1.0), noon) << same;
  }
  EXPECT_EQ(time_of("01:00:00 PM", 1.0), 13 * 3600.0);
  EXPECT_EQ(time_of("12:00:01 am", 1.0), 1.0);
  EXPECT_EQ(time_of("12:00:01 PM", 1.0), 12 * 3600.0 + 1.0);
  EXPECT_EQ(time_of("12:00:00+2:", 1.0), 10 * 3600.0);
  for (const std::string_view none :
       {"13:00:00 PM", "12:00:00+99:00", "12:00:00+02:99", "12:00:00+"}) {
    EXPECT_EQ(time_of(none, 1.0), std::nullopt) << none;
  }
}

// The file may hold other words, so one of them is blamed only where nothing else helps.
TEST(Markers, WithoutAGrabAndALaterReleaseAreRefusedByTheirLine) {
  const auto refused = [](const std::string& text) {
    return complaint([&] { parse_markers(text, "m.csv", 1.0); });
  };
  EXPECT_EQ(refused("1.2 grab\n1.0 release\n"),
            "m.csv:2: the release (1.0) is before the grab (1.2); expected a later time");
  EXPECT_EQ(refused("time,what\n1,release\n2,grab\n"),
            "m.csv:2: the release (1) is before the grab (2); expected a later time");
  EXPECT_EQ(refused("1.2 gra\n"), "m.csv:1: unknown word 'gra'; expected grab or release");
  EXPECT_EQ(refused("1.2 grab\n\n2.4 relaese\n"),
            "m.csv:3: unknown word 'relaese'; expected grab or release");
  EXPECT_THAT(refused("0 start\n1 grab\n2 stop\n"), HasSubstr("release; found grab, start, stop"));
  EXPECT_THAT(refused("onset\tduration\ttrial_type\n1\tn/a\tcue\n"),
              HasSubstr("m.csv:2: unknown word 'cue'"));
  EXPECT_THAT(refused("1 grab\n"), HasSubstr("one with a later time and release; found grab"));
  EXPECT_THAT(refused(""), HasSubstr("m.csv: expected a line with a time and grab, and"));
  EXPECT_EQ(refused("0 start\n1 grab\n2 release\n3 stop\n"), "");
}

// The milliseconds behind a colon were passed over, so that all rows of a second had one time.
TEST(TimeOf, AMillisecondBehindAColonIsReadAndOtherTextRefused) {
  EXPECT_DOUBLE_EQ(time_of("23:59:57:123", 1.0).value(), 86397.123);
  EXPECT_EQ(time_of("12:00:00 UTC", 1.0), 12 * 3600.0);
  EXPECT_EQ(time_of("12:00:00.", 1.0), 12 * 3600.0);
  EXPECT_EQ(time_of("12:00:00+02:00[Europe/Berlin]", 1.0), 10 * 3600.0);
  for (const char* none : {"23:59:57:12", "23:59:57:1234", "23:59:57;12", "23:59:57.5.5"})
    EXPECT_EQ(time_of(none, 1.0), std::nullopt) << none;
}

// A blank that does not break a line stood before "PM", and other words than English ones behind a time.
TEST(TimeOf, AMomentBeforeOtherSignsThanThoseOfNumbersIsRead) {
  const double afternoon = 15 * 3600.0 + 59 * 60.0 + 50.5;
  for (const std::string_view same :
       {"3:59:50.5\u202fPM", "3:59:50.5\u00a0PM", "3:59:50.5\u2009pm", "3:59:50.5\xa0PM",
        "3:59:50.5?PM", "3:59:50.5 p.m.", "3:59:50.5\u00a0p.\u00a0m.", "15:59:50.5 \u0447.",
        "15:59:50.5\u6642", "15:59:50.5 AMT", "15:59:50.5 Uhr"}) {
    EXPECT_EQ(time_of(same, 1.0), afternoon) << same;
  }
  EXPECT_EQ(time_of("12:00:01\u202fa.m.", 1.0), 1.0);
  for (const std::string_view none :
       {"12:00:00.001.456", "12:00:00 5", "12:00:00;5", "12:00:00\u00a07"})
    EXPECT_EQ(time_of(none, 1.0), std::nullopt) << none;
}

// A tenth of the rows was left out where milliseconds have no zeros before them.
TEST(TableTime, BehindAThirdColonIsAWholeNumberOfMillisecondsOrMicroseconds) {
  const auto read = [](const std::vector<std::string>& times) {
    std::string text = "time,x,y,z\n";
    for (const std::string& time : times) text += time + ",1,2,3\n";
    std::vector<std::string> notes;
    return read_times(read_any_table(text, "t.csv"), 0, {}, "t.csv", notes).of_row;
  };
  const auto expect = [&](const std::vector<std::string>& times, const std::vector<double>& each) {
    const auto found = read(times);
    ASSERT_EQ(found.size(), each.size());
    for (std::size_t i = 0; i < each.size(); ++i)
      EXPECT_NEAR(found[i].value_or(-1.0), 43200.0 + each[i], 1e-9) << times[i];
  };
  expect({"12:00:00:993", "12:00:01:7", "12:00:01:21", "12:00:02"}, {0.993, 1.007, 1.021, 2.0});
  expect({"12:00:00:013", "12:00:00:027"}, {0.013, 0.027});
  expect({"12:00:00:013456", "12:00:00:027456"}, {0.013456, 0.027456});
  expect({"12:00:00:999456", "12:00:01:456"}, {0.999456, 1.000456});
  // Numbers of frames, at 25 and at 120 a second.
  EXPECT_EQ(complaint([&] {
              read({"12:00:00:23", "12:00:00:24", "12:00:01:0"});
            }),
            "t.csv:2: time: '12:00:00:23' is no time");
  EXPECT_EQ(complaint([&] {
              read({"12:00:00:98", "12:00:00:119", "12:00:01:0"});
            }),
            "t.csv:2: time: '12:00:00:98' is no time");
  EXPECT_EQ(complaint([&] {
              read({"12:00:00.001.456", "12:00:00.012.456"});
            }),
            "t.csv:2: time: '12:00:00.001.456' is no time");
}

// The same text was read in the column of the time.
TEST(Markers, OfMillisecondsBehindAColonNeedNoZerosBeforeThemUnderAHeader) {
  const auto read = [](const std::string& text) { return parse_markers(text, "m.csv", 1.0); };
  for (const char* more : {"", "12:00:00:993,end\n", "# from 12:00:01:000250\n"}) {
    const auto found =
        read(std::string("time,what\n12:00:01:7,grab\n12:00:03:962,release\n") + more);
    EXPECT_EQ(found.at(0).time, Time{43'201'007'000}) << more;
    EXPECT_EQ(found.at(1).time, Time{43'203'962'000}) << more;
  }
  // Of frames.
  EXPECT_THAT(complaint([&] { read("time,what\n12:00:01:7,grab\n12:00:03:21,release\n"); }),
              HasSubstr("m.csv:2: expected a time beside"));
}

// Remarks and numbers of frames said how the milliseconds in another column were read.
TEST(Markers, WithoutAHeaderAreReadCellByCell) {
  const auto times = [](const std::string& text) {
    std::vector<Time> found;
    for (const Stamped<bool>& marker : parse_markers(text, "m.csv", 1.0))
      found.push_back(marker.time);
    return found;
  };
  const std::vector<Time> both = {Time{43'201'280'000}, Time{43'202'731'000}};
  EXPECT_EQ(times("12:00:01:280 grab\n12:00:02:731 release\n"), both);
  EXPECT_EQ(times("# 12:00:01:000250\n12:00:01:280,grab\n12:00:02:731,release\n"), both);
  EXPECT_EQ(times("12:00:01:280,grab,at 1:2:3:45\n12:00:02:731,release\n"), both);
  EXPECT_EQ(times("12:00:01:280,12:00:01:07,grab\n12:00:02:731,12:00:02:12,release\n"), both);
  EXPECT_EQ(times("12:00:01:07,12:00:01:280,grab\n12:00:02:12,12:00:02:731,release\n"), both);
  EXPECT_THAT(complaint([&] { times("12:00:01:7 grab\n12:00:03:962 release\n"); }),
              HasSubstr("m.csv:1: expected a time beside"));
}

TEST(ColumnNames, SayAComponentOnlyBehindWordsOfItsKind) {
  expect_components({
      // A word such as "grip" is a trigger at the end, or before a word of its value.
      {"grip_x", Quantity::position, 0, "grip"},
      {"trigger_touched", Quantity::none, 0, ""},
      {"battery_value", Quantity::none, 0, ""},
      {"value", Quantity::none, 0, ""},
      {"left_grip_axis", Quantity::trigger, 0, "left"},
      // Of an angle the word before, and what says nothing, are no object.
      {"head_rot_yaw_deg", Quantity::angle, 1, "head"},
      {"head_local_rot_pitch", Quantity::angle, 0, "head local"},
      {"head_angles_roll", Quantity::angle, 2, "head"},
      {"pitch", Quantity::angle, 0, ""},
      // A matrix has two digits from 0 to 3.
      {"head_m00", Quantity::matrix, 0, "head"},
      {"head_m33", Quantity::matrix, 33, "head"},
      {"head_m34", Quantity::none, 0, ""},
      {"head_m0", Quantity::none, 0, ""},
      {"head_m111", Quantity::none, 0, ""},
      {"head_t00", Quantity::none, 0, ""},
      {"00", Quantity::none, 0, ""},
      {"head_rotation_rx", Quantity::quaternion, 1, "head rotation"},
      // Of a rotation two words may say what it is, of a position one.
      {"head_rot_q_x", Quantity::quaternion, 1, "head"},
      {"head_rotation_euler_y", Quantity::angle, 1, "head"},
      {"head_t_pos_x", Quantity::position, 0, "head t"},
      {"p_position_x", Quantity::position, 0, "p"},
      {"rot_x", Quantity::quaternion, 1, ""},
      {"x", Quantity::position, 0, ""},
      {"w", Quantity::quaternion, 0, ""},
      {"deg", Quantity::none, 0, ""},
  });
}

TEST(ColumnNames, EndWhereTheirTextEnds) {
  EXPECT_THAT(words_of(std::string_view("HMDx").substr(0, 3)), ElementsAre("hmd"));
  EXPECT_THAT(words_of("HMDx"), ElementsAre("hm", "dx"));
}

// The bytes of one sign were of two words.
TEST(ColumnNames, KeepSignsOfUtf8Whole) {
  EXPECT_THAT(words_of("\u0100\u0100_x"), ElementsAre("\u0100\u0100", "x"));
  EXPECT_THAT(words_of("x \u00b5m"), ElementsAre("x", "\u00b5", "m"));
  EXPECT_THAT(words_of("\u982d\u90e8.x"), ElementsAre("\u982d\u90e8", "x"));
  EXPECT_THAT(words_of("x \xb5m"), ElementsAre("x", "\xb5", "m"));  // of Latin 1
}

TEST(ColumnNames, SayAHandByItsLetterAlone) {
  EXPECT_EQ(part_of_name("smart glasses"), 0u);
  EXPECT_EQ(part_of_name("viewer"), 0u);
  EXPECT_EQ(part_of_name("head"), 0u);
  EXPECT_EQ(part_of_name("ctrl r"), 2u);
  EXPECT_EQ(part_of_name("rhand"), 2u);
  EXPECT_EQ(part_of_name("lhand"), 1u);
  EXPECT_EQ(part_of_name("review"), std::nullopt);
  EXPECT_EQ(part_of_name("rl"), std::nullopt);
}

// "r" behind a letter beyond ASCII was the right hand.
TEST(ColumnNames, KeepSmallLettersWithLatinLettersBeforeThem) {
  EXPECT_THAT(words_of("T\u00fcr_x"), ElementsAre("t\u00fcr", "x"));
  EXPECT_THAT(words_of("\u00d6l.x"), ElementsAre("\u00d6l", "x"));
  EXPECT_THAT(words_of("Tu\u0308r_x"), ElementsAre("tu\u0308r", "x"));  // two signs, one letter
  EXPECT_THAT(words_of("\u1ed3l_x"), ElementsAre("\u1ed3l", "x"));
  EXPECT_THAT(words_of("T\xfcr_x"), ElementsAre("t\xfcr", "x"));  // of Latin 1
  EXPECT_EQ(part_of_name("T\u00fcr"), std::nullopt);
  EXPECT_EQ(part_of_name("\u00d6l"), std::nullopt);
  EXPECT_EQ(part_of_name("G\u00e9r\u00e9 r"), 2u);
}

TEST(ColumnNames, BeginAWordBehindOtherSignsBeyondAscii) {
  for (const char* sign : {"\u00b5", "\u00b0", "\u00d7", "\u00f7", "\u2013", "\u00a0", "\u4f4d",
                           "\u03b1", "\u0434", "\u02da"}) {
    EXPECT_THAT(words_of(fmt::format("a {}x", sign)), ElementsAre("a", sign, "x"));
  }
  EXPECT_THAT(words_of("Men\u00fcX"), ElementsAre("men\u00fc", "x"));
  EXPECT_THAT(words_of("T\u00fcr2"), ElementsAre("t\u00fcr", "2"));
  EXPECT_EQ(component_of("\u982d\u90e8x").quantity, Quantity::position);
}

TEST(Markers, OfTheDayAreOfTheDayThatIsNearestToTheRecording) {
  const std::string text =
      "23:59:57.5 grab\n23:59:58.5 release\n23:59:59.5 grab\n00:00:02 release\n";
  const auto tenths_near = [&](double near_s) {
    std::vector<std::int64_t> found;
    for (const Stamped<bool>& marker : parse_markers(text, "m.csv", 1.0, microseconds(near_s)))
      found.push_back(marker.time.count() / 100'000);
    return found;
  };
  EXPECT_THAT(tenths_near(86'399.0), ElementsAre(863'975, 863'985, 863'995, 864'020));
  EXPECT_THAT(tenths_near(2.0), ElementsAre(-25, -15, -5, 20));
  // Numbers and dates are as they are.
  const auto as_told = parse_markers("3.5 grab\n1970-01-01T00:00:04 release\n", "m.csv", 1.0,
                                     microseconds(86'399.0));
  EXPECT_EQ(as_told.at(0).time, Time{3'500'000});
  EXPECT_EQ(as_told.at(1).time, Time{4'000'000});
}

}  // namespace
}  // namespace headpin::devices
