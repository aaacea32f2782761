// What an emulated unit keeps and forgets at its start, while it saves and when its stream ends; and
// what it does where a limit is met exactly.

#include <array>
#include <bit>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/fastrak/emulator.h"
#include "tests/devices/fastrak_unit.h"

namespace headpin::devices {
namespace {

using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

using namespace std::chrono_literals;

/// A unit that starts and saves in no long time, and what it sent.
struct QuickUnit {
  explicit QuickUnit(int receivers, const std::string& faults = "noise=0",
                     FastrakMotion motion = still_motion)
      : bench(quick(receivers, faults), std::move(motion)) {}
  QuickUnit(const QuickUnit&) = delete;
  QuickUnit& operator=(const QuickUnit&) = delete;

  FastrakEmulatorOptions quick(int receivers, const std::string& faults) {
    FastrakEmulatorOptions options;
    options.receivers = receivers;
    options.faults = parse_faults(faults);
    options.boot_time = 100ms;
    options.save_time = 50ms;
    options.on_record = [this](const FastrakSent& record) { sent.push_back(record); };
    return options;
  }

  std::vector<FastrakSent> sent;
  Unit bench;
};

// --- Options -----------------------------------------------------------------------------------

TEST(FastrakEmulatorTest, OptionsThatNoUnitHasAreRefused) {
  const auto with = [](int receivers, int stylus, int baud) {
    FastrakEmulatorOptions options;
    options.receivers = receivers;
    options.stylus = stylus;
    options.baud = baud;
    const FastrakEmulator unit(options, still_motion);
  };
  EXPECT_NO_THROW(with(1, 0, 2400));
  EXPECT_NO_THROW(with(4, 4, 115200));
  for (const int receivers : {-1, 0, 5}) {
    EXPECT_THROW(with(receivers, 1, 115200), std::invalid_argument) << receivers;
  }
  for (const int stylus : {-1, 5}) {
    EXPECT_THROW(with(2, stylus, 115200), std::invalid_argument) << stylus;
  }
  EXPECT_THROW(with(2, 1, 1200), std::invalid_argument);
}

TEST(FastrakEmulatorTest, TheStatusHasTheFirmwareOfTheUnit) {
  FastrakEmulatorOptions options = Unit::quiet();
  options.firmware = "3.8.01";
  Unit unit(options);
  EXPECT_EQ(unit.ask("S").substr(15, 6), "3.8.01");
}

// --- Start -------------------------------------------------------------------------------------

TEST(FastrakStartTest, ASavedFormatIsThatAfterTheNextStart) {
  QuickUnit unit(1);
  unit.bench.ask("fu\x0b");
  unit.bench.type("\x19");
  unit.bench.listen(200ms);
  EXPECT_THAT(unit.bench.ask("S"), StartsWith("21S3F3"));  // binary, centimetres
}

TEST(FastrakStartTest, WhatWasAskedBeforeIsNotAnswered) {
  FastrakEmulatorOptions options = one_receiver();
  options.boot_time = 0ms;
  Unit unit(options);
  EXPECT_EQ(unit.ask("S\x19"), "");
  EXPECT_EQ(unit.ask("S").size(), 55u);
}

TEST(FastrakStartTest, AGuidedAlignmentIsOver) {
  QuickUnit unit(1);
  EXPECT_EQ(unit.bench.ask("A0\rP"), "");
  unit.bench.type("\x19");
  unit.bench.listen(200ms);
  EXPECT_THAT(unit.bench.ask("P"), StartsWith("01 "));
}

TEST(FastrakStartTest, ASavedStreamBeginsWithTheFirstStationWhereverItWas) {
  QuickUnit unit(4);
  unit.bench.type("C\x0b");
  unit.bench.listen(200ms);
  for (int i = 0; i < 12; ++i) {
    unit.bench.listen(20ms + i * 3ms);
    unit.bench.emulator.power_cycle(unit.bench.now);
    unit.sent.clear();
    unit.bench.listen(200ms);
    ASSERT_GE(unit.sent.size(), 4u);
    EXPECT_EQ(unit.sent[0].station, 1) << i;
  }
}

TEST(FastrakStartTest, AUnitSendsUntilItIsSwitchedOffAndStopsWithinAByte) {
  Unit unit(one_receiver());
  unit.type("C");
  unit.emulator.power_cycle(Time{100ms});
  EXPECT_GT(unit.emulator.due(Time{100ms}).size(), 9u * 47u);  // twelve cycles

  FastrakEmulatorOptions options = one_receiver();
  options.baud = 2400;
  options.boot_time = 0ms;
  Unit slow(options);
  slow.type("C");
  EXPECT_GT(slow.listen(100ms).size(), 10u);  // a record takes 196 ms
  slow.emulator.power_cycle(slow.now);
  EXPECT_EQ(slow.listen(1s), "");
}

// --- Time --------------------------------------------------------------------------------------

TEST(FastrakTimingTest, ACommandIsHeardWhenItComesAndNeverEarlierThanTheLastCall) {
  FastrakEmulator unit(one_receiver(), still_motion);
  const std::array<std::uint8_t, 1> S = {'S'};
  unit.receive(S, 1000ms);
  EXPECT_EQ(unit.due(1005ms).size(), 0u);
  EXPECT_EQ(unit.due(1020ms).size(), 55u);
  unit.taken(55);
  unit.receive(S, 500ms);
  EXPECT_EQ(unit.now(), Time{1020ms});
  EXPECT_EQ(unit.due(1026ms).size(), 0u);
  EXPECT_EQ(unit.due(1040ms).size(), 55u);
}

TEST(FastrakTimingTest, AStationThatTheUnitLacksIsNeverMeasured) {
  Unit unit;
  unit.type("f");
  EXPECT_FALSE(unit.emulator.next_measured(5, Time{}));
  EXPECT_FALSE(unit.emulator.next_measured(0, Time{}));
}

TEST(FastrakTimingTest, EachStreamBeginsWithTheFirstStationAtItsZero) {
  QuickUnit unit(4);
  for (int i = 0; i < 12; ++i) {
    unit.sent.clear();
    unit.bench.type("C");
    unit.bench.listen(100ms + i * 3ms);
    unit.bench.type("C");  // again, which disturbs nothing
    unit.bench.listen(100ms);
    unit.bench.type("c");
    unit.bench.listen(50ms);
    ASSERT_GE(unit.sent.size(), 20u);
    EXPECT_GE(unit.bench.emulator.stream_zero(), unit.sent[0].measured);
    for (std::size_t k = 0; k < unit.sent.size(); ++k) {
      ASSERT_EQ(unit.sent[k].station, static_cast<int>(k % 4) + 1) << i;
    }
  }
  EXPECT_EQ(unit.bench.emulator.statistics().dropped, 0);
  unit.sent.clear();
  unit.bench.type("C");
  const Time zero = unit.bench.emulator.stream_zero();
  unit.bench.listen(100ms);
  EXPECT_EQ(unit.sent.at(0).measured, zero);
}

TEST(FastrakTimingTest, AStreamStartedWhileItSavesHasItsZeroAfterwards) {
  std::vector<FastrakSent> sent;
  FastrakEmulatorOptions options = one_receiver();
  options.on_record = [&](const FastrakSent& record) { sent.push_back(record); };
  Unit unit(options);
  unit.type(
      "\x0b"
      "C");
  unit.emulator.due(3100ms);  // in one go
  ASSERT_FALSE(sent.empty());
  EXPECT_GT(sent[0].measured, Time{3000ms} - 6ms);
  EXPECT_EQ(unit.emulator.stream_zero(), sent[0].measured);
}

TEST(FastrakTimingTest, StationsThatAreSwitchedInAStreamAreNotDroppedOnes) {
  QuickUnit unit(4);
  unit.bench.type("C");
  for (int i = 0; i < 40; ++i) {
    unit.bench.listen(20ms + i % 12 * 3ms);
    unit.bench.type(i % 2 == 0 ? "l3,0\r" : "l3,1\r");
  }
  EXPECT_GT(unit.sent.size(), 150u);
  EXPECT_EQ(unit.bench.emulator.statistics().dropped, 0);
}

// --- While it saves ----------------------------------------------------------------------------

TEST(FastrakSaveTest, AStreamRestsWhileItSavesAndGoesOn) {
  Unit unit(one_receiver());
  unit.type("C");
  unit.listen(100ms);
  unit.type("\x0b");
  EXPECT_LT(unit.listen(2900ms).size(), 47u);  // the record in hand
  EXPECT_GT(unit.listen(300ms).size(), 10u * 47u);
}

TEST(FastrakSaveTest, AKilobyteOfCommandsWaitsAndTheRestIsLost) {
  QuickUnit unit(1);
  unit.bench.type("\x0b");
  unit.bench.type(std::string(600, 'D'));
  unit.bench.type(std::string(600, 'D'));
  unit.bench.listen(100ms);
  EXPECT_EQ(unit.bench.emulator.statistics().commands, 1 + 1024);
}

TEST(FastrakSaveTest, WhatWaitsEndsWhereItsBytesEnd) {
  QuickUnit unit(1);
  const std::string text =
      "\x0b"
      "Dddd";
  unit.bench.type(std::string_view(text).substr(0, 2));
  unit.bench.listen(100ms);
  EXPECT_EQ(unit.bench.emulator.statistics().commands, 2);
  EXPECT_TRUE(unit.bench.emulator.setup().compensation);
}

// --- The end of a stream -----------------------------------------------------------------------

// At 2400 baud and nine bits a byte, the next record waits for 1.25 ms while the last byte leaves.
TEST(FastrakStreamTest, EndsWithTheRecordInHandWheneverThatIs) {
  for (const char* end : {"c", "W"}) {
    for (Time t = 170ms; t < 195ms; t += 1ms) {
      FastrakEmulatorOptions options = one_receiver();
      options.baud = 2400;
      Unit unit(options);
      unit.type("o,N,7,0\rC");
      const std::size_t before = unit.listen(t).size();
      unit.type(end);
      const std::size_t rest = unit.listen(400ms).size();
      EXPECT_LT(rest, 47u) << end << " after " << t.count() << " us";
      EXPECT_EQ((before + rest) % 47, 0u) << end << " after " << t.count() << " us";
    }
  }
}

TEST(FastrakStreamTest, ItsEndTakesNoAnswerAlong) {
  for (const char* end : {"Sc", "SW"}) {
    Unit unit;
    EXPECT_EQ(unit.ask(end).size(), 55u) << end;
  }
}

TEST(FastrakStreamTest, AnIncrementHoldsNoFirstRecordAndNoneThatMovedByIt) {
  Vec3 p(0.25, 0, 0);
  Unit unit(one_receiver(), [&](int, Time) { return FastrakTruth{{Quat::Identity(), p}}; });
  unit.type("uI1,50\rC");
  EXPECT_EQ(unit.listen(1s).size(), 47u);
  p.x() = 0.75;
  EXPECT_EQ(unit.listen(1s).size(), 47u);
}

// --- Measurements ------------------------------------------------------------------------------

TEST(FastrakFieldTest, AtTenFeetExactlyTheSignalIsNotLow) {
  FastrakEmulatorOptions options = one_receiver();
  options.envelope = 4.0;
  Unit unit(options, at(Vec3(kFastrakRange, 0, 0)));
  EXPECT_EQ(ascii_record(unit.ask("P")).error, ' ');
}

// A step of 2 inches and 2 degrees, and F 0.2: the weights are 0.4, then 0.95 of that.
TEST(FastrakFieldTest, AFilterOpensByFTimesTheInchesAndTheDegreesOfAStep) {
  const FastrakMotion step = [](int, Time t) {
    const double done = t < 1s ? 0.0 : 1.0;
    return FastrakTruth{
        {from_angles_deg(Vec3(2.0 * done, 0, 0)), kMetrePerInch * Vec3(20.0 + 2.0 * done, 0, 0)}};
  };
  QuickUnit unit(1, "noise=0", step);
  unit.bench.type("x0.2,0.05,0.8,0.95\rv0.2,0.05,0.8,0.95\rO1,52,54,1\rC");
  unit.bench.listen(1100ms);
  std::vector<double> x, azimuth;
  for (const FastrakSent& sent : unit.sent) {
    if (sent.measured < 1s) continue;
    const auto record = decode_record(sent.bytes, {{52, 54, 1}, false, false});
    ASSERT_TRUE(record);
    x.push_back(record->position.x());
    azimuth.push_back(record->angles_deg.x());
  }
  ASSERT_GE(x.size(), 2u);
  EXPECT_NEAR(x[0], 20.0 + 0.4 * 2.0, 1e-3);
  EXPECT_NEAR(azimuth[0], 0.4 * 2.0, 1e-3);
  EXPECT_NEAR(x[1], 20.8 + 0.38 * 1.2, 1e-3);
  EXPECT_NEAR(azimuth[1], 0.8 + 0.38 * 1.2, 1e-3);
}

TEST(FastrakFieldTest, BoresightMeasuresAReceiverThatHasNotBeenMeasured) {
  Unit unit(one_receiver(), at(Vec3(0.5, 0, 0), from_angles_deg(Vec3(30, 0, 0))));
  unit.type("B1\r");
  EXPECT_NEAR(ascii_record(unit.ask("P")).angles_deg.x(), 0.0, 0.005);
}

TEST(FastrakFieldTest, AStationThatIsSwitchedOnReportsWhereItsReceiverIsNow) {
  Unit unit;
  unit.listen(100ms);
  unit.type("l2,0\r");
  unit.emulator.set_motion(at(kMetrePerInch * Vec3(30, 0, 0)));
  const std::string answer = unit.ask("l2,1\rP");
  ASSERT_EQ(answer.size(), 94u);
  EXPECT_EQ(answer.substr(47, 10), "02   30.00");
}

TEST(FastrakFieldTest, AReceiverThatIsPluggedInLaterCanBeSwitchedOn) {
  FastrakEmulatorOptions options = Unit::quiet();
  options.faults = parse_faults("noise=0,unplug=2@0-2");
  Unit unit(options);
  EXPECT_EQ(unit.ask("l2,1\rl1\r"), "21l1000\r\n");
  unit.listen(2s);
  EXPECT_EQ(unit.ask("l2,1\rl1\r"), "21l1100\r\n");
}

TEST(FastrakFieldTest, TheSwitchOfAStylusThatIsPulledOutIsNotPressed) {
  FastrakEmulatorOptions options = one_receiver();
  options.faults = parse_faults("noise=0,unplug=1@1");
  Unit unit(options, [](int station, Time time) {
    FastrakTruth truth = still_motion(station, time);
    truth.pressed = true;
    return truth;
  });
  unit.type("e1,0\rO1,2,16,1\r");
  EXPECT_THAT(unit.ask("P"), EndsWith(" 1\r\n"));
  unit.listen(1s);
  EXPECT_THAT(unit.ask("P"), EndsWith(" 0\r\n"));
}

TEST(FastrakFieldTest, AGuidedAlignmentThroughOnePointIsRefused) {
  Unit unit(one_receiver());
  EXPECT_EQ(unit.ask("A0\rPP"), "");
  EXPECT_EQ(unit.ask("P"), "2 E*ERROR* A0 *ERROR* EC -3 *PS  1 *FL 0 *ST 0\r\n");
  EXPECT_THAT(unit.ask("P"), StartsWith("01 "));
}

// --- Bytes -------------------------------------------------------------------------------------

TEST(FastrakGrammarTest, TheLongestLineHas254Bytes) {
  for (const std::size_t length : {254u, 255u}) {
    Unit unit;
    const std::string line = "H1,0,0," + std::string(length - 8, ' ') + "1";
    ASSERT_EQ(line.size(), length);
    const std::string answer = unit.ask(line + "\r");
    if (length == 254) {
      EXPECT_EQ(answer, "");
      EXPECT_EQ(unit.ask("H1\r"), "21H   0.00   0.00   1.00\r\n");
    } else {
      EXPECT_THAT(answer, HasSubstr("EC -5"));
    }
  }
}

TEST(FastrakGrammarTest, TheEighthBitCountsOnlyWhereThePortHasOne) {
  const std::string S_with_parity = "\xD3";
  Unit unit;
  EXPECT_THAT(unit.ask(S_with_parity), StartsWith("2 E*ERROR*"));
  unit.type("o,N,7,0\r");
  EXPECT_THAT(unit.ask(S_with_parity), StartsWith("21S"));
}

TEST(FastrakFaultTest, OfALostRecordNoByteComes) {
  QuickUnit unit(1, "dropout=1");
  unit.bench.type("C");
  EXPECT_EQ(unit.bench.listen(1s), "");
  EXPECT_NEAR(static_cast<double>(unit.bench.emulator.statistics().lost), 120.0, 1.0);
  EXPECT_TRUE(unit.sent.empty());
}

TEST(FastrakFaultTest, GarbageIsCountedToTheByte) {
  QuickUnit unit(1, "garbage=1");
  unit.bench.type("C");
  std::size_t heard = unit.bench.listen(1s).size();
  unit.bench.type("c");
  heard += unit.bench.listen(100ms).size();
  const auto& statistics = unit.bench.emulator.statistics();
  const auto garbage = static_cast<std::size_t>(statistics.garbage_bytes);
  const std::size_t records = unit.sent.size();
  EXPECT_EQ(heard, 47 * records + garbage);
  EXPECT_GE(garbage, records);
  EXPECT_LE(garbage, 8 * records);
}

TEST(FastrakFaultTest, OfADamagedRecordOneBitIsFlippedWhicheverItIs) {
  QuickUnit good(1, "noise=0"), bad(1, "noise=0,damage=1");
  for (QuickUnit* unit : {&good, &bad}) {
    unit->bench.type("fC");
    unit->bench.listen(2s);
  }
  ASSERT_EQ(bad.sent.size(), good.sent.size());
  std::set<int> flipped;
  for (std::size_t i = 0; i < bad.sent.size(); ++i) {
    EXPECT_TRUE(bad.sent[i].damaged && !good.sent[i].damaged);
    ASSERT_EQ(bad.sent[i].bytes.size(), good.sent[i].bytes.size());
    int bits = 0;
    for (std::size_t k = 0; k < bad.sent[i].bytes.size(); ++k) {
      const auto changed = static_cast<unsigned>(bad.sent[i].bytes[k] ^ good.sent[i].bytes[k]);
      bits += std::popcount(changed);
      if (changed != 0) flipped.insert(std::countr_zero(changed));
    }
    EXPECT_EQ(bits, 1) << i;
  }
  EXPECT_EQ(flipped.size(), 8u);
  EXPECT_EQ(bad.bench.emulator.statistics().damaged, bad.bench.emulator.statistics().records);
}

}  // namespace
}  // namespace headpin::devices
