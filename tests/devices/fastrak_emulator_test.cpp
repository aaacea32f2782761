#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/fastrak/emulator.h"
#include "tests/devices/fastrak_unit.h"
#include "tests/support/folder.h"

namespace headpin::devices {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

using namespace std::chrono_literals;

// --- Grammar ---------------------------------------------------------------------------------

TEST(FastrakGrammarTest, LinesEndInCrOrLfOrBoth) {
  for (const std::string end : {"\r", "\n", "\r\n", "\n\r"}) {
    Unit unit;
    EXPECT_EQ(unit.ask("O1,2,11,0" + end + "O1" + end), "21O 211 0\r\n");
    EXPECT_EQ(unit.ask("u" + end + "f" + end + "l1" + end), "21l1100\r\n");
    EXPECT_EQ(unit.emulator.statistics().refused, 0);
  }
}

TEST(FastrakGrammarTest, NumbersComeInEveryShapeTheManualAllows) {
  for (const std::string number : {"3", "3.", "3.0", "3.0E+00", "+3.000", "    3.0000", "3.0 "}) {
    Unit unit;
    unit.type("H1," + number + ",0,0\r");
    EXPECT_EQ(unit.ask("H1\r"), "21H   3.00   0.00   0.00\r\n") << number;
  }
  for (const std::string number :
       {"x", "nan", "inf", "0x3", "3..0", "--3", "3 4", "+-3", "1e400"}) {
    Unit unit;
    EXPECT_THAT(unit.ask("H1," + number + ",0,0\r"), HasSubstr("*ERROR* EC -")) << number;
    EXPECT_EQ(unit.ask("H1\r"), "21H   1.00   0.00   0.00\r\n") << number;
  }
}

TEST(FastrakGrammarTest, EmptyFieldsKeepAndTrailingOnesMayBeDropped) {
  Unit unit;
  unit.type("H1,1,2,3\r");
  unit.type("H1,,5\r");
  EXPECT_EQ(unit.ask("H1\r"), "21H   1.00   5.00   3.00\r\n");
  EXPECT_EQ(unit.ask("H1,\r\n"), "21H   1.00   5.00   3.00\r\n");  // as Vrui asks N1,
}

TEST(FastrakGrammarTest, CommandsComeTogetherAndInPieces) {
  Unit unit;
  for (const char c : std::string_view("O1,2,11,0\r")) unit.ask(std::string(1, c));
  EXPECT_EQ(unit.ask("O1\ruS").substr(0, 11), "21O 211 0\r\n");
  EXPECT_TRUE(unit.emulator.setup().centimetres);
}

TEST(FastrakGrammarTest, ControlBytesActInMidLine) {
  Unit unit;
  unit.type("C");
  unit.listen(100ms);
  unit.type("O1,2,\x13");
  EXPECT_EQ(unit.listen(200ms), "");
  unit.type("11,0\r\x11");
  EXPECT_GT(unit.listen(200ms).size(), 0u);
  unit.type("c");
  unit.listen(100ms);
  EXPECT_EQ(unit.ask("O1\r"), "21O 211 0\r\n");
  unit.type(
      "O1,2,\x19"
      "4,1\r");
  unit.listen(11s);
  EXPECT_EQ(unit.ask("O1\r"), "21O 2 4 1\r\n");  // factory: the line went with the set-up
}

TEST(FastrakGrammarTest, AnUnknownLetterDoesNotTakeTheRestAlong) {
  Unit unit;
  EXPECT_EQ(unit.ask("tl1\r"), "2 E*ERROR* t *ERROR* EC-99 *PS  0 *FL 0 *ST 0\r\n21l1100\r\n");
  unit.type("f");
  EXPECT_EQ(unit.ask("Yt"), "");  // binary mode: refused in silence
  EXPECT_EQ(unit.emulator.statistics().refused, 3);
}

TEST(FastrakGrammarTest, ABareReturnGetsALineAndABareLineFeedNothing) {
  Unit unit;
  EXPECT_EQ(unit.ask("\n"), "");
  EXPECT_EQ(unit.ask("\r"), "");  // the other half of LF CR
  EXPECT_EQ(unit.ask("u\r\n"), "");
  EXPECT_THAT(unit.ask("\r"), StartsWith("2 E*ERROR*"));
  EXPECT_THAT(unit.ask("\r"), StartsWith("2 E*ERROR*"));
}

TEST(FastrakGrammarTest, RefusalsSayWhereAndWhy) {
  Unit unit;
  EXPECT_EQ(unit.ask("H2,1,abc,0\r"), "2 E*ERROR* H2,1,abc,0 *ERROR* EC -2 *PS  5 *FL 2 *ST 1\r\n");
  EXPECT_THAT(unit.ask("H\r"), HasSubstr("EC -1 *PS  1 *FL 0 *ST 0"));
  EXPECT_THAT(unit.ask("H5,1\r"), HasSubstr("EC -3 *PS  1 *FL 0"));
  EXPECT_THAT(unit.ask("l1,2\r"), HasSubstr("EC -3 *PS  3 *FL 1"));
  EXPECT_THAT(unit.ask("y3\r"), HasSubstr("EC -3 *PS  1 *FL 0 *ST 0"));  // of the whole unit
  EXPECT_THAT(unit.ask("X" + std::string(300, 'a') + "\r"), HasSubstr("EC -5"));
}

TEST(FastrakGrammarTest, AnyBytesWhateverLeaveItAnswering) {
  std::mt19937 random(6);
  const std::string alphabet = "PCcSFfUuDdWABbeGHIlNOoQRrTVvXxy0123456789,.-+E*\r\n \x0b\x11\x13";
  for (int round = 0; round < 200; ++round) {
    Unit unit(one_receiver());
    for (int i = 0; i < 300; ++i) {
      const char c =
          random() % 20 == 0 ? static_cast<char>(random()) : alphabet[random() % alphabet.size()];
      unit.type(std::string(1, c));
      if (random() % 10 == 0) unit.listen(Time{1000 * static_cast<int>(random() % 20)});
    }
    unit.emulator.power_cycle(unit.now);
    unit.listen(11s);
    unit.type("Fo1152,N,8,0\rc");
    unit.listen(1s);
    EXPECT_THAT(unit.ask("S"), StartsWith("21S"));
  }
}

// --- Timing ----------------------------------------------------------------------------------

TEST(FastrakTimingTest, OneHundredAndTwentyCyclesAreShared) {
  for (int receivers = 1; receivers <= 4; ++receivers) {
    FastrakEmulatorOptions options = Unit::quiet();
    options.receivers = receivers;
    std::array<int, 4> count{};
    options.on_record = [&](const FastrakSent& sent) {
      ++count[static_cast<std::size_t>(sent.station - 1)];
    };
    Unit unit(options);
    unit.type("O1,2,11,0\rO2,2,11,0\rO3,2,11,0\rO4,2,11,0\rfC");
    unit.listen(10s);
    for (int s = 0; s < 4; ++s) {
      EXPECT_NEAR(count[static_cast<std::size_t>(s)], s < receivers ? 1200 / receivers : 0, 1);
    }
    EXPECT_EQ(unit.emulator.statistics().dropped, 0);
  }
}

// fastrak.md section 8: 32-byte records of two receivers just fit 38400 baud at the full rate.
TEST(FastrakTimingTest, TwoReceiversInBinaryJustFit38400) {
  FastrakEmulatorOptions options = Unit::quiet();
  options.baud = 38400;
  Unit unit(options);
  unit.type("O1,2,11,0\rO2,2,11,0\rfC");
  unit.listen(10s);
  EXPECT_EQ(unit.emulator.statistics().dropped, 0);
  EXPECT_NEAR(static_cast<double>(unit.emulator.statistics().records), 1200.0, 3.0);
}

TEST(FastrakTimingTest, ASlowLineDropsWholeRecordsAndKeepsTheOrder) {
  FastrakEmulatorOptions options = Unit::quiet();
  options.baud = 9600;
  Unit unit(options);
  unit.type("C");
  const std::string heard = unit.listen(10s);
  EXPECT_LE(heard.size(), 9600u);
  EXPECT_GT(unit.emulator.statistics().dropped, 0);
  for (std::size_t i = 0; i + 47 <= heard.size(); i += 47) {
    EXPECT_EQ(heard.substr(i, 2), i / 47 % 2 == 0 ? "01" : "02");
    EXPECT_EQ(heard.substr(i + 45, 2), "\r\n");
  }
}

TEST(FastrakTimingTest, AnIdleReaderCostsWholeRecords) {
  Unit unit;
  unit.type("C");
  unit.listen(100ms);
  for (int ms = 0; ms < 5000; ++ms) unit.emulator.due(unit.now += 1ms);  // nobody takes any
  const std::string heard = unit.listen(1s);
  EXPECT_GT(unit.emulator.statistics().dropped, 500);
  const std::size_t first = heard.find("\r\n") + 2;
  for (std::size_t i = first; i + 47 <= heard.size(); i += 47) {
    EXPECT_THAT(heard.substr(i, 3), testing::AnyOf("01 ", "02 "));
    EXPECT_EQ(heard.substr(i + 45, 2), "\r\n");
  }
}

// The measurement is 3.75 ms older than the solution, and that leaves byte by byte.
TEST(FastrakTimingTest, RecordsAreAsOldAsTheManualSays) {
  FastrakEmulatorOptions options = one_receiver();
  std::vector<FastrakSent> sent;
  options.on_record = [&](const FastrakSent& record) { sent.push_back(record); };
  Unit unit(options);
  unit.type("C");
  std::vector<Time> arrived;
  Time now{};
  std::size_t bytes = 0;
  while (arrived.size() < 100) {
    now += 10us;
    const std::size_t n = unit.emulator.due(now).size();
    unit.emulator.taken(n);
    if (bytes % 47 == 0 && n > 0) arrived.push_back(now);
    bytes += n;
  }
  const Time one_byte{87};  // 10 bits at 115200
  for (std::size_t i = 0; i < 99; ++i) {
    EXPECT_NEAR(static_cast<double>((arrived[i] - sent[i].measured).count()),
                static_cast<double>((Time{3750} + one_byte).count()), 11.0);
  }
}

TEST(FastrakTimingTest, AnswersComeAfterACycleAndInOnePiece) {
  Unit unit;
  unit.type("fC");
  unit.listen(503ms);
  unit.type("S");
  const std::string heard = unit.listen(100ms);
  const std::size_t at = heard.find("21S3F9");
  ASSERT_NE(at, std::string::npos);
  EXPECT_TRUE(decode_status(heard.substr(at, 55)));
  Unit idle;
  idle.type("S");
  EXPECT_EQ(idle.listen(8ms), "");
  EXPECT_EQ(idle.listen(6ms).size(), 55u);
}

TEST(FastrakTimingTest, EqualInputGivesEqualBytes) {
  const auto run = [] {
    FastrakEmulatorOptions options;
    options.seed = 42;
    options.faults = parse_faults("garbage=0.1,dropout=0.1,damage=0.05,metal=0.02");
    Unit unit(options, circling_motion);
    unit.type("fC");
    return unit.listen(5s);
  };
  EXPECT_EQ(run(), run());
}

// --- Field -----------------------------------------------------------------------------------

// Near its transmitter a Fastrak's noise is far below a tenth of an inch and half a degree.
TEST(FastrakNoiseTest, OfAReceiverAtRestIsSmallAndThere) {
  Unit unit(FastrakEmulatorOptions{});
  const FastrakRecord still = ascii_record(Unit().ask("P").substr(0, 47));
  double turned = 0.0;
  for (int i = 0; i < 50; ++i) {
    const FastrakRecord record = ascii_record(unit.ask("P").substr(0, 47));
    EXPECT_LT((record.position - still.position).norm(), 0.1) << i;
    EXPECT_LT((record.angles_deg - still.angles_deg).norm(), 0.5) << i;
    turned = std::max(turned, (record.angles_deg - still.angles_deg).norm());
  }
  EXPECT_GT(turned, 0.0);
}

double spread(double range) {
  FastrakEmulatorOptions options;
  options.receivers = 1;
  double sum = 0.0;
  int count = 0;
  options.on_record = [&](const FastrakSent& sent) {
    const auto record = decode_record(sent.bytes, {{2, 11, 0}, true, true});
    if (!record) return;
    const double error = record->position.z() * kMetrePerCentimetre;
    sum += error * error;
    ++count;
  };
  Unit unit(options, at(Vec3(range, 0, 0)));
  unit.type("uO1,2,11,0\rfC");
  unit.listen(20s);
  return std::sqrt(sum / count);
}

TEST(FastrakFieldTest, NoiseIsTheDataSheetsNearAndGrowsFar) {
  // Deviation of 2400 samples: known to 1.5 percent, so 5 percent is more than three of those.
  EXPECT_NEAR(spread(0.5), 0.0002 * 0.5, 0.05 * 0.0002 * 0.5);
  const double far = 0.0002 * 1.524 * 8.0;  // twice 30 inches: eight times the share
  EXPECT_NEAR(spread(1.524), far, 0.05 * far);
}

TEST(FastrakFieldTest, BeyondTenFeetTheSignalIsLow) {
  Unit unit(one_receiver(), at(Vec3(3.2, 0, 0)));
  EXPECT_EQ(ascii_record(unit.ask("P")).error, 'k');
}

// E-4: a filter of constant weight a lags behind a steady slew by (1 - a) / a cycles.
TEST(FastrakFieldTest, AFilterLagsASteadySlewAsTheManualSays) {
  const double speed = 0.05;  // m/s
  Unit unit(one_receiver(), [&](int, Time t) {
    return FastrakTruth{{Quat::Identity(), Vec3(0.3 + speed * seconds(t), 0, 0)}};
  });
  unit.type("uO1,52,1\rx0,0.05,0.05,0.5\r");
  unit.listen(5s);
  std::string line = unit.ask("P");
  std::vector<FastrakSent> sent;
  const double reported = ascii_record(line, {52, 1}, true).position.x() * kMetrePerCentimetre;
  // The newest solution at the command: measured at a cycle's start + 1.75 ms.
  const Time asked = unit.now - 100ms;
  const std::int64_t cycle = (asked - Time{5500}).count() * 120 / 1'000'000;
  const double truth = 0.3 + speed * seconds(tick_time(cycle, 120) + Time{1750});
  EXPECT_NEAR((truth - reported) / speed, (1 - 0.05) / 0.05 / 120.0, 0.001);  // 158 ms
}

// --- Faults ----------------------------------------------------------------------------------

FastrakEmulatorOptions with_faults(const std::string& spec) {
  FastrakEmulatorOptions options;
  options.faults = parse_faults(spec);
  return options;
}

TEST(FastrakFaultTest, DeafToTheFirstStatusRequests) {
  Unit unit(with_faults("deaf=2"));
  EXPECT_EQ(unit.ask("S"), "");
  EXPECT_EQ(unit.ask("S"), "");
  EXPECT_EQ(unit.ask("S").size(), 55u);
}

TEST(FastrakFaultTest, SilenceIsDeafAndDumbAndEndsByItself) {
  Unit unit(with_faults("silence=4@1"));
  unit.type("C");
  const std::string before = unit.listen(1100ms);
  EXPECT_EQ(before.size() % 47, 0u);  // the record in hand was finished
  unit.type("c");
  EXPECT_EQ(unit.listen(3800ms), "");
  EXPECT_GT(unit.listen(1s).size(), 0u);  // still streaming: the c was not heard
}

TEST(FastrakFaultTest, AStuckReceiverRepeatsItself) {
  for (const char* faults : {"noise=0,stuck=2@1-2", "stuck=2@1-2", "noise=20,stuck=2@1-2"}) {
    Unit unit(with_faults(faults), circling_motion);
    unit.listen(1200ms);
    const std::string first = unit.ask("P"), second = unit.ask("P");
    EXPECT_EQ(first.substr(47), second.substr(47)) << faults;
    EXPECT_NE(first.substr(0, 47), second.substr(0, 47)) << faults;
    unit.listen(1s);
    EXPECT_NE(unit.ask("P").substr(47), first.substr(47)) << faults;
  }
}

TEST(FastrakFaultTest, AnUnpluggedReceiverSaysSoAndIsMissedAtTheNextStart) {
  Unit unit(with_faults("noise=0,unplug=2@1"));
  EXPECT_EQ(unit.ask("P").substr(47, 3), "02 ");
  unit.listen(1s);
  EXPECT_EQ(unit.ask("P").substr(47, 3), "02l");
  unit.type("\x19");
  unit.listen(11s);
  EXPECT_EQ(unit.ask("l1\r"), "21l1000\r\n");
}

TEST(FastrakFaultTest, AReceiverThatIsPluggedInIsThereAtTheNextStart) {
  Unit unit(with_faults("noise=0,unplug=2@0-2"));
  EXPECT_EQ(unit.ask("l1\r"), "21l1000\r\n");
  unit.listen(2200ms);
  unit.emulator.power_cycle(unit.now);
  unit.listen(11s);
  EXPECT_EQ(unit.ask("l1\r"), "21l1100\r\n");
}

TEST(FastrakEmulatorTest, ABinaryZeroHasNoSign) {
  Unit unit(Unit::quiet(), at(Vec3(0.5, 0, 0)));
  unit.ask("f");
  EXPECT_EQ(unit.ask("P").substr(3 + 12, 12), std::string(12, '\0'));  // the three angles
}

TEST(FastrakFaultTest, DropoutLosesItsShareWhole) {
  Unit unit(with_faults("dropout=0.25"));
  unit.type("C");
  unit.listen(20s);
  const auto& s = unit.emulator.statistics();
  EXPECT_NEAR(static_cast<double>(s.lost) / static_cast<double>(s.lost + s.records), 0.25, 0.03);
}

TEST(FastrakFaultTest, MetalBendsTheFieldWithTheSquareOfTheDistance) {
  Unit near(with_faults("noise=0,metal=0.05"), at(Vec3(0.5, 0, 0)));
  Unit far(with_faults("noise=0,metal=0.05"), at(Vec3(1, 0, 0)));
  const auto off = [](Unit& unit, double x) {
    unit.type("ul2,0\rO1,52,1\r");
    return (ascii_record(unit.ask("P"), {52, 1}, true).position - 100.0 * Vec3(x, 0, 0)).norm();
  };
  EXPECT_NEAR(off(near, 0.5), 1.25, 0.001);  // cm
  EXPECT_NEAR(off(far, 1.0), 5.0, 0.001);
}

TEST(FastrakFaultTest, ASlowLineIsSlowerThanSet) {
  Unit unit(with_faults("slow=1200"));
  unit.type("C");
  EXPECT_LE(unit.listen(10s).size(), 1201u);
}

TEST(FastrakFaultTest, BadSpecificationsAreNamed) {
  for (const std::string spec :
       {"noise", "noise=x", "dropout=2", "stuck=5@1", "stuck=1", "stuck=1@5-4", "silence=4",
        "deaf=1.5", "loud=1", "=", ",", "slow=1", "silence=4@-1", "dropout=nan"}) {
    EXPECT_THROW(parse_faults(spec), std::invalid_argument) << spec;
  }
  const FastrakFaults f = parse_faults("stuck=2@5-8,silence=4@10,deaf=3");
  EXPECT_TRUE(f.stuck[0].when.holds(5s) && !f.stuck[0].when.holds(8s));
  EXPECT_TRUE(f.silence[0].holds(13s) && !f.silence[0].holds(14s));
  EXPECT_EQ(f.deaf, 3);
  for (const char* twice : {"noise=0,noise=5", "deaf=1, deaf=1", "slow=9600,noise=0,slow=9600"}) {
    EXPECT_THROW(parse_faults(twice), std::invalid_argument) << twice;
  }
  EXPECT_EQ(parse_faults("stuck=1@0-1,stuck=1@2-3,silence=1@4,silence=1@9").stuck.size(), 2u);
  EXPECT_NO_THROW(check_stations(f, 2));
  EXPECT_EQ(complaint([&] { check_stations(f, 1); }),
            "fault 'stuck=2@...': expected a station from 1 to 1");
  const FastrakFaults spaced = parse_faults(" noise=0, deaf=2 ");
  EXPECT_EQ(spaced.noise, 0.0);
  EXPECT_EQ(spaced.deaf, 2);
}

TEST(FastrakFaultTest, ABadSpecificationSaysWhatWasExpected) {
  const auto expect_says = [](const std::string& spec, const std::string& says) {
    EXPECT_EQ(complaint([&] { parse_faults(spec); }), says);
  };
  expect_says("noise=1, loud=2",
              "fault 'loud=2': expected one of noise, dropout, garbage, damage, metal, slow, deaf, "
              "stuck, unplug, silence");
  expect_says("deaf=1.5", "fault 'deaf=1.5': expected a whole number from 0 to 2147483647");
  expect_says("stuck=1@5-2",
              "fault 'stuck=1@5-2': it ends before it begins; expected STATION@FROM-TO with TO "
              "later than FROM, seconds");
  EXPECT_THAT(complaint([] { parse_faults("unplug=1@5-5"); }), HasSubstr("it ends when it begins"));
}

// A start in the middle of a turn waits for station 1; those cycles were counted as dropped.
TEST(FastrakTimingTest, OnlyWhatTheLineDidNotTakeIsCountedAsDropped) {
  FastrakEmulatorOptions options = Unit::quiet();
  options.receivers = 4;
  Unit unit(options);
  for (int i = 0; i < 20; ++i) {
    unit.type("C");
    EXPECT_GT(unit.listen(100ms + i * 3ms).size(), 0u);
    unit.type("c");
    unit.listen(50ms);
  }
  EXPECT_EQ(unit.emulator.statistics().dropped, 0);
  unit.type("C");
  unit.listen(100ms);
  unit.type("\x13");
  unit.listen(1s);
  unit.type("\x11");
  unit.listen(100ms);
  const std::int64_t held = unit.emulator.statistics().dropped;
  EXPECT_NEAR(static_cast<double>(held), 120.0, 4.0);
  unit.listen(1s);
  EXPECT_EQ(unit.emulator.statistics().dropped, held);
}

// What it had heard before counted, so that a unit in use could not be made deaf.
TEST(FastrakFaultTest, DeafFromThenOnWhereItIsSetLaterAndAfterEachPowerCycle) {
  Unit unit;
  EXPECT_EQ(unit.ask("S").size(), 55u);
  EXPECT_EQ(unit.ask("S").size(), 55u);
  unit.emulator.set_faults(parse_faults("deaf=1"));
  EXPECT_EQ(unit.ask("S"), "");
  EXPECT_EQ(unit.ask("S").size(), 55u);
  unit.emulator.power_cycle(unit.now);
  unit.listen(11s);
  EXPECT_EQ(unit.ask("S"), "");
  EXPECT_EQ(unit.ask("S").size(), 55u);
}

// The line end of "C \r" was a command of its own, and refused.
TEST(FastrakGrammarTest, BlanksBeforeTheLineEndOfAnImmediateCommandSayNothing) {
  for (const std::string command : {"u \r", "u  \r\n", "f \n", "u\r \n", " u \r"}) {
    Unit unit;
    EXPECT_EQ(unit.ask(command), "") << command;
    EXPECT_EQ(unit.emulator.statistics().refused, 0) << command;
  }
  Unit unit;
  EXPECT_THAT(unit.ask("O1,2,4,1\r \r"), HasSubstr("*ERROR*"));  // a bare CR, as before
}

}  // namespace
}  // namespace headpin::devices
