#include "devices/recordings/catalogue_csv.h"

#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/recordings/motion_files.h"
#include "devices/recordings/table_motion.h"
#include "tests/support/folder.h"

namespace headpin::devices {
namespace {

using testing::HasSubstr;

const std::string kHeader =
    "delta_time_ms,head_pos_x,head_pos_y,head_pos_z,head_rot_w,head_rot_x,head_rot_y,head_rot_z,"
    "left_hand_pos_x,left_hand_pos_y,left_hand_pos_z,left_hand_rot_w,left_hand_rot_x,"
    "left_hand_rot_y,left_hand_rot_z,right_hand_pos_x,right_hand_pos_y,right_hand_pos_z,"
    "right_hand_rot_w,right_hand_rot_x,right_hand_rot_y,right_hand_rot_z";
const std::string kRow = ",1,170,3,1,0,0,0,-20,90,0,0,1,0,0,20,80,-5,0,0,0.6,-0.8\n";
const std::string kGood = kHeader + "\n0" + kRow + "14" + kRow + "27.5" + kRow;

MotionRecording read(const std::string& text, std::optional<double> unit_m = {}) {
  const MotionOptions options{.reading = {.unit_m = unit_m}};
  return recording_of(parse_motion_table(text, "throw.csv", options), options, "throw.csv");
}

std::string refused(const std::string& text) {
  return complaint([&] { read(text); });
}

/// kGood with the first `from` behind the header replaced.
std::string with(const std::string& from, const std::string& to) {
  std::string text = kGood;
  return text.replace(text.find(from, kHeader.size()), from.size(), to);
}

TEST(CatalogueCsvTest, ReadsPosesInMetresAndKeepsEveryStamp) {
  const MotionRecording recording = read(kGood);
  EXPECT_EQ(recording.times, (std::vector{Time{0}, Time{14'000}, Time{27'500}}));
  ASSERT_EQ(recording.right_hand.size(), 3u);
  EXPECT_TRUE(recording.head[1].p.isApprox(Vec3(0.01, 1.7, 0.03)));
  EXPECT_TRUE(recording.left_hand[1].p.isApprox(Vec3(-0.2, 0.9, 0.0)));
  EXPECT_EQ(recording.left_hand[1].q.coeffs(), Quat(0, 1, 0, 0).coeffs());
  EXPECT_EQ(recording.right_hand[2].q.coeffs(), Quat(0, 0, 0.6, -0.8).coeffs());
}

TEST(CatalogueCsvTest, TakesColumnsInAnyOrderAndLinesHoweverEnded) {
  std::string text = "\xef\xbb\xbfnote," + kHeader + "\r\nx, 5" + kRow + "\r\n\n";
  const MotionRecording recording = read(text, 1.0);
  ASSERT_EQ(recording.times, std::vector{Time{5'000}});
  EXPECT_EQ(recording.head[0].p, Vec3(1, 170, 3));
}

TEST(CatalogueCsvTest, RefusesWhatIsNoRecordingAndSaysWhere) {
  EXPECT_THAT(refused(""), HasSubstr("throw.csv: expected a table"));
  EXPECT_EQ(refused(kHeader + "\n"),
            "throw.csv: has column names but no rows; expected at least 100 samples");
  std::string text = kGood;
  EXPECT_THAT(
      refused(text.replace(text.find("head_pos_y"), 10, "head_pos_q")),
      testing::AllOf(HasSubstr("no head was found (x, y and z of one object); the 22 columns are "
                               "delta_time_ms, head_pos_x, head_pos_q, "),
                     testing::EndsWith(", ..."), testing::SizeIs(testing::Le(300u))));
}

// What is wrong in a cell costs its sample, and is said.
TEST(CatalogueCsvTest, ABadCellCostsItsSample) {
  for (const char* bad : {",nan", ",inf", ",1e999", ",17O", ","}) {
    const MotionRecording one = read(with(",170", bad));
    EXPECT_EQ(one.times, (std::vector{Time{14'000}, Time{27'500}})) << bad;
    EXPECT_THAT(one.notes,
                testing::ElementsAre(HasSubstr("1 samples of the head have blank cells")))
        << bad;
  }
  EXPECT_EQ(read(with(",0.6,-0.8", ",0.6,-0.7")).times.size(), 2u);  // no unit quaternion
  EXPECT_THAT(read(with(",170", "")).notes,
              testing::ElementsAre(HasSubstr(
                  "1 of 3 lines have another number of cells than 22, the first is line 2")));
  EXPECT_THAT(read(with("\n14,", "\n0,")).notes,
              testing::Contains(HasSubstr("1 samples of the head have the time of another one")));
  const MotionRecording ordered = read(with("\n27.5,", "\n13,"));
  EXPECT_EQ(ordered.times, (std::vector{Time{0}, Time{13'000}, Time{14'000}}));
  EXPECT_THAT(ordered.notes,
              testing::ElementsAre(HasSubstr("1 rows are earlier than the row before")));
  EXPECT_EQ(read(with("\n27.5,", "\n1e300,")).times.size(), 2u);
  std::string all = kGood;
  for (std::size_t at = 0; (at = all.find(",170", at)) != std::string::npos;)
    all.replace(at, 4, ",x");
  EXPECT_THAT(refused(all), HasSubstr("throw.csv:2: head: expected numbers"));
}

TEST(CatalogueCsvTest, WhatIsWrittenReadsBack) {
  EXPECT_THAT(kHeader, testing::StrEq([] {
                std::string names;
                for (const std::string& name : catalogue_columns()) {
                  names += (names.empty() ? "" : ",") + name;
                }
                return names;
              }()));
  const MotionRecording recording = read(kGood);
  const MotionRecording again = read(to_catalogue_csv(recording, 0.001), 0.001);
  EXPECT_EQ(again.times, recording.times);
  for (std::size_t i = 0; i < recording.times.size(); ++i) {
    for (const auto poses :
         {&MotionRecording::head, &MotionRecording::left_hand, &MotionRecording::right_hand}) {
      EXPECT_LT(((again.*poses)[i].p - (recording.*poses)[i].p).norm(), 1e-8);  // 5 digits of a mm
      EXPECT_LT((again.*poses)[i].q.angularDistance((recording.*poses)[i].q), 1e-7);
    }
  }
}

TEST(CatalogueCsvTest, AFileCutAnywhereIsReadUpToThereOrRefused) {
  for (std::size_t cut = 0; cut < kGood.size(); ++cut) {
    const std::string text = kGood.substr(0, cut);
    try {
      EXPECT_LE(read(text).times.size(), 3u);
    } catch (const std::invalid_argument&) {
    }
  }
}

}  // namespace
}  // namespace headpin::devices
