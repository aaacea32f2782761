// Times of the devices' clocks on the session's.

#include "devices/base/clocks.h"

#include <gtest/gtest.h>

namespace headpin::devices {
namespace {

constexpr std::int64_t kGridRate = 240;  // a grid step of 12.5 ms
constexpr Time kGridTick{4167};

/// @param arrived  on the session's clock
Time dated(Clocks& clocks, ClockId clock, std::int64_t theirs, std::int64_t arrived) {
  return clocks.date({clock, Time{theirs}, static_cast<double>(arrived)});
}

TEST(Clocks, EachClockHasItsOwnOffset) {
  Clocks clocks;
  const ClockId a = clocks.add(), b = clocks.add();
  EXPECT_FALSE(clocks.started(a));
  EXPECT_EQ(dated(clocks, a, 1'000'000, 30'400), Time{30'400});
  EXPECT_EQ(dated(clocks, b, 7'000, 31'000), Time{31'000});
  EXPECT_EQ(dated(clocks, a, 1'010'000, 40'400), Time{40'400});
  EXPECT_EQ(clocks.ours_us(a, 1'000'000.0), 30'400.0);
  EXPECT_EQ(clocks.ours_us(b, 7'000.0), 31'000.0);
  EXPECT_EQ(clocks.stretch_us(kGridTick), 0.0);  // the session's clock follows none
}

// The offset of the first is whole grid steps, and the session's clock makes up for the rest.
TEST(Clocks, TheSessionFollowsTheFirstThatMayLead) {
  Clocks clocks;
  const ClockId mouse = clocks.add(Lead::never), other = clocks.add(), leader = clocks.add();
  clocks.follow_first(kGridRate);
  EXPECT_EQ(dated(clocks, mouse, 0, 777), Time{777});
  EXPECT_EQ(clocks.stretch_us(kGridTick), 0.0);
  EXPECT_EQ(dated(clocks, leader, 0, 30'400), Time{25'000});
  EXPECT_EQ(dated(clocks, other, 0, 700'400), Time{700'400});
  EXPECT_NEAR(clocks.stretch_us(kGridTick), 5'400.0 * 4167.0 / 1e6, 1e-9);
}

TEST(Clocks, ALeaderThatRestartsLeadsAgain) {
  Clocks clocks;
  const ClockId leader = clocks.add(), other = clocks.add();
  clocks.follow_first(kGridRate);
  dated(clocks, leader, 0, 30'400);
  clocks.restart(leader);
  EXPECT_FALSE(clocks.started(leader));
  EXPECT_EQ(dated(clocks, other, 0, 1'030'400), Time{1'030'400});
  EXPECT_EQ(dated(clocks, leader, 0, 1'030'400), Time{1'025'000});
}

// One message that came without delay shows that the offset was 100 ms too late.
TEST(Clocks, ALaterMeasurementStaysLaterWhenTheOffsetIsCorrected) {
  Clocks clocks;
  const ClockId clock = clocks.add();
  EXPECT_EQ(dated(clocks, clock, 0, 150'000), Time{150'000});
  EXPECT_EQ(dated(clocks, clock, 10'000, 60'000), Time{150'001});
  EXPECT_EQ(clocks.ours_us(clock, 10'000.0), 60'000.0);
  EXPECT_EQ(dated(clocks, clock, 200'000, 251'000), Time{250'000});
  clocks.restart(clock);  // what was before says nothing of another clock
  EXPECT_EQ(dated(clocks, clock, 300'000, 240'000), Time{240'000});
}

TEST(Clocks, WithoutATimeOfItsOwnAMeasurementHasThatOfItsArrival) {
  Clocks clocks;
  const ClockId clock = clocks.add();
  EXPECT_EQ(clocks.date_by_arrival(clock, Time{5'000}), Time{5'000});
  EXPECT_EQ(clocks.date_by_arrival(clock, Time{5'000}), Time{5'001});
  EXPECT_FALSE(clocks.started(clock));
}

TEST(Clocks, AClockThatShowsTheSameTimeGoesOnFromTheOffsetOfTheOther) {
  Clocks clocks;
  const ClockId station = clocks.add(), mouse = clocks.add(Lead::never);
  dated(clocks, station, 1'000'000, 30'000);
  EXPECT_EQ(clocks.date_like(station, mouse, Time{1'008'000}), Time{38'000});
  EXPECT_EQ(clocks.ours_us(mouse, 1'020'000.0), 50'000.0);
}

// The offset is that of the message with the least delay, also of two with the same time.
TEST(ClockOffset, OfTwoMessagesOfOneTimeTheEarlierShowsTheOffset) {
  ClockOffset offset;
  EXPECT_EQ(offset.carry_over(0.0, 1'000.0), 1'000.0);
  EXPECT_EQ(offset.carry_over(0.0, 500.0), 500.0);
}

TEST(ClockOffset, IsCorrectedInSmallStepsByAsMuchAsADelayMayBeAndAtOnceBeyond) {
  ClockOffset small, large;
  for (ClockOffset* offset : {&small, &large}) offset->carry_over(0.0, 20'000.0);
  EXPECT_EQ(small.carry_over(10'000.0, 22'000.0), 29'100.0);  // 8 ms: 0.9 ms of it
  EXPECT_EQ(large.carry_over(10'000.0, 21'999.0), 21'999.0);
}

// All messages of a second are late by 100 us: in the next second the offset makes up for half of it.
TEST(ClockOffset, AfterASecondItFollowsTheLeastDelayByHalfOfItInASecond) {
  ClockOffset offset;
  offset.carry_over(0.0, 0.0);
  EXPECT_EQ(offset.carry_over(500'000.0, 500'150.0), 500'000.0);
  EXPECT_EQ(offset.carry_over(1'000'000.0, 1'000'100.0), 1'000'000.0);
  EXPECT_NEAR(offset.carry_over(1'100'000.0, 1'100'200.0), 1'100'005.0, 1e-6);
  EXPECT_NEAR(offset.carry_over(1'900'000.0, 1'900'200.0), 1'900'045.0, 1e-6);
}

TEST(Clocks, MeasurementsStayAsFarApartAsTheDeviceMeasures) {
  Clocks clocks;
  const ClockId clock = clocks.add();
  dated(clocks, clock, 0, 0);
  const Measured early{
      .clock = clock, .theirs = Time{10'000}, .arrived_us = 5'000.0, .apart_us = 9'500.0};
  EXPECT_EQ(clocks.date(early), Time{9'500});  // 9'100 by the corrected offset
  EXPECT_EQ(clocks.estimate_us(clock), 9'500.0);
}

// With times that are far from the session's, as those of a program are.
TEST(Clocks, AMouseLikeItsLeaderHasTheDatesOfTheLeadersClockAndMovesNothing) {
  Clocks clocks;
  const ClockId leader = clocks.add(), mouse = clocks.add(Lead::never), other = clocks.add();
  clocks.follow_first(kGridRate);
  EXPECT_EQ(dated(clocks, leader, 1'000'000, 28'000), Time{25'000});
  EXPECT_EQ(clocks.date_like(leader, mouse, Time{1'008'000}), Time{33'000});
  EXPECT_EQ(dated(clocks, other, 2'000'000, 700'400), Time{700'400});
  EXPECT_EQ(clocks.date_like(other, mouse, Time{2'001'000}), Time{701'400});
  EXPECT_EQ(dated(clocks, leader, 1'010'000, 38'000), Time{35'000});
}

}  // namespace
}  // namespace headpin::devices
