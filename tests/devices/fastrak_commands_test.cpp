// Every command that a Fastrak takes, as the manual's table has them.

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/fastrak/emulator.h"
#include "tests/devices/fastrak_unit.h"

namespace headpin::devices {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

using namespace std::chrono_literals;

Vec3 inches(double x, double y, double z) {
  return kMetrePerInch * Vec3(x, y, z);
}

TEST(FastrakCommandTest, PAnswersOneRecordOfEveryActiveStationInOrder) {
  Unit unit;
  const std::string answer = unit.ask("P");
  ASSERT_EQ(answer.size(), 94u);
  EXPECT_EQ(answer.substr(0, 47), "01   15.75  -3.94  -3.94   0.00   0.00   0.00\r\n");
  EXPECT_EQ(answer.substr(47), "02   15.75   0.00  -3.94   0.00   0.00   0.00\r\n");
}

TEST(FastrakCommandTest, AStationThatIsOffOrIsNoneIsNotMeasured) {
  Unit unit;
  ASSERT_TRUE(unit.emulator.next_measured(1, 50ms));
  EXPECT_GE(*unit.emulator.next_measured(1, 50ms), Time{50ms});
  EXPECT_TRUE(unit.emulator.next_measured(2, 50ms));
  unit.type("l2,0\r");
  unit.listen(50ms);
  for (const int station : {0, 2, 3, 4, 5}) {
    EXPECT_FALSE(unit.emulator.next_measured(station, 50ms)) << station;
  }
}

TEST(FastrakCommandTest, ABlankFieldOfAListKeepsItsItemTheLastOneToo) {
  Unit unit;
  unit.type("O1,2,11,1\r");
  unit.type("O1,2,4,\r");
  const std::string kept = unit.ask("O1\r");
  unit.type("O1,2,4,1\r");
  EXPECT_EQ(kept, unit.ask("O1\r"));
  unit.type("O1,,11,\r");
  const std::string first = unit.ask("O1\r");
  unit.type("O1,2,11,1\r");
  EXPECT_EQ(first, unit.ask("O1\r"));
}

TEST(FastrakCommandTest, SixtyRecordsASecondOfEachOfTwoStationsAfterC) {
  Unit unit;
  unit.type("f");
  unit.type("O1,2,11,0\rO2,2,11,0\r");
  unit.type("C");
  unit.listen(100ms);
  const std::string second = unit.listen(1s);
  EXPECT_NEAR(static_cast<double>(second.size()) / 32.0, 120.0, 1.0);
  unit.type("c");
  unit.listen(20ms);  // the record in hand
  EXPECT_EQ(unit.listen(1s), "");
}

TEST(FastrakCommandTest, FormatUnitCompensationAndStreamShowInTheStatus) {
  Unit unit;
  const auto flags = [&] { return unit.ask("S").substr(3, 3); };
  EXPECT_EQ(flags(), "3F0");
  unit.type("f");
  EXPECT_EQ(flags(), "3F1");
  unit.type("Fu");
  EXPECT_EQ(flags(), "3F2");
  unit.type("D");
  EXPECT_EQ(flags(), "3F6");
  unit.type("dU");
  EXPECT_EQ(flags(), "3F0");
}

TEST(FastrakCommandTest, StatusIsFiftyFiveBytesOfThe1990sByDefault) {
  Unit unit;
  EXPECT_EQ(unit.ask("S"), "21S3F0  0      103.00OutputCompensat CPG2030-003-10  \r\n");
  FastrakEmulatorOptions options = Unit::quiet();
  options.tag_2012 = true;
  Unit later(options);
  EXPECT_EQ(later.ask("S").substr(9, 6), " F33  ");
}

TEST(FastrakCommandTest, AReadsBackAndComposes) {
  Unit unit(one_receiver(), at(inches(20, 5, 0)));
  EXPECT_EQ(unit.ask("A1\r"),
            "21A   0.00   0.00   0.00  78.74   0.00   0.00   0.00  78.74   0.00\r\n");
  unit.type("A1,10,0,0,10,10,0,0,0,0\r");  // +X along the old +Y, +Y along the old -X
  const FastrakRecord moved = ascii_record(unit.ask("P"));
  EXPECT_EQ(moved.position, Vec3(5, -10, 0));
  EXPECT_EQ(moved.angles_deg, Vec3(-90, 0, 0));
  unit.type("A1,5,0,0,6,0,0,5,1,0\r");  // in the present frame: 5 further along its +X
  EXPECT_EQ(ascii_record(unit.ask("P")).position, Vec3(0, -10, 0));
  EXPECT_EQ(unit.ask("A1\r"),
            "21A  10.00   5.00   0.00  10.00   6.00   0.00   9.00   5.00   0.00\r\n");
  unit.type("R1\r");
  EXPECT_EQ(ascii_record(unit.ask("P")).position, Vec3(20, 5, 0));
}

TEST(FastrakCommandTest, PointsOnALineAreNoFrame) {
  Unit unit;
  EXPECT_THAT(unit.ask("A1,0,0,0,1,0,0,2,0,0\r"), HasSubstr("EC -3"));
  EXPECT_THAT(unit.ask("A1\r"), HasSubstr("  78.74"));
}

TEST(FastrakCommandTest, GuidedAlignmentTakesThreePointsAndPrintsTheFrame) {
  Vec3 tip = inches(10, 0, 0);
  Unit unit(one_receiver(), [&](int, Time) { return FastrakTruth{{Quat::Identity(), tip}}; });
  unit.type("A0\r");
  EXPECT_EQ(unit.ask("P"), "");
  tip = inches(10, 10, 0);
  unit.listen(20ms);
  EXPECT_EQ(unit.ask("P"), "");
  tip = inches(5, 0, 0);
  unit.listen(20ms);
  EXPECT_EQ(unit.ask("P"),
            "21A  10.00   0.00   0.00  10.00  10.00   0.00   5.00   0.00   0.00\r\n");
  EXPECT_EQ(ascii_record(unit.ask("P")).position, Vec3(0, 5, 0));
}

TEST(FastrakCommandTest, BoresightReadsAsTheReferenceAngles) {
  const Quat tilted = from_angles_deg(Vec3(30, -20, 10));
  Unit unit(one_receiver(), at(inches(20, 0, 0), tilted));
  EXPECT_EQ(unit.ask("G1\r"), "21G   0.00   0.00   0.00\r\n");
  unit.type("B1\r");
  FastrakRecord r = ascii_record(unit.ask("P"));
  EXPECT_EQ(r.angles_deg, Vec3(0, 0, 0));
  EXPECT_EQ(r.position, Vec3(20, 0, 0));  // boresight concerns the orientation only
  unit.type("G1,15,5,-5\r");
  EXPECT_EQ(ascii_record(unit.ask("P")).angles_deg, Vec3(15, 5, -5));
  EXPECT_EQ(unit.ask("G1\r"), "21G  15.00   5.00  -5.00\r\n");
  unit.type("b1\r");
  EXPECT_EQ(ascii_record(unit.ask("P")).angles_deg, Vec3(30, -20, 10));
  unit.type("B1\r");
  unit.type("b*\r");
  EXPECT_EQ(ascii_record(unit.ask("P")).angles_deg, Vec3(30, -20, 10));
}

TEST(FastrakCommandTest, StylusSwitchIsReportedOnlyInMouseModeAndActsInPointMode) {
  bool down = false;
  Unit unit(one_receiver(), [&](int, Time) {
    FastrakTruth truth = still_motion(1, Time{});
    truth.pressed = down;
    return truth;
  });
  unit.type("O1,2,16,1\r");
  unit.type("e1,0\r");
  down = true;
  EXPECT_EQ(unit.listen(1s), "");
  EXPECT_EQ(unit.ask("P").substr(24), " 1\r\n");
  unit.type("e1,1\r");
  // Looked at every 333 ms; holding it repeats P.
  EXPECT_EQ(unit.listen(1s).size(), 3u * 28u);
  down = false;
  unit.listen(1s);
  unit.type("C");
  unit.listen(100ms);
  EXPECT_GT(unit.listen(500ms).size(), 0u);
  down = true;
  unit.listen(500ms);
  EXPECT_EQ(unit.listen(500ms), "");  // the stream is off...
  down = false;
  unit.listen(500ms);
  down = true;
  unit.listen(500ms);
  EXPECT_GT(unit.listen(500ms).size(), 0u);  // ...and on again
}

TEST(FastrakCommandTest, TheStationOfEMayBeLeftOut) {
  Unit unit;
  unit.type("e,0\r");
  EXPECT_FALSE(unit.emulator.setup().point_mode);
  unit.type("e1\r");
  EXPECT_TRUE(unit.emulator.setup().point_mode);
}

TEST(FastrakCommandTest, HemisphereFlipsAllThreeSigns) {
  Unit unit(one_receiver(), at(inches(-20, 3, 4)));
  EXPECT_EQ(unit.ask("H1\r"), "21H   1.00   0.00   0.00\r\n");
  EXPECT_EQ(ascii_record(unit.ask("P")).position, Vec3(20, -3, -4));
  unit.type("H1,0,0,1\r");
  unit.listen(20ms);  // until the next measurement
  EXPECT_EQ(ascii_record(unit.ask("P")).position, Vec3(-20, 3, 4));
  EXPECT_EQ(unit.ask("H1\r"), "21H   0.00   0.00   1.00\r\n");
}

TEST(FastrakCommandTest, HemisphereTrackingFollowsTheReceiverAround) {
  Vec3 p = inches(20, 0, 0);
  Unit unit(one_receiver(), [&](int, Time) { return FastrakTruth{{Quat::Identity(), p}}; });
  unit.type("H1,0,0,0\r");
  for (int degrees = 0; degrees <= 180; degrees += 2) {
    const double a = degrees * std::numbers::pi / 180.0;
    p = inches(20 * std::cos(a), 20 * std::sin(a), 0);
    unit.listen(20ms);
  }
  EXPECT_EQ(ascii_record(unit.ask("P")).position.x(), -20.0);
  EXPECT_EQ(unit.ask("H1\r"), "21H   0.00   0.00   0.00\r\n");
}

TEST(FastrakCommandTest, IncrementHoldsAReceiverThatDoesNotMove) {
  Vec3 p = inches(20, 0, 0);
  Unit unit(one_receiver(), [&](int, Time) { return FastrakTruth{{Quat::Identity(), p}}; });
  EXPECT_EQ(unit.ask("I1\r"), "21I   0.00\r\n");
  unit.type("I1,0.5\r");
  EXPECT_EQ(unit.ask("I1\r"), "21I   0.50\r\n");
  unit.type("C");
  EXPECT_EQ(unit.listen(1s).size(), 47u);
  p = inches(20.4, 0, 0);
  EXPECT_EQ(unit.listen(1s), "");
  p = inches(20.6, 0, 0);
  EXPECT_EQ(unit.listen(1s).size(), 47u);
}

TEST(FastrakCommandTest, StationsSwitchOffAndOnWhereAReceiverIs) {
  Unit unit;
  EXPECT_EQ(unit.ask("l1\r"), "21l1100\r\n");
  unit.type("l1,0\r");
  EXPECT_EQ(unit.ask("l2\r"), "22l0100\r\n");
  EXPECT_THAT(unit.ask("P"), StartsWith("02 "));
  unit.type("l1,1\rl3,1\r");
  EXPECT_EQ(unit.ask("l*\n"), "21l1100\r\n");  // no receiver at 3
}

TEST(FastrakCommandTest, TipOffsetMovesWithTheReceiver) {
  FastrakEmulatorOptions options = one_receiver();
  options.p_SN_stylus = inches(2.5, 0, 0);
  Unit unit(options, at(inches(20, 0, 0), from_angles_deg(Vec3(90, 0, 0))));
  EXPECT_EQ(unit.ask("N1\r"), "21N   2.500   0.000   0.000\r\n");
  EXPECT_EQ(ascii_record(unit.ask("P")).position, Vec3(20, 2.5, 0));
  unit.type("N1,0,0,1\r");
  EXPECT_EQ(ascii_record(unit.ask("P")).position, Vec3(20, 0, 1));
}

TEST(FastrakCommandTest, OutputListsAreSetReadBackAndChecked) {
  Unit unit;
  EXPECT_EQ(unit.ask("O1\r"), "21O 2 4 1\r\n");
  unit.type("O1,2,11,16,0\r");
  EXPECT_EQ(unit.ask("O1\r"), "21O 21116 0\r\n");
  EXPECT_EQ(unit.ask("O2\r"), "22O 2 4 1\r\n");  // each station its own
  EXPECT_THAT(unit.ask("O1,2,40,1\r"), HasSubstr("EC -3 *PS  5 *FL 2 *ST 0"));
  EXPECT_THAT(unit.ask("O1,18\r"), HasSubstr("EC -3"));  // early firmware only
  std::string many = "O1";
  for (int i = 0; i < 33; ++i) many += ",0";
  EXPECT_THAT(unit.ask(many + "\r"), HasSubstr("EC -5"));
  EXPECT_THAT(unit.ask("O1,52,61,52,61,52,61\r"), HasSubstr("EC -5"));  // 273 bytes
  EXPECT_EQ(unit.ask("O1\r"), "21O 21116 0\r\n");
  unit.type("O1,,4\r");  // an empty field keeps the stored item
  EXPECT_EQ(unit.ask("O1\r"), "21O 2 4\r\n");
  FastrakEmulatorOptions options = Unit::quiet();
  options.early_firmware = true;
  Unit early(options);
  early.type("O1,18,19,20\rl2,0\rf");
  EXPECT_EQ(early.ask("P").size(), 3u + 6 + 6 + 8);
}

TEST(FastrakCommandTest, PortSettingsActAtOnce) {
  Unit unit;
  unit.type("o96,N,8,0\r");
  EXPECT_EQ(unit.emulator.baud(), 9600);
  unit.type("S");
  // One cycle, then 55 bytes at 960 a second.
  EXPECT_EQ(unit.listen(64ms).size(), 53u);
  EXPECT_EQ(unit.listen(3ms).size(), 2u);
  EXPECT_THAT(unit.ask("o97\r"), HasSubstr("EC -3"));
  EXPECT_THAT(unit.ask("o96,E,8\r"), HasSubstr("EC -3"));  // eight bits carry no parity
  unit.type("o1152,,7\r");
  EXPECT_EQ(unit.ask("l1\r"), "21l1100\r\n");
}

TEST(FastrakCommandTest, EnvelopesMarkTheRecord) {
  Unit unit(one_receiver(), at(inches(20, 0, 0), from_angles_deg(Vec3(50, 0, 0))));
  EXPECT_EQ(unit.ask("V1\r"), "21V  78.740  78.740  78.740 -78.740 -78.740 -78.740\r\n");
  EXPECT_EQ(unit.ask("Q1\r"), "21Q 180.000  90.000 180.000-180.000 -90.000-180.000\r\n");
  EXPECT_EQ(ascii_record(unit.ask("P")).error, ' ');
  unit.type("V1,19\r");
  EXPECT_EQ(ascii_record(unit.ask("P")).error, 'x');
  EXPECT_EQ(unit.ask("T\r"), "2 T120 position envelope exceeded\r\n");
  EXPECT_EQ(unit.ask("S").substr(6, 3), "120");
  unit.type("V1,30\rQ1,45\r");
  EXPECT_EQ(ascii_record(unit.ask("P")).error, 'y');
  unit.type("Q1,60\r");
  unit.type("T121,0\r");
  EXPECT_EQ(ascii_record(unit.ask("P")).error, ' ');
  EXPECT_EQ(unit.ask("S").substr(6, 3), "  0");
  EXPECT_THAT(unit.ask("V1,-100\r"), HasSubstr("EC -3"));
}

TEST(FastrakCommandTest, MountingFrameTurnsTheTransmitter) {
  Unit unit(one_receiver(), at(inches(20, 0, 0)));
  unit.type("r1,90,0,0\r");
  const FastrakRecord r = ascii_record(unit.ask("P"));
  EXPECT_EQ(r.position, Vec3(0, 20, 0));
  EXPECT_EQ(r.angles_deg, Vec3(90, 0, 0));
  EXPECT_EQ(unit.ask("r1\r"), "21r  90.000   0.000   0.000\r\n");
}

TEST(FastrakCommandTest, FiltersAreSetReadBackAndDisabled) {
  Unit unit;
  EXPECT_FALSE(unit.emulator.setup().position_filter.enabled());
  unit.type("x0.2,0.2,0.8,0.8\r");
  EXPECT_EQ(unit.ask("x\r"), "2 x  0.200  0.200  0.800  0.800\r\n");
  EXPECT_TRUE(unit.emulator.setup().position_filter.enabled());
  EXPECT_FALSE(unit.emulator.setup().attitude_filter.enabled());
  unit.type("x,1\r");
  EXPECT_FALSE(unit.emulator.setup().position_filter.enabled());
  unit.type("v5\r");
  EXPECT_EQ(unit.ask("v\r"), "2 v  0.200  0.050  0.600  0.800\r\n");
  unit.type("v2\r");
  EXPECT_FALSE(unit.emulator.setup().attitude_filter.enabled());
  EXPECT_THAT(unit.ask("v0.2,0.9,0.8,0.8\r"), HasSubstr("EC -3"));
}

TEST(FastrakCommandTest, IdentificationIsThirtyTwoCharacters) {
  Unit unit;
  EXPECT_EQ(unit.ask("X\r"), "2 XOutputCompensat CPG2030-003-10  \r\n");
  unit.type("XLab 5, left side\r");
  EXPECT_THAT(unit.ask("S"), HasSubstr("Lab 5, left side                \r\n"));
  EXPECT_THAT(unit.ask("X123456789012345678901234567890123\r"), HasSubstr("EC -5"));
  unit.type("W");
  EXPECT_EQ(unit.ask("X\r"), "2 XOutputCompensat CPG2030-003-10  \r\n");
}

TEST(FastrakCommandTest, SyncModesAreReadBackAndTheVideoOneHasNoScreen) {
  Unit unit(one_receiver());
  EXPECT_EQ(unit.ask("y\r"), "2 y0\r\n");
  unit.type("y2\r");
  unit.listen(20ms);
  EXPECT_EQ(ascii_record(unit.ask("P")).error, 'v');
  EXPECT_EQ(unit.ask("y\r"), "2 y2\r\n");
}

TEST(FastrakCommandTest, WLoadsFactoryValues) {
  Unit unit;
  unit.type("fu");
  unit.type("O1,2,0\rl1,0\rH2,0,0,1\rC");
  unit.listen(100ms);
  unit.type("W");
  unit.listen(20ms);
  EXPECT_EQ(unit.listen(200ms), "");
  EXPECT_EQ(unit.ask("P").size(), 94u);
  EXPECT_EQ(unit.ask("H2\r"), "22H   1.00   0.00   0.00\r\n");
}

TEST(FastrakCommandTest, SavedSetUpSurvivesReinitialisationButBoresightAndTipDoNot) {
  Unit unit(one_receiver(), at(inches(20, 0, 0), from_angles_deg(Vec3(30, 0, 0))));
  unit.type("u");
  unit.type("O1,2,11,1\rH1,0,0,1\rN1,0,0,5\rB1\ry1\r");
  unit.type("\x0b");
  unit.type("l1\r");  // comes while it saves
  EXPECT_EQ(unit.listen(2900ms), "");
  EXPECT_EQ(unit.listen(200ms), "21l1000\r\n");
  unit.type("O1,2,1\r");  // not saved
  unit.type("\x19");
  unit.type("S");
  EXPECT_EQ(unit.listen(9900ms), "");
  unit.listen(200ms);
  EXPECT_EQ(unit.ask("S").substr(3, 3), "3F2");
  EXPECT_EQ(unit.ask("O1\r"), "21O 211 1\r\n");
  EXPECT_EQ(unit.ask("H1\r"), "21H   0.00   0.00   1.00\r\n");
  EXPECT_EQ(unit.ask("N1\r"), "21N   0.000   0.000   0.000\r\n");
  EXPECT_EQ(unit.ask("y\r"), "2 y0\r\n");
  EXPECT_FALSE(unit.emulator.setup().stations[0].q_boresight.has_value());
}

TEST(FastrakCommandTest, WhatWasNotSavedIsLostAtPowerCycle) {
  Unit unit;
  unit.type("ufC");
  unit.type("O1,2,0\r");
  unit.listen(100ms);
  unit.emulator.power_cycle(unit.now);
  EXPECT_EQ(unit.listen(9900ms), "");
  unit.listen(200ms);
  EXPECT_EQ(unit.ask("P").size(), 94u);
}

TEST(FastrakCommandTest, XoffHoldsAndXonGoesOnWithTheSameByte) {
  Unit unit;
  unit.type("C");
  std::string heard = unit.listen(503ms);
  unit.type("\x13");
  EXPECT_EQ(unit.listen(500ms), "");
  unit.type("\x11");
  heard += unit.listen(500ms);
  for (std::size_t i = 0; i + 47 <= heard.size(); i += 47) {
    EXPECT_THAT(heard.substr(i, 2), testing::AnyOf("01", "02"));
    EXPECT_EQ(heard.substr(i + 45, 2), "\r\n");
  }
}

}  // namespace
}  // namespace headpin::devices
