// The shape that a Fastrak record must have to be read, and how one is found among other bytes.

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/fastrak/codec.h"

namespace headpin::devices {
namespace {

using namespace std::string_view_literals;

Bytes bytes_to_decode(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

std::optional<FastrakRecord> read_line(const std::string& text, std::vector<int> items,
                                       bool binary = false) {
  return decode_record(bytes_to_decode(text), {.items = std::move(items), .binary = binary});
}

std::string line_of(const FastrakRecord& record, const FastrakFormat& format) {
  std::vector<std::uint8_t> out;
  encode_record(record, format, out);
  return {out.begin(), out.end()};
}

TEST(FastrakDecodingTest, APlainNumberIsBlanksASignDigitsAPointAndDigits) {
  const auto y = [](const std::string& columns) {
    const auto read = read_line("01    0.00" + columns + "   0.00", {2});
    return read ? std::optional(read->position.y()) : std::nullopt;
  };
  EXPECT_EQ(y("   1.50"), 1.5);
  EXPECT_EQ(y("  -1.50"), -1.5);
  EXPECT_EQ(y("  +1.50"), 1.5);
  EXPECT_EQ(y("0001.50"), 1.5);
  EXPECT_EQ(y("9876.09"), 9876.09);
  for (const std::string columns :
       {"    .50", "   -.50", "       ", "      .", "   /.50", "   :.50", "   1./0",
        "   1.0:", "  1 .50", "-  1.50", "  --.50", "   1.5 ", "1.50   "}) {
    EXPECT_FALSE(y(columns)) << "'" << columns << "'";
  }
}

TEST(FastrakDecodingTest, AnExtendedNumberHasEachCharacterInItsColumn) {
  const auto y = [](const std::string& columns) {
    const std::string zero = " 0.00000E+00 ";
    const auto read = read_line("01 " + zero + columns + zero, {52});
    return read ? std::optional(read->position.y()) : std::nullopt;
  };
  const std::string good = " 2.40905E+01 ";
  EXPECT_EQ(y(good), 24.0905);
  EXPECT_EQ(y("-2.40905E+01 "), -24.0905);
  EXPECT_EQ(y("+2.40905E+01 "), 24.0905);
  EXPECT_EQ(y(" 2.40905E-01 "), 0.240905);
  for (std::size_t i = 0; i < good.size(); ++i) {
    for (const char other : {'/', ':', 'e', i == 0 || i == 12 ? '1' : ' '}) {
      std::string bad = good;
      bad[i] = other;
      EXPECT_FALSE(y(bad)) << "'" << bad << "'";
    }
  }
}

// Two digits of exponent are what its columns have.
TEST(FastrakDecodingTest, ExtendedNumbersReachFrom1EMinus99To999999E99) {
  const FastrakFormat format{.items = {52}};
  FastrakRecord record;
  record.position = Vec3(1e-99, -1e-99, 9e-100);
  EXPECT_EQ(line_of(record, format), "01  1.00000E-99 -1.00000E-99  0.00000E+00 ");
  record.position = Vec3(9.99999e99, 1e100, -1e300);
  EXPECT_EQ(line_of(record, format), "01  9.99999E+99  9.99999E+99 -9.99999E+99 ");
}

TEST(FastrakDecodingTest, APositionIsPossibleUpToTenThousandUnits) {
  const FastrakFormat format{.items = {2}, .binary = true};
  constexpr float kFarthest = 1e4F;
  for (int axis = 0; axis < 3; ++axis) {
    for (const float sign : {1.0F, -1.0F}) {
      FastrakRecord record;
      record.position(axis) = sign * kFarthest;
      EXPECT_TRUE(decode_record(bytes_to_decode(line_of(record, format)), format));
      record.position(axis) = sign * std::nextafter(kFarthest, 2e4F);
      EXPECT_FALSE(decode_record(bytes_to_decode(line_of(record, format)), format));
    }
  }
}

// Whoever rounds up may write the last digit one too large.
TEST(FastrakDecodingTest, AnAngleMayPassItsEndByOneStepOfTheColumns) {
  const auto is_read = [](const std::string& columns) {
    return read_line("01 " + columns, {4}).has_value();
  };
  EXPECT_TRUE(is_read(" 180.01  90.01 180.01"));
  EXPECT_TRUE(is_read("-180.01 -90.01-180.01"));
  EXPECT_FALSE(is_read(" 180.02  90.01 180.01"));
  EXPECT_FALSE(is_read(" 180.01 -90.02 180.01"));
  EXPECT_FALSE(is_read(" 180.01  90.01-180.02"));
}

TEST(FastrakDecodingTest, TheStylusSwitchIsABlankAndAZeroOrAOne) {
  EXPECT_FALSE(read_line("01  0", {16}).value().pressed);
  EXPECT_TRUE(read_line("01  1", {16}).value().pressed);
  for (const std::string columns : {"00", "11", "01", " 2", " /", "  ", "1 "}) {
    EXPECT_FALSE(read_line("01 " + columns, {16})) << "'" << columns << "'";
  }
}

// IS-900 guide, p. 69.
TEST(FastrakDecodingTest, BitSevenMarksTheFirstByteOfCompactDataAndNoOther) {
  const FastrakFormat format{.items = {18, 20}, .binary = true};
  const std::string good = line_of(FastrakRecord{}, format);
  ASSERT_EQ(good.size(), 3u + 6u + 8u);
  EXPECT_TRUE(decode_record(bytes_to_decode(good), format));
  for (std::size_t i = 3; i < good.size(); ++i) {
    std::string bad = good;
    bad[i] = static_cast<char>(bad[i] ^ 0x80);
    EXPECT_FALSE(decode_record(bytes_to_decode(bad), format)) << i;
  }
}

TEST(FastrakDecodingTest, ARecordCutShortIsRefused) {
  for (const FastrakFormat& format :
       {FastrakFormat{.items = {2, 11, 16, 1}}, FastrakFormat{.items = {52, 61, 50}},
        FastrakFormat{.items = {2, 11, 16, 1}, .binary = true},
        FastrakFormat{.items = {18, 20, 0}, .binary = true}}) {
    const std::string whole = line_of(FastrakRecord{}, format);
    for (std::size_t length = 0; length < whole.size(); ++length) {
      // Its own memory, beyond whose end a sanitizer sees.
      const std::vector<std::uint8_t> part(whole.begin(),
                                           whole.begin() + static_cast<std::ptrdiff_t>(length));
      EXPECT_FALSE(decode_record(part, format)) << length;
    }
  }
}

// --- Among other bytes -------------------------------------------------------------------------

FastrakFormats all_of(const FastrakFormat& format) {
  FastrakFormats formats;
  formats.fill(format);
  return formats;
}

const FastrakFormat kSixteen{.items = {2, 0}, .binary = true, .centimetres = true};
constexpr std::string_view kSixteenBytes = "01 \0\0\x80\x3f\0\0\0\0\0\0\0\0 "sv;  // at (1, 0, 0) cm
// Together with the head of a record behind them, they read as a record too.
constexpr std::string_view kFalseBegin = "01 \0\0\0\0\0\0\0\0\0\0"sv;

using FoundAt = std::pair<std::size_t, std::size_t>;  // skipped, length

FoundAt found_in(std::string_view text, bool in_step, bool no_more = false) {
  const FastrakFound found = find_record(bytes_to_decode(text), all_of(kSixteen), in_step, no_more);
  return {found.skipped, found.length};
}

TEST(FindRecordTest, BytesThatBeginNoRecordAreSkippedAsTheyCome) {
  for (const bool in_step : {false, true}) {
    EXPECT_EQ(found_in("09", in_step), FoundAt(2, 0));
    EXPECT_EQ(found_in("x0", in_step), FoundAt(1, 0));
    EXPECT_EQ(found_in("01", in_step), FoundAt(0, 0));  // may begin one
    EXPECT_EQ(found_in("011", in_step), FoundAt(3, 0));
    EXPECT_EQ(found_in("xyz01", in_step), FoundAt(3, 0));
    EXPECT_EQ(found_in("xyz01", in_step, true), FoundAt(5, 0));  // no more: it begins none
    EXPECT_EQ(found_in("", in_step, true), FoundAt(0, 0));
  }
}

TEST(FindRecordTest, OutOfStepTheBeginOfTheNextRecordIsAwaited) {
  const std::string record(kSixteenBytes);
  EXPECT_EQ(found_in(record + "02k", false), FoundAt(0, 16));
  EXPECT_EQ(found_in(record + "02", false), FoundAt(0, 0));
  EXPECT_EQ(found_in(record + "02", false, true), FoundAt(0, 16));
  EXPECT_EQ(found_in(record + "025", false), FoundAt(0, 16));  // noise is behind it
  EXPECT_EQ(found_in(record, true), FoundAt(0, 16));
  // What lies in memory behind the bytes does not count.
  const std::string more = record + "xyz";
  EXPECT_EQ(found_in(std::string_view(more).substr(0, 16), false), FoundAt(0, 0));
  EXPECT_EQ(found_in(std::string_view(more).substr(0, 16), false, true), FoundAt(0, 16));
}

TEST(FindRecordTest, OutOfStepARecordInsideThatAnotherOneFollowsIsMorePlausible) {
  const std::string stream = std::string(kFalseBegin) + std::string(kSixteenBytes) + "01 ";
  EXPECT_EQ(found_in(stream, true), FoundAt(0, 16));
  EXPECT_EQ(found_in(stream, false), FoundAt(13, 16));
  EXPECT_EQ(found_in("x" + stream, true), FoundAt(14, 16));  // a byte in between ends the step
  // Until it is whole, nobody knows.
  EXPECT_EQ(found_in(stream.substr(0, 19), false), FoundAt(0, 0));
  EXPECT_EQ(found_in(stream.substr(0, 19), false, true), FoundAt(0, 16));
}

TEST(FindRecordTest, ARecordWithoutItemsIsItsHead) {
  const FastrakFormat empty{.items = {}};
  EXPECT_EQ(decode_record(bytes_to_decode("03k"), empty).value().station, 3);
  const FastrakFound found = find_record(bytes_to_decode("03k"), all_of(empty), true, false);
  EXPECT_EQ(found.length, 3u);
  EXPECT_EQ(found.record.error, 'k');
}

}  // namespace
}  // namespace headpin::devices
