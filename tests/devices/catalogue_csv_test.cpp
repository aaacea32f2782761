#include "devices/recordings/catalogue_csv.h"

#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

std::string refused(const std::string& text) {
  return complaint([&] { parse_catalogue_csv(text, "throw.csv", 0.01); });
}

/// kGood with the first `from` behind the header replaced.
std::string with(const std::string& from, const std::string& to) {
  std::string text = kGood;
  return text.replace(text.find(from, kHeader.size()), from.size(), to);
}

TEST(CatalogueCsvTest, ReadsPosesInMetresAndKeepsEveryStamp) {
  const MotionRecording recording = parse_catalogue_csv(kGood, "throw.csv", 0.01);
  EXPECT_EQ(recording.times, (std::vector{Time{0}, Time{14'000}, Time{27'500}}));
  ASSERT_EQ(recording.right_hand.size(), 3u);
  EXPECT_TRUE(recording.head[1].p.isApprox(Vec3(0.01, 1.7, 0.03)));
  EXPECT_TRUE(recording.left_hand[1].p.isApprox(Vec3(-0.2, 0.9, 0.0)));
  EXPECT_EQ(recording.left_hand[1].q.coeffs(), Quat(0, 1, 0, 0).coeffs());
  EXPECT_EQ(recording.right_hand[2].q.coeffs(), Quat(0, 0, 0.6, -0.8).coeffs());
}

TEST(CatalogueCsvTest, TakesColumnsInAnyOrderAndLinesHoweverEnded) {
  std::string text = "\xef\xbb\xbfnote," + kHeader + "\r\nx, 5" + kRow + "\r\n\n";
  const MotionRecording recording = parse_catalogue_csv(text, "throw.csv", 1.0);
  ASSERT_EQ(recording.times, std::vector{Time{5'000}});
  EXPECT_EQ(recording.head[0].p, Vec3(1, 170, 3));
}

TEST(CatalogueCsvTest, RefusesWhatIsNoRecordingAndSaysWhere) {
  EXPECT_THAT(refused(""), HasSubstr("22 are missing: delta_time_ms, head_pos_x"));
  std::string text = kGood;
  EXPECT_THAT(refused(text.replace(text.find("left_hand_rot_y"), 15, "left_hand_rot_q")),
              HasSubstr("throw.csv:1: expected the 22 columns of the catalogue, one is missing: "
                        "left_hand_rot_y"));
  EXPECT_THAT(refused(with(",170", ",nan")),
              HasSubstr("throw.csv:2: head_pos_y: expected a finite number, found 'nan'"));
  EXPECT_THAT(refused(with(",170", ",inf")), HasSubstr("found 'inf'"));
  EXPECT_THAT(refused(with(",170", ",1e999")), HasSubstr("found '1e999'"));
  EXPECT_THAT(refused(with(",170", ",17O")), HasSubstr("found '17O'"));
  EXPECT_THAT(refused(with(",170", ",")), HasSubstr("found ''"));
  EXPECT_THAT(refused(with(",170", "")), HasSubstr("throw.csv:2: expected 22 fields, found 21"));
  EXPECT_THAT(refused(with(",0.6,-0.8", ",0.6,-0.7")),
              HasSubstr("right_hand_rot: expected a unit quaternion, found one of length 0.92"));
  EXPECT_THAT(refused(with("\n14,", "\n0,")), HasSubstr("throw.csv:3: delta_time_ms"));
  EXPECT_THAT(refused(with("\n27.5,", "\n13,")),
              HasSubstr("time must advance, found 0.013 s after 0.014 s"));
  EXPECT_THAT(refused(with("\n27.5,", "\n1e300,")), HasSubstr("out of range"));
}

TEST(CatalogueCsvTest, AllMissingColumnsAreNamedAtOnce) {
  const std::string said = refused("delta_time_ms,head_pos_x,left_hand_rot_q\n0,1,2\n");
  EXPECT_THAT(said, HasSubstr("20 are missing"));
  for (const std::string& column : catalogue_columns()) {
    const bool there = column == "delta_time_ms" || column == "head_pos_x";
    EXPECT_EQ(said.find(column) == std::string::npos, there) << column;
  }
}

TEST(CatalogueCsvTest, WhatIsWrittenReadsBack) {
  EXPECT_THAT(kHeader, testing::StrEq([] {
                std::string names;
                for (const std::string& name : catalogue_columns()) {
                  names += (names.empty() ? "" : ",") + name;
                }
                return names;
              }()));
  const MotionRecording recording = parse_catalogue_csv(kGood, "throw.csv", 0.01);
  const MotionRecording again =
      parse_catalogue_csv(to_catalogue_csv(recording, 0.001), "again.csv", 0.001);
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
      EXPECT_LE(parse_catalogue_csv(text, "throw.csv", 0.01).times.size(), 3u);
    } catch (const std::invalid_argument&) {
    }
  }
}

}  // namespace
}  // namespace headpin::devices
