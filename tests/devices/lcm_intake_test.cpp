// Who speaks for a station and for the mouse, and by which clock: messages with their senders and times.

#include <vector>

#include <gtest/gtest.h>

#include "devices/lcm/intake.h"
#include "devices/log/sample_messages.h"

namespace headpin::devices {
namespace {

constexpr std::uint64_t kUnknown = 0, kAnn = 1001, kBob = 1002, kCid = 1003, kDan = 1004;

/// When a sample was told by its sender's clock, and when it came by the session's.
struct Told {
  std::int64_t theirs_us = 0, came_us = 0;
};

class LcmIntakeTest : public testing::Test {
 protected:
  void take(std::string_view channel, const Buffer& data, std::uint64_t sender, Time came) {
    intake.take({.channel = channel, .data = data, .sender = sender, .arrived = came});
  }
  void pose(Told told, std::uint64_t sender, std::int64_t sequence = 0,
            std::int32_t station = kHandStation) {
    TrackerSample sample;
    sample.device_time = Time{told.theirs_us};
    sample.sequence = sequence;
    sample.station = station;
    Buffer data;
    encode(sample, data);
    take(kTrackerChannel, data, sender, Time{told.came_us});
  }
  void button(Told told, std::uint64_t sender) {
    Buffer data;
    encode(MouseSample{.device_time = Time{told.theirs_us}, .trigger = true}, data);
    take(kMouseChannel, data, sender, Time{told.came_us});
  }
  const LcmIntake::Publisher& hand() const {
    return intake.publishers().at(device_at(kHandStation));
  }
  const LcmIntake::Publisher& mouse() const { return intake.publishers().at(Device::mouse); }
  const LcmIntake::Counts& counts() const { return intake.counts(); }

  Clocks clocks;
  LcmIntake intake{clocks, 100};
};

TEST_F(LcmIntakeTest, TheSessionFollowsATrackerAndNoMouse) {
  clocks.follow_first(240);  // in steps of 12.5 ms
  button({1'000'000, 30'400}, kUnknown);
  EXPECT_EQ(mouse().told, Time{30'400});
  pose({5'000'000, 50'400}, kUnknown);
  EXPECT_EQ(hand().told, Time{50'000});
}

TEST_F(LcmIntakeTest, AStationIsItsSendersUntilThatIsSilentForASecond) {
  pose({10'000'000, 1'000'000}, kAnn, 7);
  pose({10'000'000, 1'200'000}, kBob, 5000);
  pose({10'799'999, 1'999'999}, kBob, 5001);
  EXPECT_EQ(counts().others, 2);
  EXPECT_EQ(counts().handovers, 0);
  EXPECT_EQ(hand().sender, kAnn);
  EXPECT_EQ(hand().other, kBob);
  EXPECT_EQ(hand().beside, kAnn);
  EXPECT_EQ(hand().other_time, Time{1'999'999});
  pose({10'800'000, 2'000'000}, kBob, 5002);
  EXPECT_EQ(counts().others, 2);
  EXPECT_EQ(counts().handovers, 1);
  EXPECT_EQ(hand().sender, kBob);
  EXPECT_EQ(hand().told, Time{2'000'000});  // its clock is 200 ms behind the other one
  EXPECT_EQ(counts().clock_jumps, 0);
  EXPECT_EQ(intake.lost(), 0);  // its numbers are its own
}

TEST_F(LcmIntakeTest, TheClockOfAKnownSenderJumpsByMoreThanASecond) {
  pose({10'000'000, 1'000'000}, kAnn);
  for (const Told late : {Told{10'100'000, 1'800'000}, Told{10'200'000, 2'200'000}}) {
    pose(late, kAnn);
    EXPECT_EQ(hand().told, Time{late.theirs_us - 9'000'000});
    EXPECT_EQ(hand().host_time, Time{late.came_us});
  }
  EXPECT_EQ(counts().clock_jumps, 0);
  pose({10'300'000, 2'300'001}, kAnn);
  EXPECT_EQ(hand().told, Time{2'300'001});
  EXPECT_EQ(counts().clock_jumps, 1);
}

TEST_F(LcmIntakeTest, WithoutSendersMoreThanHalfASecondIsAnother) {
  pose({10'000'000, 1'000'000}, kUnknown);
  pose({10'100'000, 1'600'000}, kUnknown);
  EXPECT_EQ(hand().told, Time{1'100'000});
  EXPECT_EQ(counts().others, 0);
  pose({10'200'000, 1'700'001}, kUnknown);
  EXPECT_EQ(hand().told, Time{1'100'000});
  EXPECT_EQ(counts().others, 1);
  EXPECT_EQ(counts().clock_jumps, 0);
}

TEST_F(LcmIntakeTest, WhoFollowsAnUnknownSenderHasItsOwnClockAndNumbers) {
  for (int i = 0; i < 10; ++i) pose({10'000'000 + 10'000 * i, 1'000'000 + 10'000 * i}, kUnknown, i);
  pose({11'300'000, 3'000'000}, kUnknown, 1000);  // 700 ms behind
  EXPECT_EQ(hand().told, Time{3'000'000});
  EXPECT_EQ(counts().clock_jumps, 1);
  EXPECT_EQ(intake.lost(), 0);
}

TEST_F(LcmIntakeTest, AMouseWithAClockOfItsOwnKeepsIt) {
  button({5'000'000, 1'000'000}, kUnknown);
  EXPECT_EQ(mouse().told, Time{1'000'000});
  button({5'100'000, 1'100'000}, kUnknown);
  EXPECT_EQ(mouse().told, Time{1'100'000});
  button({5'200'000, 1'900'000}, kUnknown);  // 700 ms late
  EXPECT_EQ(mouse().told, Time{1'200'000});
  pose({100'000'000, 1'900'000}, kUnknown);
  button({5'300'000, 2'000'000}, kUnknown);
  EXPECT_EQ(mouse().told, Time{1'300'000});
  EXPECT_EQ(mouse().host_time, Time{2'000'000});
  EXPECT_FALSE(mouse().follows_station);
  EXPECT_EQ(counts().others + counts().clock_jumps, 0);
  std::vector<Sample> out;
  intake.hand_out(Time{2'000'000}, out);
  ASSERT_EQ(out.size(), 5u);
  EXPECT_EQ(std::get<MouseSample>(out.back()).device_time, Time{1'300'000});
  EXPECT_EQ(std::get<MouseSample>(out.back()).host_time, Time{2'000'000});
}

TEST_F(LcmIntakeTest, AMouseOfAStationsClockIsAnotherBeyondHalfASecond) {
  pose({10'000'000, 1'000'000}, kUnknown);
  button({10'050'000, 1'060'000}, kUnknown);
  EXPECT_TRUE(mouse().follows_station);
  EXPECT_EQ(mouse().told, Time{1'050'000});
  EXPECT_EQ(mouse().host_time, Time{1'060'000});
  button({10'100'000, 1'600'001}, kUnknown);
  EXPECT_EQ(counts().others, 1);
  button({10'200'000, 1'700'000}, kUnknown);
  EXPECT_EQ(counts().others, 1);
  EXPECT_EQ(mouse().samples, 2);
}

TEST_F(LcmIntakeTest, WhenNoStationIsActiveAMouseOfAnotherClockIsHeard) {
  pose({10'000'000, 1'000'000}, kUnknown);
  button({10'050'000, 1'060'000}, kUnknown);
  button({11'300'000, 3'000'000}, kUnknown);  // 700 ms behind
  EXPECT_EQ(counts().others, 0);
  EXPECT_EQ(mouse().samples, 2);
}

TEST_F(LcmIntakeTest, ZeroIsATimeOfAClockThatStartedThere) {
  pose({0, 50'000}, kUnknown);
  button({8'000, 58'100}, kUnknown);
  button({0, 59'000}, kUnknown);  // was overtaken
  EXPECT_EQ(mouse().told, Time{50'000});
  EXPECT_EQ(counts().unstamped, 0);
}

TEST_F(LcmIntakeTest, AMouseBelongsToTheSenderOfThePoses) {
  pose({10'000'000, 1'000'000}, kAnn);
  pose({10'100'000, 1'100'000}, kBob);
  button({10'150'000, 1'150'000}, kBob);  // whose poses are skipped
  EXPECT_EQ(counts().others, 2);
  EXPECT_EQ(mouse().samples, 0);
  button({10'200'000, 1'200'000}, kCid);  // who sends no poses
  EXPECT_EQ(mouse().sender, kCid);
  button({10'210'000, 1'210'000}, kDan);
  EXPECT_EQ(counts().others, 3);
  EXPECT_EQ(mouse().sender, kCid);
  button({10'300'000, 1'300'000}, kAnn);
  EXPECT_EQ(mouse().sender, kAnn);
  EXPECT_EQ(counts().others, 3);
  EXPECT_EQ(counts().handovers, 1);
  button({10'310'000, 1'310'000}, kCid);
  EXPECT_EQ(mouse().sender, kAnn);
  EXPECT_EQ(counts().others, 4);
}

TEST_F(LcmIntakeTest, WhoTellsNoTimesIsNotSilent) {
  for (const std::int64_t came_us : {2'000'000, 2'500'000, 3'000'000}) pose({0, came_us}, kAnn);
  EXPECT_EQ(hand().host_time, Time{3'000'000});
  pose({0, 3'200'000}, kBob);
  EXPECT_EQ(counts().others, 1);
  EXPECT_EQ(counts().unstamped, 2);  // 0 may be the time of the first
}

TEST_F(LcmIntakeTest, WhatCameBeforeTheLastTickIsOfTheNextOne) {
  std::vector<Sample> out;
  intake.hand_out(Time{100'000}, out);
  pose({10'000, 90'000}, kAnn);
  EXPECT_EQ(hand().host_time, Time{100'001});
  intake.hand_out(Time{100'000}, out);
  EXPECT_TRUE(out.empty());
  intake.hand_out(Time{100'001}, out);
  EXPECT_EQ(out.size(), 1u);
}

// The clock of the head's publisher turns out to be ahead: its second sample is of 104.1 ms.
TEST_F(LcmIntakeTest, ASampleThatIsDueLaterKeepsNoOtherWaiting) {
  std::vector<Sample> out;
  pose({0, 100'000}, kAnn, 0, kHeadStation);
  pose({5'000, 100'000}, kAnn, 1, kHeadStation);
  pose({0, 101'000}, kAnn, 0, kHandStation);
  intake.hand_out(Time{102'000}, out);
  ASSERT_EQ(out.size(), 2u);
  EXPECT_EQ(std::get<TrackerSample>(out[1]).station, kHandStation);
  intake.hand_out(Time{104'099}, out);
  EXPECT_EQ(out.size(), 2u);
  intake.hand_out(Time{104'100}, out);
  EXPECT_EQ(out.size(), 3u);
}

}  // namespace
}  // namespace headpin::devices
