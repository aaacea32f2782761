// By what a format is known, and which of its objects are head and hands.

#include <array>
#include <filesystem>
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

class MotionFormats : public testing::Test {
 protected:
  /// The format's name; empty if it is none.
  std::string format_with(const std::string& name, const std::string& text) const {
    spit(folder / name, text);
    const MotionFormat* const format = format_of(folder / name);
    return std::string(format ? format->name : "");
  }
  std::string refusal_of(const std::string& name, const MotionOptions& options = {}) const {
    return complaint([&] { read_motion(folder / name, options); });
  }
  /// A file of an object in UXF that stays at a height [m].
  void write_object(const std::string& name, double height) const {
    spit(folder / (name + "_movement_T001.csv"),
         fmt::format(
             "time,pos_x,pos_y,pos_z,rot_x,rot_y,rot_z\n0,0,{0},0,0,0,0\n0.01,0,{0},0,0,0,0\n"
             "0.02,0,{0},0,0,0,0\n",
             height));
  }

  const std::filesystem::path folder = fresh_folder("formats");
};

TEST_F(MotionFormats, ATableIsTextWithThreeSeparatorsOfOneKindAndADigitInALine) {
  for (const char* table : {"0,0,0,0", "9;9;9;9", "a\tb\tc\t5", "a|1|b|c", "1 2 3 4",
                            "# by a program\n\nt,x,y,z\n0.1,2,3,4\n"}) {
    EXPECT_EQ(format_with("x", table), "table") << table;
  }
  for (const char* none : {"1,2,3", "1,2;3|4", "a,b,c,d", "/,/,/,/", ":,:,:,:", "a,b,c,d\n1,2,3"}) {
    EXPECT_EQ(format_with("x", none), "") << none;
  }
  EXPECT_EQ(format_with("x", std::string("1,2,3,4\0", 8)), "");
}

TEST_F(MotionFormats, AFileOfUxfHasItsNameAndItsColumns) {
  const std::string rows = "time,pos_x,pos_y,pos_z\n0,1,2,3\n", others = "t,x,y,z\n0,1,2,3\n";
  EXPECT_EQ(format_with("head_movement_T001.csv", rows), "UXF");
  EXPECT_EQ(format_with("head.csv", rows), "table");
  EXPECT_EQ(format_with("head_movement_T001.txt", rows), "table");
  EXPECT_EQ(format_with("head_movement_T001.csv", others), "table");
  EXPECT_EQ(format_with("a_motion.tsv", "1"), "Motion-BIDS");
}

// Whatever the order of the folder's entries, and what else is in it.
TEST_F(MotionFormats, TheObjectsOfAUxfFolderAreItsTrackersByName) {
  const std::vector<std::string> objects = {"beta", "zeta", "alpha", "iota",   "eta",  "theta",
                                            "mu",   "nu",   "gamma", "lambda", "delta"};
  for (const std::string& object : objects) write_object(object, 1.0);
  spit(folder / "notes.csv", "a,b\n");
  spit(folder / "head_movement_T001.txt", "no tracker\n");
  spit(folder / "settings.json", "{}");
  EXPECT_EQ(refusal_of("."),
            (folder / ".").string() +
                ": expected one head among alpha, beta, delta, eta, gamma, iota, lambda, mu, nu, "
                "theta, zeta; found 0");
  const MotionRecording read = read_motion(folder, {.names = {"mu", "nu", "eta"}});
  EXPECT_EQ(read.times.size(), 3u);
  EXPECT_EQ(read.reading.axes, "RSA");  // Unity's
  EXPECT_EQ(read.reading.turning, "RSA");
}

TEST_F(MotionFormats, SettingsBesideMotionBidsThatSayNoRateAreNone) {
  std::string channels = "name\tcomponent\ttype\ttracked_point\tunits\n", row;
  for (const char* point : {"head", "right_hand"}) {
    for (const char* axis : {"x", "y", "z"})
      channels += fmt::format("n\t{}\tPOS\t{}\tm\n", axis, point);
    row += fmt::format("{}1\t2\t3", row.empty() ? "" : "\t");
  }
  spit(folder / "a_motion.tsv", row + "\n" + row + "\n");
  spit(folder / "a_channels.tsv", channels);
  const MotionOptions options{.reading = {.axes = "RSP"}, .rotations = "none"};
  EXPECT_THAT(refusal_of("a_motion.tsv", options), HasSubstr("no times: expected a LATENCY"));
  for (const char* json :
       {"", "{", "null", "[]", "7", "\"SamplingFrequency\"", "{}", R"(["SamplingFrequency"])",
        R"({"SamplingFrequency":"100"})", R"({"SamplingFrequency":null})"}) {
    spit(folder / "a_motion.json", json);
    EXPECT_THAT(refusal_of("a_motion.tsv", options), HasSubstr("no times: expected a LATENCY"))
        << json;
  }
  spit(folder / "a_motion.json", R"({"SamplingFrequency":50})");
  EXPECT_EQ(read_motion(folder / "a_motion.tsv", options).times.at(1), Time{20'000});
}

TEST_F(MotionFormats, AnUnknownFileIsToldByHowItBegins) {
  const auto said = [&](const std::string& text) {
    spit(folder / "x", text);
    const std::string all = refusal_of("x");
    const std::size_t begin = all.find("seems to be ") + 12;
    return all.substr(begin, all.find("; expected one of") - begin);
  };
  EXPECT_EQ(said("two words\n"), "text that begins with 'two words'");
  EXPECT_EQ(said("x"), "text that begins with 'x'");
  EXPECT_EQ(said("\tab\n"), "text that begins with 'ab'");
  EXPECT_EQ(said("AP\n"), "text that begins with 'AP'");
  EXPECT_EQ(said(" P x\n"), "text that begins with 'P x'");
  EXPECT_EQ(said("\x1fP"), "C3D");
  EXPECT_EQ(said("name\tage\nBob\t5\n"), "TSV that begins with 'name\tage'");
  EXPECT_EQ(said("name;age\nBob;5\n"), "CSV that begins with 'name;age'");
  EXPECT_EQ(said("a\x01"
                 "b\n"),
            "binary data");
  EXPECT_EQ(said("{\"a\": 1}"), "JSON");
  // Rows may stand behind what was looked at.
  std::string names = "name";
  while (names.size() <= 4096) names += ",name";
  EXPECT_THAT(said(names + "\n1,2,3\n"), testing::StartsWith("CSV that begins with 'name,name"));
}

// Where no head was recorded it stands at a place; the hand's times are those of the recording.
TEST_F(MotionFormats, AHeadThatWasNotRecordedStandsWhereTheUserSays) {
  const MotionOptions options{.p_origin = {0, 0.5, 0}, .p_head = Vec3(0.1, 1.7, 0.2)};
  for (const char* hand : {"leftHand", "rightHand"}) {
    std::filesystem::remove_all(folder);
    write_object(hand, 0.8);
    const MotionRecording read = read_motion(folder, options);
    ASSERT_EQ(read.head.size(), 3u) << hand;
    for (const Pose& head : read.head) EXPECT_LT((head.p - Vec3(0.1, 1.7, 0.2)).norm(), 1e-12);
    const auto& poses = hand[0] == 'l' ? read.left_hand : read.right_hand;
    ASSERT_EQ(poses.size(), 3u);
    EXPECT_LT((poses[0].p - Vec3(0, 1.3, 0)).norm(), 1e-12);
    EXPECT_FALSE(read.head_moves || read.head_turns);
    EXPECT_TRUE(read.hands_turn);
    EXPECT_EQ(read.p_origin, Vec3(0, 0.5, 0));
  }
  write_object("head", 1.6);
  const MotionRecording recorded = read_motion(folder, {});
  EXPECT_TRUE(recorded.head_moves && recorded.head_turns);
  EXPECT_EQ(recorded.head.at(0).p, Vec3(0, 1.6, 0));
  EXPECT_LT((read_motion(folder, options).head.at(0).p - Vec3(0.1, 1.7, 0.2)).norm(), 1e-12);
  // Without a hand nothing says when it stands there.
  std::filesystem::remove_all(folder);
  write_object("head", 1.6);
  MotionOptions alone = options;
  alone.no_hand = true;
  EXPECT_THAT(refusal_of(".", alone), HasSubstr("no samples of the head"));
}

TEST_F(MotionFormats, ARecordingOfTheHeadAloneIsReadWhereTheUserAcceptsIt) {
  write_object("head", 1.6);
  EXPECT_THAT(refusal_of("."), HasSubstr("expected one hand among head; found 0"));
  const MotionRecording read = read_motion(folder, {.no_hand = true});
  EXPECT_EQ(read.head.size(), 3u);
  EXPECT_TRUE(read.left_hand.empty() && read.right_hand.empty());
}

MotionTracks tracks_called(const std::vector<std::string>& names) {
  MotionTracks read;
  for (std::size_t i = 0; i < names.size(); ++i) {
    PoseTrack track;
    for (int k = 0; k < 3; ++k)
      track.push(Time{10'000 * k}, {Quat::Identity(), Vec3(static_cast<double>(i), 0, 0)});
    read.tracks.emplace_back(names[i], track);
  }
  return read;
}

TEST(MotionParts, AreThoseOfTheNumbersOnlyWhereNoNameSaysMore) {
  const MotionRecording numbers = recording_of(tracks_called({"a:0", "a:1", "a:2"}), {}, "x");
  EXPECT_EQ(numbers.head.at(0).p.x(), 0.0);
  EXPECT_EQ(numbers.left_hand.at(0).p.x(), 1.0);
  EXPECT_EQ(numbers.right_hand.at(0).p.x(), 2.0);
  const MotionRecording words =
      recording_of(tracks_called({"right hand:0", "head:1", "left hand:2"}), {}, "x");
  EXPECT_EQ(words.head.at(0).p.x(), 1.0);
  EXPECT_EQ(words.left_hand.at(0).p.x(), 2.0);
  EXPECT_EQ(words.right_hand.at(0).p.x(), 0.0);
  // Who names objects that are not there is not given others.
  EXPECT_THAT(complaint([&] {
                recording_of(tracks_called({"a:0", "a:1", "a:2"}), {.names = {"7", "", "8"}}, "x");
              }),
              HasSubstr("x: expected one head among a:0, a:1, a:2; found 0"));
}

// Of a system that lost samples or ran slow, the effective rate has the times of the rows.
TEST_F(MotionFormats, RowsOfMotionBidsComeAtTheEffectiveRateWhereItIsSaid) {
  std::string channels = "name\tcomponent\ttype\ttracked_point\tunits\n", row;
  for (const char* point : {"head", "right_hand"}) {
    for (const char* axis : {"x", "y", "z"})
      channels += fmt::format("n\t{}\tPOS\t{}\tm\n", axis, point);
    row += fmt::format("{}1\t2\t3", row.empty() ? "" : "\t");
  }
  const std::string lost_row = "NaN\t2\t3\tNaN\t2\t3";
  spit(folder / "a_motion.tsv", row + "\n" + row + "\n" + lost_row + "\n" + row + "\n");
  spit(folder / "a_channels.tsv", channels);
  const MotionOptions options{.reading = {.axes = "RSP"}, .rotations = "none"};
  const auto with = [&](const std::string& rates) {
    spit(folder / "a_motion.json", fmt::format(R"({{{}, "MissingValues": "NaN"}})", rates));
    return read_motion(folder / "a_motion.tsv", options);
  };
  const std::string nominal = R"("SamplingFrequency": 50)";
  const std::string effective = nominal + R"(, "SamplingFrequencyEffective": )";
  const MotionRecording lost = with(effective + "40");
  EXPECT_THAT(lost.times, testing::ElementsAre(Time{0}, Time{25'000}, Time{75'000}));
  EXPECT_THAT(lost.notes, testing::Contains("no LATENCY channel: 40 rows a second, as "
                                            "SamplingFrequencyEffective says"));
  EXPECT_THAT(lost.notes, testing::Contains(HasSubstr("2 samples are n/a or NaN")));
  for (const std::string& none :
       {nominal, effective + "0", effective + "-40", effective + "\"n/a\"", effective + "null"}) {
    const MotionRecording read = with(none);
    EXPECT_EQ(read.times.at(1), Time{20'000}) << none;
    EXPECT_THAT(read.notes, testing::Contains("no LATENCY channel: 50 rows a second, as "
                                              "SamplingFrequency says"));
  }
}

}  // namespace
}  // namespace headpin::devices
