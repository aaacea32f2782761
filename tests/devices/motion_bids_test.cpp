#include "devices/recordings/motion_bids.h"

#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/recordings/motion_files.h"
#include "tests/support/folder.h"

namespace headpin::devices {
namespace {

using testing::HasSubstr;

const std::string kBidsHeader = "name\tcomponent\ttype\ttracked_point\tunits";

/// Channels of a point with places and angles, and their reference frame where there is one.
std::string point_channels(const std::string& point, const std::string& frame) {
  std::string text;
  for (const char* axis : {"x", "y", "z"}) {
    text += point + "_p" + axis + "\t" + axis + "\tPOS\t" + point + "\tm" + frame + "\n";
  }
  for (const char* axis : {"x", "y", "z"}) {
    text += point + "_r" + axis + "\t" + axis + "\tORNT\t" + point + "\tdeg" + frame + "\n";
  }
  return text;
}

/// A rotation by Rodrigues' formula, counted by the right hand in our right-handed frame.
Mat3 turn_about(const Vec3& axis, double angle) {
  Mat3 cross;
  cross << 0, -axis.z(), axis.y(), axis.z(), 0, -axis.x(), -axis.y(), axis.x(), 0;
  return Mat3::Identity() + std::sin(angle) * cross + (1 - std::cos(angle)) * cross * cross;
}

Vec3 letter_axis(char letter) {
  static const std::map<char, Vec3> kDirections = {{'R', Vec3(1, 0, 0)}, {'L', Vec3(-1, 0, 0)},
                                                   {'S', Vec3(0, 1, 0)}, {'I', Vec3(0, -1, 0)},
                                                   {'P', Vec3(0, 0, 1)}, {'A', Vec3(0, 0, -1)}};
  return kDirections.at(letter);
}

// A rule says how a turn about a direction of the room looks, whatever the axes: the thumb of that hand
// points along the axis, its fingers along the turn. Without a rule it is the hand of the axes.
TEST(MotionBids, AnglesTurnByTheirRuleInAxesOfEitherHand) {
  const Vec3 degrees(35, -50, 110);
  for (const std::string axes : {"RSP", "ALS", "RSA", "ARS", "LIA", "PSR"}) {
    const bool left_axes =
        letter_axis(axes[0]).cross(letter_axis(axes[1])).dot(letter_axis(axes[2])) < 0.0;
    for (const std::optional<bool> left :
         {std::optional<bool>(), std::optional(false), std::optional(true)}) {
      for (const std::string order : {"ZXY", "XYZ"}) {
        const double sign = left.value_or(left_axes) ? -1.0 : 1.0;
        Mat3 expected = Mat3::Identity();
        for (const char letter : order) {
          const auto i = static_cast<std::size_t>(letter - 'X');
          const double angle = sign * degrees[letter - 'X'] * std::numbers::pi / 180.0;
          expected = Mat3(turn_about(letter_axis(axes[i]), angle) * expected);
        }
        const MotionTracks read = parse_motion_bids(
            "0\t0\t0\t35\t-50\t110\n", kBidsHeader + "\n" + point_channels("head", ""), "x",
            {.axes = axes, .rotation_order = order, .left_handed = left, .rate_hz = 100.0});
        const Quat q = read.tracks.at(0).second.samples().at(0).value.q;
        EXPECT_LT((q.toRotationMatrix() - expected).norm(), 1e-12) << axes << " " << order << " "
                                                                   << (!left   ? "no rule"
                                                                       : *left ? "left"
                                                                               : "right");
      }
    }
  }
}

std::string levels_of(const std::string& levels) {
  return R"({"reference_frame":{"Levels":{)" + levels + "}}}";
}

const std::string kRoom =
    R"("room":{"SpatialAxes":"ALS","RotationRule":"right-hand","RotationOrder":"ZXY"})";
const std::string kBody =
    R"("body":{"SpatialAxes":"RSA","RotationRule":"left-hand","RotationOrder":"ZYX"})";

TEST(MotionBids, TheReferenceFrameIsTheOneThatTheChannelsName) {
  const std::string header = kBidsHeader + "\treference_frame\n";
  const auto named = [&](const std::string& name) {
    return header + "t\tn/a\tLATENCY\tn/a\ts\tn/a\n" + point_channels("head", "\t" + name) +
           "g\tx\tGYRO\thead\trad/s\tbody\n";
  };
  const std::string both = levels_of(kBody + "," + kRoom);
  const BidsFrame room = bids_frame(named("room"), both, "x");
  EXPECT_EQ(room.axes, "ALS");
  EXPECT_EQ(room.rotation_order, "ZXY");
  EXPECT_EQ(room.left_handed, false);
  const BidsFrame body = bids_frame(named("body"), both, "x");
  EXPECT_EQ(body.axes, "RSA");
  EXPECT_EQ(body.rotation_order, "ZYX");
  EXPECT_EQ(body.left_handed, true);
  const BidsFrame unknown = bids_frame(named("hall"), both, "x");
  EXPECT_EQ(unknown.name, "hall");
  EXPECT_EQ(unknown.axes, "");
  EXPECT_FALSE(unknown.left_handed);
  EXPECT_EQ(bids_frame(named("room"), "", "x").axes, "");
}

TEST(MotionBids, AnUnclearReferenceFrameIsRefused) {
  const std::string both = levels_of(kBody + "," + kRoom), bare = kBidsHeader + "\n",
                    header = kBidsHeader + "\treference_frame\n";
  const auto said = [](const std::string& channels, const std::string& levels) {
    return complaint([&] { bids_frame(channels, levels, "x"); });
  };
  // No column: one level, or several of one meaning, are clear.
  EXPECT_EQ(said(bare + point_channels("head", ""), levels_of(kRoom)), "");
  EXPECT_EQ(said(bare + point_channels("head", ""),
                 levels_of(kRoom + "," + R"("hall")" + kRoom.substr(kRoom.find(':')))),
            "");
  EXPECT_THAT(said(bare + point_channels("head", ""), both),
              HasSubstr("x: ..._channels.json describes the reference frames 'body' and 'room', "
                        "which differ: expected a column reference_frame in ..._channels.tsv"));
  EXPECT_THAT(said(header + point_channels("head", "\tn/a"), both), HasSubstr("which differ"));
  // One point in two frames.
  EXPECT_THAT(
      said(header + point_channels("head", "\troom") + "q\tx\tORNT\thead\tdeg\tbody\n", both),
      HasSubstr("channels of x:8: reference_frame of tracked point head: expected one for "
                "its POS and ORNT channels, found 'room' and 'body'"));
  // Points in two frames.
  EXPECT_THAT(
      said(header + point_channels("head", "\troom") + point_channels("hand", "\tbody"), both),
      HasSubstr("x: expected most tracked points in reference frames with the same axes and "
                "rotations, found head in 'room' and hand in 'body'"));
}

TEST(MotionBids, AFileIsReadInTheFrameThatItsChannelsName) {
  const std::filesystem::path folder = fresh_folder("bids");
  std::string channels = kBidsHeader + "\treference_frame\nt\tn/a\tLATENCY\tn/a\ts\tn/a\n";
  std::string first = "0", second = "0.01";
  for (const char* point : {"head", "right_hand", "eye"}) {
    channels += point_channels(point, point == std::string("eye") ? "\tbody" : "\troom");
    for (std::string* row : {&first, &second}) *row += "\t1\t2\t3\t0\t0\t90";
  }
  spit(folder / "a_motion.tsv", first + "\n" + second + "\n");
  spit(folder / "a_channels.tsv", channels);
  spit(folder / "a_channels.json", levels_of(kBody + "," + kRoom));
  const MotionRecording read = read_motion(folder / "a_motion.tsv", {});
  EXPECT_THAT(read.notes, testing::Contains("eye is not in the reference frame 'room': left out"));
  const Pose head = read.head.at(0);
  EXPECT_LT((head.p - Vec3(-2, 3, -1)).norm(), 1e-12);                  // ahead 1, left 2, up 3
  EXPECT_LT((head.q * Vec3(0, 0, -1) - Vec3(-1, 0, 0)).norm(), 1e-12);  // a turn to the left
  // The rule also holds in axes that the user says.
  const MotionOptions told{.reading = {.axes = "RSA"}};
  const Pose mirrored = read_motion(folder / "a_motion.tsv", told).head.at(0);
  EXPECT_LT((mirrored.p - Vec3(1, 2, -3)).norm(), 1e-12);
  // About ahead by the right hand: up goes to the right.
  EXPECT_LT((mirrored.q * Vec3(0, 1, 0) - Vec3(1, 0, 0)).norm(), 1e-12);
  spit(folder / "a_channels.json", levels_of(kBody));
  EXPECT_THAT(complaint([&] { read_motion(folder / "a_motion.tsv", {}); }),
              HasSubstr("expected SpatialAxes of reference frame 'room' in"));
}

/// Channels of head and right hand with quaternions, and of a ball with a place alone.
std::string channels_with_a_ball() {
  std::string text = kBidsHeader + "\nt\tn/a\tLATENCY\tn/a\ts\n";
  for (const std::string point : {"head", "right_hand", "ball"}) {
    for (const std::string axis : {"x", "y", "z"})
      text += point + axis + "\t" + axis + "\tPOS\t" + point + "\tm\n";
    if (point == "ball") continue;
    for (const std::string axis : {"w", "x", "y", "z"})
      text += point + "q" + axis + "\tquat_" + axis + "\tORNT\t" + point + "\tn/a\n";
  }
  return text;
}

/// A row at a time [s] whose hand has this w in its quaternion.
std::string row_of(const std::string& time, const std::string& w) {
  return time + "\t0\t1.6\t0\t1\t0\t0\t0\t0.2\t1\t0\t" + w + "\t0\t0\t0\t5\t5\t5\n";
}

// A ball's marker has no rotation, which refused the file.
TEST(MotionBids, APointThatIsNoHeadOrHandNeedsNoRotation) {
  const std::string rows = row_of("0", "1") + row_of("0.01", "1");
  const MotionTracks read = parse_motion_bids(rows, channels_with_a_ball(), "x", {.axes = "RSP"});
  ASSERT_EQ(read.tracks.size(), 2u);
  EXPECT_EQ(read.tracks[1].second.samples().size(), 2u);
  EXPECT_THAT(
      read.notes,
      testing::ElementsAre("tracked point ball: expected x, y, z and a whole quaternion, or three "
                           "angles: left out"));
  EXPECT_THAT(
      complaint([&] {
        parse_motion_bids(rows, channels_with_a_ball(), "x", {.axes = "RSP"}, {"head", "", "ball"});
      }),
      HasSubstr("x: tracked point ball: expected x, y, z and a whole quaternion"));
}

TEST(MotionBids, AFewSamplesWithoutAUnitQuaternionAreLeftOut) {
  const std::string good = row_of("0", "1") + row_of("0.01", "1");
  const MotionTracks read =
      parse_motion_bids(good + row_of("0.02", "0"), channels_with_a_ball(), "x", {.axes = "RSP"});
  EXPECT_EQ(read.tracks[0].second.samples().size(), 3u);
  EXPECT_EQ(read.tracks[1].second.samples().size(), 2u);
  EXPECT_THAT(read.notes, testing::Contains(
                              "1 samples of right_hand have no unit quaternion (the first, in line "
                              "3, one of length 0): left out"));
}

/// Channels of points with places and quaternions.
std::string quaternion_channels(const std::vector<std::string>& points) {
  std::string text = kBidsHeader + "\n";
  for (const std::string& point : points) {
    for (const char* axis : {"x", "y", "z"})
      text += fmt::format("{0}{1}\t{1}\tPOS\t{0}\tm\n", point, axis);
    for (const char* axis : {"w", "x", "y", "z"})
      text += fmt::format("{0}q{1}\tquat_{1}\tORNT\t{0}\tn/a\n", point, axis);
  }
  return text;
}

std::vector<std::int64_t> times_in(const MotionTracks& read, std::size_t track = 0) {
  std::vector<std::int64_t> times;
  for (const auto& sample : read.tracks.at(track).second.samples())
    times.push_back(sample.time.count());
  return times;
}

TEST(MotionBids, WithoutLatencyRowsComeAtTheSamplingFrequency) {
  const std::string row = "1\t2\t3\t1\t0\t0\t0\n";
  const auto read = [&](double rate_hz) {
    return parse_motion_bids(row + row + row, quaternion_channels({"head"}), "x",
                             {.axes = "RSP", .rate_hz = rate_hz});
  };
  EXPECT_THAT(times_in(read(100.0)), testing::ElementsAre(0, 10'000, 20'000));
  EXPECT_THAT(times_in(read(0.5)), testing::ElementsAre(0, 2'000'000, 4'000'000));
  for (const double none : {0.0, -100.0, 1e6, 1e9}) {
    EXPECT_THAT(complaint([&] { read(none); }), HasSubstr("x: no times: expected a LATENCY"))
        << none;
  }
  EXPECT_EQ(complaint([&] { read(1e-300); }),
            "x:2: time by SamplingFrequency: expected -1e10 to 1e10 s, found 1e+300");
}

TEST(MotionBids, ASampleWithAnyUnknownNumberIsLeftOut) {
  const std::vector<std::string> numbers = {"1", "2", "3", "1", "0", "0", "0"};
  const auto rows = [&](std::size_t columns) {  // the n-th row has n/a at n, the last one nowhere
    std::string text;
    for (std::size_t row = 0; row <= columns; ++row) {
      for (std::size_t i = 0; i < columns; ++i)
        text += fmt::format("{}{}", i == 0 ? "" : "\t", i == row ? "n/a" : numbers[i]);
      text += "\n";
    }
    return text;
  };
  const MotionTracks quaternions = parse_motion_bids(rows(7), quaternion_channels({"head"}), "x",
                                                     {.axes = "RSP", .rate_hz = 1.0});
  EXPECT_THAT(times_in(quaternions), testing::ElementsAre(7'000'000));
  EXPECT_THAT(quaternions.notes, testing::ElementsAre(HasSubstr("7 samples are n/a")));
  const MotionTracks angles =
      parse_motion_bids(rows(6), kBidsHeader + "\n" + point_channels("head", ""), "x",
                        {.axes = "RSP", .rotation_order = "XYZ", .rate_hz = 1.0});
  EXPECT_THAT(times_in(angles), testing::ElementsAre(6'000'000));
  EXPECT_THAT(angles.notes, testing::ElementsAre(HasSubstr("6 samples are n/a")));
}

TEST(MotionBids, APointIsRefusedIfMoreThanHalfOfItsRowsHaveNoUnitQuaternion) {
  const auto read = [](int bad) {
    std::string rows;
    for (int i = 0; i < 4; ++i) rows += row_of(fmt::format("{}", i), i < bad ? "0.5" : "1");
    return parse_motion_bids(rows, channels_with_a_ball(), "x", {.axes = "RSP"});
  };
  EXPECT_THAT(times_in(read(2), 1), testing::ElementsAre(2'000'000, 3'000'000));
  EXPECT_THAT(read(2).notes, testing::Contains(HasSubstr("2 samples of right_hand have no unit")));
  EXPECT_THAT(
      complaint([&] { read(3); }),
      HasSubstr("x:1: right_hand: expected a unit quaternion, found one of length 0.5; 3 of "
                "4 rows have none"));
}

TEST(MotionBids, PointsOfOtherFramesAreNotRead) {
  const std::string row = "1\t2\t3\t1\t0\t0\t0";
  const MotionTracks read =
      parse_motion_bids(row + "\t" + row + "\n", quaternion_channels({"head", "eye"}), "x",
                        {.name = "room", .axes = "RSP", .others = {"eye"}, .rate_hz = 1.0});
  ASSERT_EQ(read.tracks.size(), 1u);
  EXPECT_EQ(read.tracks[0].first, "head");
}

// Which points a recording cannot do without.
TEST(MotionBids, APointThatIsNotWholeIsRefusedOnlyWhereNoOtherTakesItsPart) {
  const auto read = [](const std::vector<std::string>& whole, const std::string& broken,
                       const std::array<std::string, 3>& names = {}) {
    std::string row;
    for (std::size_t i = 0; i < whole.size(); ++i) row += "1\t2\t3\t1\t0\t0\t0\t";
    return complaint([&] {
      parse_motion_bids(row + "9\n",
                        quaternion_channels(whole) + fmt::format("b\tx\tPOS\t{}\tm\n", broken), "x",
                        {.axes = "RSP", .rate_hz = 1.0}, names);
    });
  };
  const auto refused = [](const std::string& point) {
    return HasSubstr("x: tracked point " + point + ": expected x, y, z and a whole quaternion");
  };
  EXPECT_EQ(read({"head", "right_hand"}, "left_hand"), "");
  EXPECT_EQ(read({"head", "left_hand"}, "right_hand"), "");
  EXPECT_EQ(read({"head", "left_hand"}, "hmd"), "");
  EXPECT_THAT(read({"head"}, "right_hand"), refused("right_hand"));
  EXPECT_THAT(read({"head", "ball"}, "right_hand"), refused("right_hand"));
  EXPECT_THAT(read({"left_hand", "right_hand"}, "head"), refused("head"));
  // Where the user names points, it is those.
  const std::array<std::string, 3> told = {"cap", "", "glove"};
  EXPECT_EQ(read({"cap", "glove"}, "right_hand", told), "");
  EXPECT_EQ(read({"cap", "glove"}, "head", told), "");
  EXPECT_THAT(read({"cap"}, "glove", told), refused("glove"));
  EXPECT_THAT(read({"cap"}, "suit:glove", told), refused("suit:glove"));
}

TEST(MotionBids, FramesOfOneMeaningAreOneAndThoseThatDifferInAnythingAreTwo) {
  const std::string bare = kBidsHeader + "\n" + point_channels("head", "");
  const std::string room = kRoom + R"(,"hall":{"SpatialAxes":")";
  const auto said = [&](const std::string& hall) {
    return complaint([&] { bids_frame(bare, levels_of(room + hall), "x"); });
  };
  EXPECT_EQ(said(R"(ALS","RotationRule":"right-hand","RotationOrder":"ZXY"})"), "");
  for (const char* other : {R"(ARS","RotationRule":"right-hand","RotationOrder":"ZXY"})",
                            R"(ALS","RotationRule":"left-hand","RotationOrder":"ZXY"})",
                            R"(ALS","RotationRule":"right-hand","RotationOrder":"ZYX"})",
                            R"(ALS","RotationRule":"right-hand"})",
                            R"(ALS","RotationRule":"n/a","RotationOrder":"ZXY"})"}) {
    EXPECT_THAT(said(other), HasSubstr("which differ")) << other;
  }
  // Points in differently named frames of one meaning are together.
  const std::string header = kBidsHeader + "\treference_frame\n";
  const std::string both = levels_of(kRoom + "," + R"("hall")" + kRoom.substr(kRoom.find(':')));
  const BidsFrame frame = bids_frame(
      header + point_channels("head", "\troom") + point_channels("hand", "\thall"), both, "x");
  EXPECT_EQ(frame.axes, "ALS");
  EXPECT_THAT(frame.others, testing::IsEmpty());
}

TEST(MotionBids, QuaternionsNeedNoOrderAndNoRuleOfAngles) {
  const std::string other = R"(,"hall":{"SpatialAxes":"ALS",)";
  for (const char* rotations : {R"("RotationRule":"right-hand","RotationOrder":"XYZ"})",
                                R"("RotationRule":"left-hand","RotationOrder":"ZXY"})"}) {
    const BidsFrame frame =
        bids_frame(quaternion_channels({"head"}), levels_of(kRoom + other + rotations), "x");
    EXPECT_EQ(frame.axes, "ALS");
    EXPECT_EQ(frame.rotation_order, "");
    EXPECT_FALSE(frame.left_handed);
  }
}

// Whatever else a ..._channels.json holds, it says no axes.
TEST(MotionBids, AJsonThatDescribesNoFramesSaysNothing) {
  const std::string channels =
      kBidsHeader + "\treference_frame\n" + point_channels("head", "\troom");
  for (const std::string json :
       {"", "{", "[]", "[\"reference_frame\"]", "7", "{}", R"({"Levels":{}})",
        R"({"reference_frame":7})", R"({"reference_frame":"Levels"})",
        R"({"reference_frame":["Levels"]})", R"({"reference_frame":{}})",
        R"({"reference_frame":{"Levels":7}})", R"({"reference_frame":{"Levels":["room"]}})"}) {
    const BidsFrame frame = bids_frame(channels, json, "x");
    EXPECT_EQ(frame.name, "room") << json;
    EXPECT_EQ(frame.axes, "") << json;
  }
  for (const std::string level : {"7", "\"SpatialAxes\"", "[\"SpatialAxes\"]", "{}", "null",
                                  R"({"SpatialAxes":7,"RotationOrder":null,"RotationRule":[]})"}) {
    const BidsFrame frame = bids_frame(channels, levels_of("\"room\":" + level), "x");
    EXPECT_EQ(frame.axes + frame.rotation_order, "") << level;
    EXPECT_FALSE(frame.left_handed) << level;
  }
}

// MATLAB and pandas write NaN, some systems a number that they do not measure.
TEST(MotionBids, WhatTheFileSaysOfMissingValuesIsLeftOutAsNaIs) {
  const std::string channels = "t\tn/a\tLATENCY\tn/a\ts\n";
  const auto read = [&](const std::string& missing, const std::string& cell) {
    std::string rows;
    for (int i = 0; i < 4; ++i)
      rows += fmt::format("1\t{}\t3\t1\t0\t0\t0\t0.0{}\n", i == 2 ? cell : "2", i);
    return parse_motion_bids(rows, quaternion_channels({"head"}) + channels, "x",
                             {.axes = "RSP", .missing = missing});
  };
  for (const auto& [missing, cell] : {std::pair("NaN", "NaN"),
                                      {"NaN", "nan"},
                                      {"NaN", "n/a"},
                                      {"-9999", "-9999.0"},
                                      {"lost", "lost"}}) {
    const MotionTracks found = read(missing, cell);
    EXPECT_THAT(times_in(found), testing::ElementsAre(0, 10'000, 30'000)) << missing;
    EXPECT_THAT(found.notes,
                testing::ElementsAre(fmt::format(
                    "1 samples are n/a or {0}, or have n/a or {0} in them: left out", missing)));
  }
  for (const char* missing : {"", "n/a", "-9999"}) {
    EXPECT_THAT(complaint([&] { read(missing, "NaN"); }),
                HasSubstr("x:3: heady: expected a finite number, found 'NaN'"))
        << missing;
  }
}

// A quaternion that does not turn has three zeros, and the first row is at time 0.
TEST(MotionBids, WhereZerosAreMissingValuesAUnitQuaternionAndTheFirstTimeMayHaveZeros) {
  const std::string channels = quaternion_channels({"head"}) + "t\tn/a\tLATENCY\tn/a\ts\n";
  const BidsFrame frame{.axes = "RSP", .missing = "0"};
  const MotionTracks read = parse_motion_bids(
      "1\t2\t3\t1\t0\t0\t0\t0\n"
      "0\t0\t0\t1\t0\t0\t0\t0.01\n"
      "1\t2\t3\t0\t0\t0\t0\t0.02\n"
      "1\t2\t3\t0\t1\t0\t0\t0.03\n"
      "1\t2\t3\t1\t0\t0\t0\t0\n"
      "1\t0.0\t3\t1\t0\t0\t0\t0.04\n",
      channels, "x", frame);
  EXPECT_THAT(times_in(read), testing::ElementsAre(0, 30'000));
  EXPECT_THAT(read.notes, testing::ElementsAre(HasSubstr("4 samples are n/a or 0")));
  // Zeros in place of some of its numbers leave no unit quaternion: not known, also where most are so.
  const MotionTracks parts = parse_motion_bids(
      "1\t2\t3\t0\t0.6\t0\t0\t0\n"
      "1\t2\t3\t0\t0.6\t0\t0\t0.01\n"
      "1\t2\t3\t0\t0.6\t0.8\t0\t0.02\n",
      channels, "x", frame);
  EXPECT_THAT(times_in(parts), testing::ElementsAre(20'000));
  EXPECT_THAT(parts.notes, testing::ElementsAre(HasSubstr("2 samples are n/a or 0")));
  // Before time 0, a 0 may be measured.
  const MotionTracks before = parse_motion_bids(
      "1\t2\t3\t1\t0\t0\t0\t-0.01\n"
      "1\t2\t3\t1\t0\t0\t0\t0\n"
      "1\t2\t3\t1\t0\t0\t0\t0.01\n",
      channels, "x", frame);
  EXPECT_THAT(times_in(before), testing::ElementsAre(-10'000, 0, 10'000));
}

// What the file says holds for each place and angle: one that is 0 was not measured, and n/a is its sample.
TEST(MotionBids, WhereZerosAreMissingValuesAnAngleOrAPlaceOfZeroIsNotKnown) {
  const std::string rows =
      "1\t2\t3\t10\t20\t30\n"
      "1\t2\t3\t0\t0\t0\n"
      "1\t2\t3\t10\t-0.0\t30\n"
      "0\t2\t3\t10\t20\t30\n"
      "1\t2\t3\t10\t20\tn/a\n"
      "1\t2\t3\t10\t20\t30\n";
  const auto read = [&](const std::string& missing, bool turns = true) {
    return parse_motion_bids(
        rows, kBidsHeader + "\n" + point_channels("head", ""), "x",
        {.axes = "RSP", .rotation_order = "ZXY", .rate_hz = 100.0, .missing = missing}, {}, turns);
  };
  for (const char* missing : {"0", "0.0", "-0"}) {
    EXPECT_THAT(times_in(read(missing)), testing::ElementsAre(0, 50'000)) << missing;
    EXPECT_THAT(read(missing).notes,
                testing::ElementsAre(HasSubstr(fmt::format("4 samples are n/a or {}", missing))));
  }
  EXPECT_THAT(times_in(read("20")), testing::ElementsAre(10'000, 20'000));
  EXPECT_THAT(times_in(read("")), testing::ElementsAre(0, 10'000, 20'000, 30'000, 50'000));
  // Where angles are not read, none of them needs to be known.
  EXPECT_THAT(times_in(read("0", false)), testing::ElementsAre(0, 10'000, 20'000, 40'000, 50'000));
}

}  // namespace
}  // namespace headpin::devices
