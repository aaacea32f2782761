#include "devices/recordings/motion_files.h"

#include <bit>
#include <filesystem>
#include <fstream>
#include <random>
#include <stdexcept>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/recordings/motion_bids.h"
#include "devices/recordings/reading.h"
#include "devices/recordings/uxf.h"
#include "devices/recordings/vrpn_log.h"
#include "tests/support/folder.h"

namespace headpin::devices {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const Vec3 kRight = Vec3::UnitX(), kUp = Vec3::UnitY(), kAhead = -Vec3::UnitZ();

void expect_near(const Vec3& a, const Vec3& b) {
  EXPECT_LT((a - b).norm(), 1e-12) << a.transpose() << " and " << b.transpose();
}

// What Unity's axes and angles do is known from its manual: left-handed, y up, +z ahead.
TEST(MotionFiles, UnitysPosesAreTurnedRound) {
  const auto pose = [](const std::string& angles) {
    std::vector<std::string> notes;
    const PoseTrack track = parse_uxf(
        "time,pos_x,pos_y,pos_z,rot_x,rot_y,rot_z\n0.5,1,2,3," + angles + "\n", "x.csv", notes);
    EXPECT_TRUE(notes.empty());
    EXPECT_EQ(track.samples().at(0).time, Time{500'000});
    return track.samples().at(0).value;
  };
  expect_near(pose("0,0,0").p, Vec3(1, 2, -3));
  expect_near(pose("0,0,0").q * kAhead, kAhead);
  expect_near(pose("0,90,0").q * kAhead, kRight);                           // a turn to the right
  expect_near(pose("30,0,0").q * kAhead, Vec3(0, -0.5, -std::sqrt(0.75)));  // a look down
  expect_near(pose("0,0,90").q * kRight, kUp);                              // the right side up
  // First about z, then x, then y: the look down stays one after the turn.
  expect_near(pose("30,90,0").q * kAhead, Vec3(std::sqrt(0.75), -0.5, 0));
  expect_near(pose("90,0,90").q * kRight, kAhead);  // up by the roll, then ahead by the pitch down
}

TEST(MotionFiles, ABadTrackerFileIsRefusedByItsLine) {
  const std::string head = "time,pos_x,pos_y,pos_z,rot_x,rot_y,rot_z\n";
  const auto said = [&](const std::string& text) {
    std::vector<std::string> notes;
    return complaint([&] { parse_uxf(text, "x.csv", notes); });
  };
  EXPECT_THAT(said(""), HasSubstr("x.csv:1: expected the columns time, pos_x"));
  EXPECT_THAT(said("time,pos_x\n"), HasSubstr("pos_y is missing"));
  EXPECT_THAT(said(head + "0,1,2,3,4,5\n"), HasSubstr("x.csv:2: expected 7 fields, found 6"));
  EXPECT_THAT(said(head + "0,1,2,3,4,5,nan\n"), HasSubstr("rot_z: expected a finite number"));
  EXPECT_THAT(said(head + "0,1,2,3,4,5,1e300\n"), HasSubstr("rot_z: expected degrees"));
  EXPECT_THAT(said(head + "1,1,2,3,4,5,6\n0.9,1,2,3,4,5,6\n"), HasSubstr("time must advance"));
  EXPECT_EQ(said(head + "0,1,2,3,4,5,6,\n"), "");  // an empty last cell
  EXPECT_THAT(said(head + "1.7e12,1,2,3,4,5,6\n"),
              HasSubstr("x.csv:2: time: expected -1e10 to 1e10 s, found 1.7e+12"));
}

// Unity writes a frame twice now and then.
TEST(MotionFiles, ATrackersSampleAtTheTimeOfTheOneBeforeIsLeftOut) {
  std::vector<std::string> notes;
  const PoseTrack track = parse_uxf(
      "time,pos_x,pos_y,pos_z,rot_x,rot_y,rot_z\n1,1,2,3,4,5,6\n1,9,2,3,4,5,6\n2,1,2,3,4,5,6\n",
      "x.csv", notes);
  ASSERT_EQ(track.samples().size(), 2u);
  EXPECT_EQ(track.samples()[0].value.p.x(), 1.0);
  EXPECT_THAT(notes,
              testing::ElementsAre("x.csv: 1 samples are at the time of the one before: left out"));
}

// A file that was cut still reads as numbers: 12.5 as 12.
TEST(MotionFiles, ATrackerFileThatIsCutInsideItsLastNumberIsReadUpToThatLine) {
  const std::string whole =
      "time,pos_x,pos_y,pos_z,rot_x,rot_y,rot_z\n0,1,2,3,4,5,6\n1,1,2,3,4,5,12.5";
  for (const std::size_t cut : {0u, 1u, 3u, 6u}) {
    std::vector<std::string> notes;
    EXPECT_EQ(parse_uxf(whole.substr(0, whole.size() - cut), "x.csv", notes).samples().size(), 1u);
    ASSERT_EQ(notes.size(), 1u) << cut;
    EXPECT_THAT(notes[0], HasSubstr("x.csv: the last line has no end"));
  }
  std::vector<std::string> notes;
  EXPECT_EQ(parse_uxf(whole + "\n", "x.csv", notes).samples().size(), 2u);
  EXPECT_TRUE(notes.empty());
}

TEST(MotionFiles, AxesAreLettersAndEachPairOnce) {
  const Pose turned_left{Quat(std::sqrt(0.5), 0, 0, std::sqrt(0.5)), Vec3(1, 2, 3)};
  const Pose ours = Axes("ALS", "x").ours(turned_left);  // x ahead, y left, z up
  expect_near(ours.p, Vec3(-2, 3, -1));
  expect_near(ours.q * kAhead, -kRight);
  expect_near(ours.q * kUp, kUp);
  const Pose mirrored =
      Axes("RSA", "x").ours(Pose{Quat(std::sqrt(0.5), 0, std::sqrt(0.5), 0), Vec3::Zero()});
  expect_near(mirrored.q * kAhead, kRight);  // left-handed: about up is to the right
  EXPECT_EQ(Axes("RSP", "x").ours(turned_left).q.coeffs(), turned_left.q.coeffs());
  for (const char* wrong : {"", "RS", "RSX", "RLS", "RSPA", "rsp"}) {
    EXPECT_THAT(complaint([&] { Axes(wrong, "x"); }), HasSubstr("expected where +x, +y and +z"));
  }
}

const std::string kChannels =
    "name\tcomponent\ttype\ttracked_point\tunits\n"
    "t\tn/a\tLATENCY\tn/a\ts\n"
    "a\tx\tPOS\thead\tmm\nb\ty\tPOS\thead\tmm\nc\tz\tPOS\thead\tmm\n"
    "d\tquat_x\tORNT\thead\tn/a\ne\tquat_y\tORNT\thead\tn/a\nf\tquat_z\tORNT\thead\tn/a\n"
    "g\tquat_w\tORNT\thead\tn/a\nh\tn/a\tMISC\tn/a\tn/a\n";

TEST(MotionFiles, MotionBidsIsReadByItsChannels) {
  const auto tracks = parse_motion_bids(
                          "0\t1000\t2000\t3000\t0\t0\t0\t1\t9\n"
                          "0.01\t1000\t2000\t3000\t0\t0\t0.6\t0.8\t9\n",
                          kChannels, "x", {.axes = "ALS"})
                          .tracks;
  ASSERT_EQ(tracks.size(), 1u);
  EXPECT_EQ(tracks[0].first, "head");
  ASSERT_EQ(tracks[0].second.samples().size(), 2u);
  expect_near(tracks[0].second.samples()[1].value.p, Vec3(-2, 3, -1));
  expect_near(tracks[0].second.samples()[1].value.q * kUp, kUp);

  const std::string row = "0\t1\t2\t3\t0\t0\t0\t1\t9\n";
  const auto said = [&](std::string motion, std::string channels) {
    return complaint([&] { parse_motion_bids(motion, channels, "x", {.axes = "RSP"}); });
  };
  EXPECT_EQ(said(row, kChannels), "");
  EXPECT_THAT(said("1" + row.substr(1) + row, kChannels), HasSubstr("time must advance"));
  EXPECT_THAT(said("0\t1\n", kChannels), HasSubstr("x:1: expected 9 fields, found 2"));
  EXPECT_THAT(said("0\t1\t2\t3\t0\t0\t0\t2\t9\n", kChannels), HasSubstr("unit quaternion"));
  std::string channels = kChannels;
  EXPECT_THAT(said(row, channels.replace(channels.find("\tmm"), 3, "\tft")),
              HasSubstr("expected m, cm or mm, found 'ft'"));
  channels = kChannels;
  EXPECT_THAT(said(row, channels.replace(channels.find("quat_w"), 6, "rot_ww")),
              HasSubstr("component 'rot_ww'"));
  channels = kChannels;
  EXPECT_THAT(said(row, channels.replace(channels.find("LATENCY"), 7, "MISC")),
              HasSubstr("no times: expected a LATENCY channel, or SamplingFrequency"));
  EXPECT_THAT(said(row, "name\n"), HasSubstr("column component is missing"));
}

// Seconds since 1970 need ten digits.
TEST(MotionFiles, UnixTimesAreTimes) {
  std::vector<std::string> notes;
  const PoseTrack track = parse_uxf(
      "time,pos_x,pos_y,pos_z,rot_x,rot_y,rot_z\n1700000000.25,1,2,3,0,0,0\n", "x.csv", notes);
  EXPECT_EQ(track.samples().at(0).time, Time{1'700'000'000'250'000});
  const std::string pose = "\t1\t2\t3\t0\t0\t0\t1\t9\n";
  const auto read = [&](const std::string& time) {
    return parse_motion_bids(time + pose, kChannels, "x", {.axes = "RSP"}).tracks.at(0).second;
  };
  EXPECT_EQ(read("1700000000.25").samples().at(0).time, Time{1'700'000'000'250'000});
  EXPECT_THAT(complaint([&] { read("-2e10"); }),
              HasSubstr("LATENCY: expected -1e10 to 1e10 s, found -2e+10"));
}

// What a recording lacks for a moment is no reason to refuse the rest of it.
TEST(MotionFiles, MotionBidsSamplesThatAreUnknownOrTwiceAreLeftOutAndSaid) {
  const std::string pose = "\t1\t2\t3\t0\t0\t0\t1\t9\n";
  const MotionTracks read = parse_motion_bids(
      "0" + pose + "0.01\t1\tn/a\t3\t0\t0\t0\t1\t9\n" + "0.02" + pose + "0.02" + pose + "n/a" +
          pose + "0.03\t1\t2\t3\t0\t0\t0\tn/a\t9\n" + "0.04" + pose,
      kChannels, "x", {.axes = "RSP"});
  std::vector<Time> times;
  for (const auto& sample : read.tracks.at(0).second.samples()) times.push_back(sample.time);
  EXPECT_THAT(times, testing::ElementsAre(Time{0}, Time{20'000}, Time{40'000}));
  EXPECT_THAT(read.notes, testing::ElementsAre(HasSubstr("3 samples are n/a"),
                                               HasSubstr("1 samples are at the time of the one")));
}

// RotationOrder counts rotations about axes that stay, the first first.
TEST(MotionFiles, MotionBidsAnglesTurnInTheOrderThatIsDeclared) {
  std::string channels = kChannels.substr(0, kChannels.find("d\tquat_x"));
  for (const char* axis : {"x", "y", "z"}) {
    channels += std::string("r") + axis + "\t" + axis + "\tORNT\thead\tdeg\n";
  }
  const std::string row = "0\t1000\t2000\t3000\t90\t0\t90\n";
  const auto turned = [&](const BidsFrame& frame) {
    return parse_motion_bids(row, channels, "x", frame).tracks.at(0).second.samples().at(0).value.q;
  };
  // First about x: ahead (-z) goes to y, which the turn about z takes to -x.
  expect_near(turned({.axes = "RSP", .rotation_order = "XYZ"}) * kAhead, -kRight);
  // First about z, which leaves -z; then about x to y.
  expect_near(turned({.axes = "RSP", .rotation_order = "ZXY"}) * kAhead, kUp);
  expect_near(turned({.axes = "RSP", .rotation_order = "ZXY", .left_handed = true}) * kAhead, -kUp);
  for (const char* order : {"", "ZX", "ZZX", "zxy", "ABC"}) {
    EXPECT_THAT(complaint([&] { turned({.axes = "RSP", .rotation_order = order}); }),
                HasSubstr("expected RotationOrder in ..._channels.json, such as ZXY"))
        << order;
  }
  const auto said = [&](const std::string& from, const std::string& to) {
    std::string changed = channels;
    changed.replace(changed.find(from), from.size(), to);
    return complaint(
        [&] { parse_motion_bids(row, changed, "x", {.axes = "RSP", .rotation_order = "XYZ"}); });
  };
  EXPECT_THAT(said("\tdeg", "\tturns"), HasSubstr("expected deg or rad, found 'turns'"));
  EXPECT_THAT(said("\tx\tORNT", "\tyaw\tORNT"),
              HasSubstr("component 'yaw' of type ORNT: expected x, y, z, or quat_x"));
  EXPECT_THAT(said("\tx\tPOS", "\tquat_x\tPOS"),
              testing::EndsWith("component 'quat_x' of type POS: expected x, y, z"));
  EXPECT_THAT(said("rz\tz\tORNT\thead\tdeg\n", "rz\tn/a\tMISC\tn/a\tn/a\n"),
              HasSubstr("a whole quaternion, or three angles"));
}

using Packet = std::vector<std::uint8_t>;

void put_number(Packet& out, std::uint64_t value, int size) {
  for (int i = size - 1; i >= 0; --i) out.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

void message(Packet& out, int type, int sender, Time time, const Packet& data) {
  for (const std::int64_t field :
       {std::int64_t{type}, std::int64_t{sender}, time.count() / 1'000'000,
        time.count() % 1'000'000, static_cast<std::int64_t>(data.size()), std::int64_t{0}}) {
    put_number(out, static_cast<std::uint64_t>(field), 4);
  }
  out.insert(out.end(), data.begin(), data.end());
}

Packet name(const std::string& text) {
  Packet data;
  put_number(data, text.size() + 1, 4);
  data.insert(data.end(), text.begin(), text.end());
  data.push_back(0);
  return data;
}

/// A log of a tracker with so many sensors, a hundred reports of each, and of a button.
Packet vrpn_log(int sensors = 3, double q_w = 0.8) {
  const std::string cookie = "vrpn: ver. 07.35  1";
  Packet log(24);
  std::copy(cookie.begin(), cookie.end(), log.begin());
  message(log, -1, 7, {}, name("Tracker0"));
  message(log, -2, 3, {}, name("vrpn_Tracker Pos_Quat"));
  message(log, -2, 4, {}, name("vrpn_Button Change"));
  for (int i = 0; i < 100; ++i) {
    for (int sensor = 0; sensor < sensors; ++sensor) {
      Packet data;
      put_number(data, static_cast<std::uint64_t>(sensor), 4);
      put_number(data, 0, 4);
      for (const double v : {1.0 + sensor, 2.0, 3.0, 0.0, 0.6, 0.0, q_w}) {
        put_number(data, std::bit_cast<std::uint64_t>(v), 8);
      }
      message(log, 3, 7, Time{1'700'000'000'000'000 + 10'000 * i + 1000 * sensor}, data);
    }
    message(log, 4, 7, Time{1'700'000'000'000'000 + 10'000 * i}, Packet(8));
  }
  return log;
}

TEST(MotionFiles, AVrpnLogIsReadByTheNamesInIt) {
  std::vector<std::string> notes;
  const auto tracks = parse_vrpn(vrpn_log(), "x", 0.01, notes);
  EXPECT_THAT(notes, testing::IsEmpty());
  ASSERT_EQ(tracks.size(), 3u);
  EXPECT_EQ(tracks[2].first, "Tracker0:2");
  ASSERT_EQ(tracks[2].second.samples().size(), 100u);
  EXPECT_EQ(tracks[2].second.samples()[1].time, Time{12'000});
  expect_near(tracks[2].second.samples()[1].value.p, Vec3(0.03, 0.02, 0.03));
  EXPECT_EQ(tracks[2].second.samples()[1].value.q.coeffs(), Quat(0.8, 0, 0.6, 0).coeffs());
}

TEST(MotionFiles, WhateverAVrpnLogHoldsItIsReadOrRefused) {
  const Packet good = vrpn_log();
  for (std::size_t cut = 0; cut < good.size(); cut += 7) {  // up to the cut
    std::vector<std::string> notes;
    EXPECT_NO_THROW(parse_vrpn(std::span(good).first(cut), "x", 1.0, notes)) << cut;
  }
  std::mt19937 random(5);
  for (int n = 0; n < 3000; ++n) {
    Packet bytes = good;
    for (int k = 0; k < 4; ++k) {
      bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    }
    try {
      std::vector<std::string> notes;
      for (const auto& [sensor, track] : parse_vrpn(bytes, "x", 1.0, notes)) {
        for (const auto& sample : track.samples()) ASSERT_TRUE(sample.value.p.allFinite());
      }
    } catch (const std::invalid_argument&) {
    }
  }
}

/// Files of a test, read by their names.
class MotionFilesIn : public testing::Test {
 protected:
  MotionRecording read(const std::string& file, const MotionOptions& options = {}) const {
    return read_motion(folder / file, options);
  }
  std::string why_not(const std::string& file, const MotionOptions& options = {}) const {
    return complaint([&] { read(file, options); });
  }
  void write_objects(const std::string& at, const std::vector<std::string>& objects) const {
    for (const std::string& object : objects) {
      spit(folder / at / (object + "_movement_T001.csv"),
           "time,pos_x,pos_y,pos_z,rot_x,rot_y,rot_z\n0,0,1.6,0,0,0,0\n0.01,0,1.6,0,0,0,0\n");
    }
  }

  const fs::path folder = fresh_folder("motion");
};

TEST_F(MotionFilesIn, AUxfFolderIsASession) {
  write_objects("S001/trackers", {"Main Camera", "leftHand", "rightHand"});
  EXPECT_EQ(read("S001").times.size(), 2u);
  EXPECT_EQ(read("S001/trackers").times.size(), 2u);
  EXPECT_EQ(read("S001/trackers/leftHand_movement_T001.csv").times.size(), 2u);
  spit(folder / "S001/trackers/leftHand_movement_T002.csv", "time,pos_x\n");
  EXPECT_THAT(why_not("S001"), HasSubstr("contains several trials"));
  EXPECT_THAT(why_not("S001/trackers/leftHand_movement_T002.csv"), HasSubstr("pos_y is missing"));
  write_objects("quest", {"CenterEyeAnchor", "LeftEyeAnchor", "RightHandAnchor"});
  EXPECT_EQ(read("quest").right_hand.size(), 2u);
  EXPECT_TRUE(read("quest").left_hand.empty());
}

TEST_F(MotionFilesIn, AVrpnLogIsKnownByItsBytes) {
  const Packet log = vrpn_log();
  spit(folder / "log.vrpn", {log.begin(), log.end()});
  EXPECT_EQ(read("log.vrpn").right_hand.at(0).p.x(), 3.0);
  EXPECT_EQ(read("log.vrpn", {.names = {"2", "1", "0"}}).head.at(0).p.x(), 3.0);
  EXPECT_EQ(read("log.vrpn", {.reading = {.axes = "LSA"}}).head.at(0).p.x(), -1.0);
  EXPECT_THAT(why_not("log.vrpn", {.names = {"2", "1", "5"}}),
              HasSubstr("expected one right hand among Tracker0:0, Tracker0:1, Tracker0:2"));

  // One hand is enough, where a file has no other or is told so.
  const MotionRecording one = read("log.vrpn", {.names = {"0", "", "2"}, .p_origin = {0, 0.5, 0}});
  EXPECT_TRUE(one.left_hand.empty());
  EXPECT_EQ(one.right_hand.at(0).p, Vec3(3.0, 2.5, 3.0));
  const Packet pair = vrpn_log(2);
  spit(folder / "pair.vrpn", {pair.begin(), pair.end()});
  EXPECT_TRUE(read("pair.vrpn").left_hand.empty());
  EXPECT_EQ(read("pair.vrpn").right_hand.at(0).p.x(), 2.0);
  EXPECT_TRUE(read("pair.vrpn", {.only_hand_is_left = true}).right_hand.empty());
  const Packet alone = vrpn_log(1);
  spit(folder / "alone.vrpn", {alone.begin(), alone.end()});
  EXPECT_THAT(why_not("alone.vrpn"), HasSubstr("expected one head among Tracker0:0"));
}

TEST_F(MotionFilesIn, AMotionBidsTableNeedsItsAxes) {
  std::string channels = kChannels.substr(0, kChannels.find("h\tn/a"));
  const std::string of_head = channels.substr(channels.find("a\tx"));
  for (const std::string hand : {"left_hand", "right_hand"}) {
    std::string block = of_head;
    for (std::size_t at = 0; (at = block.find("head", at)) != std::string::npos;) {
      block.replace(at, 4, hand);
    }
    channels += block;
  }
  const std::string pose = "\t0\t0\t1600\t0\t0\t0\t1";
  spit(folder / "a_motion.tsv", "0" + pose + pose + pose + "\n0.01" + pose + pose + pose + "\n");
  spit(folder / "a_channels.tsv", channels);
  EXPECT_THAT(why_not("a_motion.tsv"), HasSubstr("expected SpatialAxes"));
  spit(folder / "a_channels.json",
       R"({"reference_frame":{"Levels":{"global":{"SpatialAxes":"ALS"}}}})");
  EXPECT_EQ(read("a_motion.tsv").head.at(0).p.y(), 1.6);
}

TEST_F(MotionFilesIn, OfAnotherFormatAreToldWithThoseThatAreKnown) {
  const auto said = [&](const std::string& bytes) {
    spit(folder / "x", bytes);
    return why_not("x");
  };
  for (const MotionFormat& format : motion_formats()) {
    EXPECT_THAT(said("HIERARCHY\nROOT"), HasSubstr(std::string(format.name)));
  }
  EXPECT_THAT(said("HIERARCHY\nROOT"), HasSubstr("x: seems to be BVH; expected one of UXF"));
  EXPECT_THAT(said("XDF:\x01"), HasSubstr("expected a stream with the positions of head and hand"));
  EXPECT_THAT(
      said("\xed\xa1\xda\x01"),
      HasSubstr("x: is an LCM event log (a trial) and needs no import; expected a recording"));
  EXPECT_THAT(said("frame,x,y\n1,2,3\n"), HasSubstr("CSV that begins with 'frame,x,y'"));
  EXPECT_THAT(said(""), HasSubstr("x: is empty; expected a recording (UXF, Motion-BIDS"));
  for (const char* names : {"t,HMD_x,HMD_y,HMD_z\n", "t;q0;q1;q2", "# t\ta\tb\tc\n\n"}) {
    EXPECT_THAT(said(names), HasSubstr("x: has column names but no rows; expected at least 100"));
  }
  EXPECT_THAT(said(std::string("\x02P\x00\x00", 4)), HasSubstr("C3D"));
  EXPECT_THAT(why_not("."), HasSubstr("a folder of something else"));
  EXPECT_THAT(why_not("missing"), HasSubstr("cannot open"));
}

TEST_F(MotionFilesIn, AFormatThatSaysItsColumnsTakesNoOthers) {
  const Packet log = vrpn_log();
  spit(folder / "log.vrpn", {log.begin(), log.end()});
  EXPECT_THAT(why_not("log.vrpn", {.columns = {{"head", "HMD_*"}}}),
              HasSubstr("as VRPN says its own; found head = HMD_*"));
  for (const char* rotations : {"XYZ", "vector"})
    EXPECT_THAT(why_not("log.vrpn", {.rotations = rotations}),
                HasSubstr(std::string("as VRPN says its own; found ") + rotations));
  EXPECT_THAT(why_not("log.vrpn", {.degrees = true}), HasSubstr("found deg"));

  EXPECT_TRUE(read("log.vrpn").hands_turn);
  const MotionRecording level = read("log.vrpn", {.rotations = "none"});
  EXPECT_FALSE(level.head_turns);
  EXPECT_FALSE(level.hands_turn);
  EXPECT_EQ(level.reading.angles, "none");
  EXPECT_EQ(level.right_hand.at(0).q.angularDistance(Quat::Identity()), 0.0);
  EXPECT_EQ(level.right_hand.at(0).p.x(), 3.0);
}

TEST(MotionFiles, AVrpnReportOfAnotherPoseAtTheSameTimeIsLeftOutAndSaid) {
  const auto with_report = [](double x) {
    Packet log = vrpn_log(1), data;
    put_number(data, 0, 8);
    for (const double v : {x, 2.0, 3.0, 0.0, 0.6, 0.0, 0.8})
      put_number(data, std::bit_cast<std::uint64_t>(v), 8);
    message(log, 3, 7, Time{1'700'000'000'990'000}, data);
    std::vector<std::string> notes;
    EXPECT_EQ(parse_vrpn(log, "x", 1.0, notes).at(0).second.samples().size(), 100u);
    return notes;
  };
  EXPECT_THAT(with_report(1.0), testing::IsEmpty());  // the same again
  EXPECT_THAT(with_report(1.5), testing::ElementsAre(HasSubstr("1 reports have another pose")));
}

// Rotations that are not to be read refused a file where they were no numbers, or missing.
TEST_F(MotionFilesIn, RotationsThatAreNotToBeReadMayBeUnusable) {
  for (const char* object : {"head", "right_hand"}) {
    spit(folder / (std::string(object) + "_movement_T001.csv"),
         "time,pos_x,pos_y,pos_z,rot_x,rot_y,rot_z\n0,1,2,3,nan,nan,nan\n0.1,1,2,3,nan,,0\n");
    spit(folder / (std::string(object) + "_movement_T002.csv"),
         "time,pos_x,pos_y,pos_z\n0,1,2,3\n0.1,1,2,3\n");
  }
  EXPECT_THAT(why_not("head_movement_T001.csv"), HasSubstr("rot_x: expected a finite number"));
  EXPECT_THAT(why_not("head_movement_T002.csv"), HasSubstr("rot_x is missing"));

  std::string names = "name\tcomponent\ttype\ttracked_point\tunits\n", row;
  for (const char* point : {"head", "right_hand"}) {
    for (const char* axis : {"x", "y", "z"}) {
      names += fmt::format("{0}_p{1}\t{1}\tPOS\t{0}\tm\n", point, axis);
      row += fmt::format("{}1.5", row.empty() ? "" : "\t");
    }
    for (const char* axis : {"x", "y", "z"}) {
      names += fmt::format("{0}_r{1}\t{1}\tORNT\t{0}\tdeg\n", point, axis);
      row += "\tn/a";
    }
  }
  spit(folder / "a_motion.tsv", row + "\n" + row + "\n");
  spit(folder / "a_channels.tsv", names);
  spit(folder / "a_motion.json", "{\"SamplingFrequency\": 10}");
  EXPECT_THAT(why_not("a_motion.tsv", {.reading = {.axes = "RSP"}}), HasSubstr("RotationOrder"));

  const Packet log = vrpn_log(3, 0.0);
  spit(folder / "log.vrpn", {log.begin(), log.end()});
  EXPECT_THAT(why_not("log.vrpn"), HasSubstr("expected a finite position and a unit quaternion"));

  for (const char* file :
       {"head_movement_T001.csv", "head_movement_T002.csv", "a_motion.tsv", "log.vrpn"}) {
    const MotionRecording level = read(file, {.reading = {.axes = "RSP"}, .rotations = "none"});
    EXPECT_GE(level.times.size(), 2u) << file;
    EXPECT_FALSE(level.head_turns || level.hands_turn) << file;
    EXPECT_EQ(level.right_hand.at(0).q.angularDistance(Quat::Identity()), 0.0) << file;
  }
}

// The log has 0, 0.6, 0, 0.8 for each rotation.
TEST_F(MotionFilesIn, ARecordingSaysHowItsNumbersWereRead) {
  const Packet log = vrpn_log();
  spit(folder / "log.vrpn", {log.begin(), log.end()});
  const MotionRecording plain = read("log.vrpn");
  EXPECT_EQ(plain.reading.quaternion, "xyzw");
  EXPECT_EQ(plain.reading.unit_m, 1.0);
  EXPECT_EQ(plain.p_origin, Vec3::Zero());
  EXPECT_LT(plain.head.at(0).q.angularDistance(Quat(0.8, 0, 0.6, 0)), 1e-12);

  const MotionRecording told = read(
      "log.vrpn", {.reading = {.unit_m = 0.01, .quaternion = "wxyz"}, .p_origin = {0, 0.5, 0}});
  EXPECT_EQ(told.reading.quaternion, "wxyz");
  EXPECT_EQ(told.reading.unit_m, 0.01);
  EXPECT_EQ(told.p_origin, Vec3(0, 0.5, 0));
  EXPECT_LT(told.head.at(0).q.angularDistance(Quat(0, 0.6, 0, 0.8)), 1e-12);
  expect_near(told.head.at(0).p, Vec3(0.01, 0.52, 0.03));

  // Rotations that are not to be read have no order that matters.
  const MotionRecording level =
      read("log.vrpn", {.reading = {.quaternion = "wxyz"}, .rotations = "none"});
  EXPECT_EQ(level.head.at(0).q.angularDistance(Quat::Identity()), 0.0);
}

}  // namespace
}  // namespace headpin::devices
