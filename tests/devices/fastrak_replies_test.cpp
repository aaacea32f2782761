// Answers of a Fastrak that are no records, byte by byte, and how a client shows and asks.

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/fastrak/asking.h"
#include "devices/fastrak/replies.h"

namespace headpin::devices {
namespace {

using testing::ElementsAre;

TEST(FastrakStatusTest, StationsOneToFourAreReadAndNoOthers) {
  const auto read_of = [](int station) {
    FastrakStatus status;
    status.station = station;
    return decode_status(encode_status(status));
  };
  for (int station = 1; station <= kFastrakStations; ++station) {
    ASSERT_TRUE(read_of(station)) << station;
    EXPECT_EQ(read_of(station)->station, station);
  }
  for (const int station : {-1, 0, 5}) EXPECT_FALSE(read_of(station)) << station;
}

TEST(FastrakStatusTest, EachFlagIsReadAlone) {
  const auto flags = [](bool FastrakStatus::*flag) {
    FastrakStatus status;
    if (flag != nullptr) status.*flag = true;
    const FastrakStatus read = decode_status(encode_status(status)).value();
    return std::array{read.binary, read.centimetres, read.compensation, read.continuous};
  };
  EXPECT_THAT(flags(nullptr), ElementsAre(false, false, false, false));
  EXPECT_THAT(flags(&FastrakStatus::binary), ElementsAre(true, false, false, false));
  EXPECT_THAT(flags(&FastrakStatus::centimetres), ElementsAre(false, true, false, false));
  EXPECT_THAT(flags(&FastrakStatus::compensation), ElementsAre(false, false, true, false));
  EXPECT_THAT(flags(&FastrakStatus::continuous), ElementsAre(false, false, false, true));
}

TEST(FastrakStatusTest, FlagsAndErrorAreNumbersThatFillTheirColumns) {
  const auto with = [](std::size_t at, std::string_view columns) {
    return decode_status(encode_status({}).replace(at, columns.size(), columns));
  };
  for (const std::string_view flags : {"3G0", "3F ", " F0", "GF0", "-F0", "-00", "+F0"}) {
    EXPECT_FALSE(with(3, flags)) << flags;
  }
  EXPECT_EQ(with(6, "   ").value().error, 0);
  EXPECT_EQ(with(6, " 97").value().error, 97);
  EXPECT_EQ(with(6, "122").value().error, 122);
  for (const std::string_view error : {"1 2", "12 ", "-12", " -1", "abc", "1x1", "  ?"}) {
    EXPECT_FALSE(with(6, error)) << error;
  }
}

TEST(FastrakReplyTest, WhatIsNoListOfActiveStationsIsRefused) {
  const std::string good = encode_active(3, {true, false, false, true});
  EXPECT_THAT(decode_active(good).value(), ElementsAre(true, false, false, true));
  for (const std::size_t at : {0u, 2u, 3u, 4u, 5u, 6u, 7u, 8u}) {
    std::string bad = good;
    bad[at] = '2' + (at == 0);
    EXPECT_FALSE(decode_active(bad)) << at;
  }
  EXPECT_FALSE(decode_active("23l10010\r\n"));
  EXPECT_FALSE(decode_active("23l100\r\n"));
  EXPECT_FALSE(decode_active(""));
}

TEST(FastrakReplyTest, ItemsOfAListStandInTwoColumnsOfDigits) {
  EXPECT_THAT(decode_list("24O 0 909905061\r\n", 4).value(), ElementsAre(0, 9, 9, 90, 50, 61));
  EXPECT_THAT(decode_list(encode_list(1, {}), 1).value(), ElementsAre());
  for (const std::string_view list :
       {"34O 2 4\r\n", "23O 2 4\r\n", "24l 2 4\r\n", "24O 2 4\n\n", "24O 2 4\r", "24O 2 42\r\n",
        "24O 2 \r\n", "24O\n", "24O", "", "24O/4\r\n", "24O:4\r\n", "24O4/\r\n", "24O4:\r\n",
        "24O4 \r\n", "24O-4\r\n", "24O  \r\n"}) {
    EXPECT_FALSE(decode_list(list, 4)) << list;
  }
}

TEST(FastrakReplyTest, ARefusalShowsPrintableBytesAsTheyAreAndOthersAsAQuestionMark) {
  EXPECT_EQ(encode_refusal("\x1f ~\x7f\x80\xff\x01", FastrakRefusal::unknown_command, 12, 3, 4),
            "2 E*ERROR* ? ~???? *ERROR* EC-99 *PS 12 *FL 3 *ST 3\r\n");
}

TEST(FastrakReplyTest, ABlankAndANoughtAreNoError) {
  EXPECT_EQ(fastrak_error_text(0), "no error");
  EXPECT_EQ(fastrak_error_text(' '), "no error");
  EXPECT_EQ(fastrak_error_text(1), "");
}

// --- A client's questions ----------------------------------------------------------------------

class SilentLine : public FastrakLine {
 public:
  explicit SilentLine(int baud) : baud_(baud) {}
  std::string wait(Time, std::size_t) override { return ""; }
  void flush() override {}
  int baud() const override { return baud_; }

 private:
  void put(std::string_view) override {}

  int baud_;
};

// A byte has ten bits on the line.
TEST(FastrakAskingTest, TheLineCarriesATenthOfItsBaudRateInBytesASecond) {
  EXPECT_EQ(time_of(960, SilentLine(9600)), Time{1'000'000});
  EXPECT_EQ(time_of(32, SilentLine(38400)), Time{8'333});
  EXPECT_EQ(time_of(0, SilentLine(2400)), Time{0});
}

TEST(FastrakAskingTest, BytesShowTheirNumberAndTheirValuesUpToSixty) {
  EXPECT_EQ(shown_bytes(""), "nothing");
  EXPECT_EQ(shown_bytes("\x1f ~\x7f\xff"), "5 bytes '\\x1f ~\\x7f\\xff'");
  const std::string sixty(60, 'a');
  EXPECT_EQ(shown_bytes(sixty), "60 bytes '" + sixty + "'");
  EXPECT_EQ(shown_bytes(sixty + "b"), "61 bytes '" + sixty + "...'");
}

}  // namespace
}  // namespace headpin::devices
