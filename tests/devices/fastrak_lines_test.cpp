// Line commands carried out on a memory alone: what they set, their limits, what they refuse.

#include <optional>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/fastrak/commands.h"

namespace headpin::devices {
namespace {

/// A memory with a receiver at each station.
class FastrakLineTest : public testing::Test {
 protected:
  FastrakLineTest() {
    memory_.plugged = [](std::size_t) { return true; };
    memory_.attitude = [](std::size_t) { return from_angles_deg(Vec3(30.0, 0.0, 0.0)); };
  }

  std::string say(std::string_view line) { return carry_out(line, memory_); }

  /// Code, position, field and station of a refusal.
  std::string refusal(std::string_view line) {
    try {
      carry_out(line, memory_);
      return "none";
    } catch (const FastrakRefused& refused) {
      return fmt::format("EC {} PS {} FL {} ST {}", static_cast<int>(refused.why), refused.position,
                         refused.field, refused.station);
    }
  }

  FastrakMemory memory_;
};

TEST_F(FastrakLineTest, WhatIsNoNumberIsRefusedAsNotNumeric) {
  for (const std::string_view number : {"+", "-", "+-5", "inf", "nan", "1x", "1e", "e", "."}) {
    EXPECT_EQ(refusal(fmt::format("H1,{}", number)), "EC -2 PS 3 FL 1 ST 1") << number;
  }
  EXPECT_EQ(refusal("H1,1e400"), "EC -3 PS 3 FL 1 ST 1");
  EXPECT_EQ(say("H1"), "21H   1.00   0.00   0.00\r\n");
}

TEST_F(FastrakLineTest, ARefusalNamesTheStationOfTheFirstFieldOrTheFirstOne) {
  EXPECT_EQ(refusal("H1,x"), "EC -2 PS 3 FL 1 ST 1");
  EXPECT_EQ(refusal("H4,x"), "EC -2 PS 3 FL 1 ST 4");
  for (const std::string_view station : {"0", "5", "9", "42", "-1", ""}) {
    EXPECT_THAT(refusal(fmt::format("H{},1", station)), testing::EndsWith("PS 1 FL 0 ST 1"))
        << station;
  }
  EXPECT_EQ(refusal("y3"), "EC -3 PS 1 FL 0 ST 1");
}

TEST_F(FastrakLineTest, FieldsBehindTheLastOneOfACommandAreIgnored) {
  EXPECT_EQ(say("H1,0,0,1,x"), "");
  EXPECT_EQ(say("H1"), "21H   0.00   0.00   1.00\r\n");
  EXPECT_EQ(say("x0.3,0.2,0.8,0.9,x"), "");
  EXPECT_EQ(say("x"), "2 x  0.300  0.200  0.800  0.900\r\n");
}

TEST_F(FastrakLineTest, EachAxisIsReadBackInTheUnitOfTheLine) {
  say("N2,1,-2,3");
  EXPECT_EQ(say("N2"), "22N   1.000  -2.000   3.000\r\n");
  memory_.setup.centimetres = true;
  EXPECT_EQ(say("N2"), "22N   2.540  -5.080   7.620\r\n");
  say("N2,,,5");
  EXPECT_EQ(say("N2"), "22N   2.540  -5.080   5.000\r\n");
}

TEST_F(FastrakLineTest, ABoxMayBeFlatButItsLargestIsNotBelowItsSmallest) {
  EXPECT_EQ(refusal("V1,-100"), "EC -3 PS 3 FL 1 ST 1");
  EXPECT_EQ(refusal("V1,,-100"), "EC -3 PS 4 FL 2 ST 1");
  EXPECT_EQ(refusal("V1,,,-100"), "EC -3 PS 5 FL 3 ST 1");
  EXPECT_EQ(refusal("V1,,,,,,100"), "EC -3 PS 5 FL 3 ST 1");
  EXPECT_EQ(refusal("V1,5,-6,7,5,-6,7"), "none");
  EXPECT_EQ(say("V1"), "21V   5.000  -6.000   7.000   5.000  -6.000   7.000\r\n");
  EXPECT_EQ(refusal("Q3,0,0,0,0,0,0"), "none");
  EXPECT_EQ(say("Q3"), "23Q   0.000   0.000   0.000   0.000   0.000   0.000\r\n");
}

TEST_F(FastrakLineTest, PointsLeftOutOfAnAlignmentAreTheFactorys) {
  say("A1,10");
  EXPECT_EQ(say("A1"), "21A  10.00   0.00   0.00  78.74   0.00   0.00   0.00  78.74   0.00\r\n");
  memory_.setup.centimetres = true;
  say("A2,,,,,,,5");
  EXPECT_EQ(say("A2"), "22A   0.00   0.00   0.00 200.00   0.00   0.00   5.00 200.00   0.00\r\n");
}

TEST_F(FastrakLineTest, BoresightIsOfTheNamedStationAlone) {
  const auto& stations = memory_.setup.stations;
  say("B2");
  EXPECT_FALSE(stations[0].q_boresight);
  EXPECT_TRUE(stations[1].q_boresight);
  EXPECT_FALSE(stations[2].q_boresight);
  say("B*");
  for (const FastrakStationSetup& station : stations) EXPECT_TRUE(station.q_boresight);
  say("b2");
  EXPECT_TRUE(stations[0].q_boresight);
  EXPECT_FALSE(stations[1].q_boresight);
  EXPECT_TRUE(stations[2].q_boresight);
}

// Page 57: 32 items and 254 bytes.
TEST_F(FastrakLineTest, AnOutputListHasUpTo32ItemsAnd254Bytes) {
  std::string line = "O1";
  for (int i = 0; i < 32; ++i) line += ",0";
  EXPECT_EQ(refusal(line), "none");
  EXPECT_EQ(say("O1").size(), 5u + 2u * 32u);
  EXPECT_EQ(refusal(line + ",0"), "EC -5 PS 67 FL 33 ST 1");
  const std::string longest = "O2,61,61,61,61,52,1,1";  // 3 + 4 x 52 + 39 + 2 x 2 bytes
  EXPECT_EQ(refusal(longest), "none");
  EXPECT_EQ(fastrak_record_length({.items = memory_.setup.stations[1].items}), 254u);
  EXPECT_EQ(refusal(longest + ",0"), "EC -5 PS 22 FL 8 ST 2");
  EXPECT_EQ(say("O2"), "22O6161616152 1 1\r\n");
}

TEST_F(FastrakLineTest, EachSettingOfThePortMayBeLeftOut) {
  say("o96");
  EXPECT_EQ(memory_.port.baud, 9600);
  EXPECT_EQ(memory_.port.bits, 8);
  say("o,,7");
  EXPECT_EQ(memory_.port.baud, 9600);
  EXPECT_EQ(memory_.port.bits, 7);
  say("o,E");
  EXPECT_TRUE(memory_.port.parity);
  EXPECT_EQ(refusal("o,,8"), "EC -3 PS 2 FL 1 ST 1");  // eight bits carry no parity
  EXPECT_EQ(refusal("o,,9"), "EC -3 PS 3 FL 2 ST 1");
  EXPECT_EQ(refusal("o,,,2"), "EC -3 PS 4 FL 3 ST 1");
  EXPECT_EQ(memory_.port.bits, 7);
}

TEST_F(FastrakLineTest, OnlyANoughtClearsTheBuiltInTest) {
  memory_.error = 120;
  EXPECT_EQ(refusal("T120,1"), "EC -3 PS 5 FL 1 ST 1");
  EXPECT_EQ(memory_.error, 120);
  EXPECT_EQ(say("T120,0"), "");
  EXPECT_EQ(memory_.error, 0);
}

TEST_F(FastrakLineTest, AFilterHasItsLeastWeightAboveZeroAndUpToItsLargest) {
  EXPECT_EQ(refusal("x0.2,0,0.8,0.8"), "EC -3 PS 5 FL 1 ST 1");
  EXPECT_EQ(refusal("x0.2,0.81,0.8,0.8"), "EC -3 PS 5 FL 1 ST 1");
  EXPECT_EQ(refusal("x-0.1,0.2"), "EC -3 PS 1 FL 0 ST 1");
  EXPECT_EQ(refusal("x,,,-0.1"), "EC -3 PS 4 FL 3 ST 1");
  EXPECT_EQ(say("x"), "2 x  0.200  1.000  0.800  0.950\r\n");
  EXPECT_EQ(refusal("x0,0.8,0.8,0"), "none");
  EXPECT_EQ(say("x"), "2 x  0.000  0.800  0.800  0.000\r\n");
}

TEST_F(FastrakLineTest, AnIdentificationFillsItsThirtyTwoColumns) {
  const std::string text(32, 'a');
  EXPECT_EQ(refusal("X" + text), "none");
  EXPECT_EQ(say("X"), "2 X" + text + "\r\n");
  EXPECT_EQ(refusal("X" + text + "b"), "EC -5 PS 1 FL 0 ST 1");
}

TEST(FastrakSettingTest, SixLettersAreSettings) {
  FastrakSetup setup;
  for (const char letter : std::string_view("fuD")) EXPECT_TRUE(switch_setting(letter, setup));
  EXPECT_TRUE(setup.binary && setup.centimetres && setup.compensation);
  for (const char letter : std::string_view("FUd")) EXPECT_TRUE(switch_setting(letter, setup));
  EXPECT_FALSE(setup.binary || setup.centimetres || setup.compensation);
  for (const char letter : std::string_view("PCcSW")) EXPECT_FALSE(switch_setting(letter, setup));
}

}  // namespace
}  // namespace headpin::devices
