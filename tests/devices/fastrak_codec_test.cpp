#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/fastrak/codec.h"
#include "devices/fastrak/replies.h"
#include "devices/fastrak/setup.h"

namespace headpin::devices {
namespace {

using testing::ElementsAreArray;

std::vector<std::uint8_t> from_hex(const std::string& text) {
  std::vector<std::uint8_t> bytes;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    bytes.push_back(static_cast<std::uint8_t>(std::stoi(word, nullptr, 16)));
  }
  return bytes;
}

std::vector<std::uint8_t> from_text(const std::string& text) {
  return {text.begin(), text.end()};
}

std::vector<std::uint8_t> encoded(const FastrakRecord& record, const FastrakFormat& format) {
  std::vector<std::uint8_t> out;
  encode_record(record, format, out);
  return out;
}

// The pose of the worked examples: (24, -6, 12.5) inches.
FastrakRecord example() {
  FastrakRecord r;
  r.position = Vec3(24.0, -6.0, 12.5);
  r.angles_deg = Vec3(90.0, 0.0, -45.0);
  return r;
}

TEST(FastrakRecordTest, AsciiPositionAndAnglesMatchTheWorkedExample) {
  const auto expected = from_hex(
      "30 31 20 20 20 32 34 2e 30 30 20 20 2d 36 2e 30 30 20 20 31 32 2e 35 30 20 20 39 30 2e 30 "
      "30 "
      "20 20 20 30 2e 30 30 20 2d 34 35 2e 30 30 0d 0a");
  EXPECT_THAT(encoded(example(), {{2, 4, 1}, false, false}), ElementsAreArray(expected));
}

TEST(FastrakRecordTest, ANumberHasItsPointWhereTheFormatHasIt) {
  const FastrakFormat format{{2, 4, 1}, false, false};
  const std::vector<std::uint8_t> good = encoded(example(), format);
  ASSERT_TRUE(decode_record(good, format));
  for (std::size_t i = 0; i < good.size(); ++i) {
    if (good[i] != '.') continue;
    std::vector<std::uint8_t> bad = good;
    bad[i] = '0';
    EXPECT_FALSE(decode_record(bad, format)) << i;
    bad[i] = '.';
    std::swap(bad[i], bad[i + 1]);
    EXPECT_FALSE(decode_record(bad, format)) << i;
  }
}

TEST(FastrakRecordTest, BinaryWithButtonMatchesTheWorkedExample) {
  FastrakRecord r = example();
  r.pressed = true;
  const auto expected = from_hex(
      "30 31 20 00 00 c0 41 00 00 c0 c0 00 00 48 41 00 00 b4 42 00 00 00 00 00 00 34 c2 20 31 0d "
      "0a");
  EXPECT_THAT(encoded(r, {{2, 4, 16, 1}, true, false}), ElementsAreArray(expected));
}

TEST(FastrakRecordTest, BinaryQuaternionsMatchTheWorkedExamples) {
  const auto identity = from_hex(
      "30 31 20 00 00 c0 41 00 00 c0 c0 00 00 48 41 00 00 80 3f 00 00 00 00 00 00 00 00 00 00 00 "
      "00 "
      "20");
  EXPECT_THAT(encoded(example(), {{2, 11, 0}, true, false}), ElementsAreArray(identity));

  FastrakRecord turned;
  turned.station = 2;
  turned.position = Vec3(30.0, 5.0, -8.25);
  turned.quaternion = {std::sqrt(0.5), 0.0, 0.0, std::sqrt(0.5)};
  const auto quarter_turn = from_hex(
      "30 32 20 00 00 f0 41 00 00 a0 40 00 00 04 c1 f3 04 35 3f 00 00 00 00 00 00 00 00 f3 04 35 "
      "3f "
      "20");
  EXPECT_THAT(encoded(turned, {{2, 11, 0}, true, false}), ElementsAreArray(quarter_turn));
}

TEST(FastrakRecordTest, AsciiQuaternionAndButtonMatchTheWorkedExample) {
  FastrakRecord r = example();
  r.quaternion = {std::sqrt(0.5), 0.0, 0.0, std::sqrt(0.5)};
  EXPECT_EQ(encoded(r, {{2, 11, 16, 1}, false, false}),
            from_text("01   24.00  -6.00  12.50 0.7071 0.0000 0.0000 0.7071 0\r\n"));
}

TEST(FastrakRecordTest, ExtendedPrecisionMatchesTheWorkedExample) {
  EXPECT_EQ(encoded(example(), {{52}, false, false}),
            from_text("01  2.40000E+01 -6.00000E+00  1.25000E+01 "));
}

// The lengths that fifteen clients count on.
TEST(FastrakRecordTest, LengthsAreTheOnesClientsCountOn) {
  const auto lengths = [](std::vector<int> items) {
    return std::pair{fastrak_record_length({items, false, false}),
                     fastrak_record_length({items, true, false})};
  };
  using Pair = std::pair<std::size_t, std::size_t>;
  EXPECT_EQ(lengths({2, 4, 1}), Pair(47, 29));
  EXPECT_EQ(lengths({2, 0, 4, 1}), Pair(48, 30));
  EXPECT_EQ(lengths({2, 11, 0}).second, 32u);
  EXPECT_EQ(lengths({2, 11, 16, 0}).second, 34u);
  EXPECT_EQ(lengths({52, 61, 50}), Pair(95, 32));
  EXPECT_EQ(lengths({2, 11, 1}), Pair(54, 33));
  EXPECT_EQ(lengths({2, 4, 16, 1}), Pair(49, 31));
  EXPECT_EQ(lengths({2, 11, 16, 1}), Pair(56, 35));
  EXPECT_EQ(lengths({0, 2, 0, 0, 11, 1}).first, 57u);
}

// IS-900 guide p. 69: int16((lo & 7F) << 2 | (hi & 7F) << 9) * full scale / 32768, and bit 7 on
// the first byte of the data alone.
TEST(FastrakRecordTest, CompactItemsFollowTheFourteenBitRule) {
  FastrakRecord r;
  r.position = Vec3(150.0, -75.0, 0.1);
  const auto bytes = encoded(r, {{18}, true, true});
  ASSERT_EQ(bytes.size(), 9u);
  EXPECT_EQ(bytes[3] & 0x80, 0x80);
  for (std::size_t i = 4; i < 9; ++i) EXPECT_EQ(bytes[i] & 0x80, 0);
  for (int i = 0; i < 3; ++i) {
    const int lo = bytes[3 + 2 * static_cast<std::size_t>(i)] & 0x7F;
    const int hi = bytes[4 + 2 * static_cast<std::size_t>(i)] & 0x7F;
    const auto code = static_cast<std::int16_t>(lo << 2 | hi << 9);
    EXPECT_NEAR(code * 300.0 / 32768, r.position(i), 0.5 * 300.0 / 8192);
  }
}

TEST(FastrakRecordTest, ItemsOfOtherTrackersDoNotExist) {
  for (const int item :
       {8, 9, 10, 12, 15, 17, 18, 20, 21, 22, 23, 40, 49, 58, 60, 62, 65, 68, 71}) {
    EXPECT_FALSE(is_fastrak_item(item)) << item;
  }
  for (const int item : {18, 19, 20}) EXPECT_TRUE(is_fastrak_item(item, true));
}

TEST(FastrakRecordTest, ValuesBeyondTheColumnsStayInThem) {
  FastrakRecord r;
  r.position = Vec3(1e9, -1e9, std::nan(""));
  EXPECT_EQ(encoded(r, {{2}, false, false}), from_text("01  999.99-999.99   0.00"));
  r.position = Vec3(1e300, -1e-300, 0.0);
  EXPECT_EQ(encoded(r, {{52}, false, false}).size(), 3u + 39u);
}

FastrakRecord random_record(std::mt19937& random) {
  std::uniform_real_distribution<double> place(-120.0, 120.0), unit(-1.0, 1.0);
  FastrakRecord r;
  r.station = 1 + static_cast<int>(random() % 4);
  r.position = Vec3(place(random), place(random), place(random));
  r.relative = 0.01 * Vec3(place(random), place(random), place(random));
  Quat q(unit(random), unit(random), unit(random), unit(random));
  q.normalize();
  r.quaternion = {q.w(), q.x(), q.y(), q.z()};
  r.attitude = q.toRotationMatrix();
  r.angles_deg = Vec3(180.0 * unit(random), 90.0 * unit(random), 180.0 * unit(random));
  r.pressed = random() % 2;
  return r;
}

const std::vector<std::vector<int>> kLists = {
    {2, 4, 1},        {2, 11, 0},           {52, 61, 50}, {2, 4, 16, 1}, {0, 2, 0, 0, 11, 1},
    {5, 6, 7, 3, 51}, {55, 56, 57, 53, 66}, {18, 20, 1},  {19, 16, 0},   {54, 2}};

// Rounding to the format happens once: what was read writes the very same bytes again.
TEST(FastrakRecordTest, WhatIsReadIsWrittenTheSameToTheLastBit) {
  std::mt19937 random(1);
  for (const auto& items : kLists) {
    for (const bool binary : {false, true}) {
      for (const bool centimetres : {false, true}) {
        const FastrakFormat format{items, binary, centimetres};
        for (int i = 0; i < 200; ++i) {
          const auto bytes = encoded(random_record(random), format);
          ASSERT_EQ(bytes.size(), fastrak_record_length(format));
          const auto read = decode_record(bytes, format);
          ASSERT_TRUE(read.has_value());
          EXPECT_THAT(encoded(*read, format), ElementsAreArray(bytes));
        }
      }
    }
  }
}

TEST(FastrakRecordTest, ValuesArriveWithinTheStepOfTheirFormat) {
  std::mt19937 random(2);
  for (int i = 0; i < 500; ++i) {
    const FastrakRecord r = random_record(random);
    const FastrakFormat ascii{{2, 11, 4, 1}, false, false}, binary{{2, 11, 4, 1}, true, false};
    const auto a = decode_record(encoded(r, ascii), ascii);
    const auto b = decode_record(encoded(r, binary), binary);
    ASSERT_TRUE(a && b);
    EXPECT_LE((a->position - r.position).cwiseAbs().maxCoeff(), 0.005 + 1e-12);  // half a step
    EXPECT_LE((b->position - r.position).cwiseAbs().maxCoeff(), 120.0 * 0x1p-24);
    for (std::size_t k = 0; k < 4; ++k) {
      EXPECT_NEAR(a->quaternion[k], r.quaternion[k], 0.00005 + 1e-12);
      EXPECT_NEAR(b->quaternion[k], r.quaternion[k], 0x1p-25);
    }
  }
}

// Azimuth and roll turn all the way round, elevation from straight down to straight up.
TEST(FastrakRecordTest, AnglesBeyondTheirEndsAreRefused) {
  const FastrakFormat format{{2, 4, 0}, true, false};
  const auto is_read = [&](const Vec3& angles_deg) {
    FastrakRecord record = example();
    record.angles_deg = angles_deg;
    return decode_record(encoded(record, format), format).has_value();
  };
  EXPECT_TRUE(is_read(Vec3(180.0, 90.0, -180.0)));
  EXPECT_TRUE(is_read(Vec3(-180.0, -90.0, 180.0)));
  EXPECT_FALSE(is_read(Vec3(181.0, 0.0, 0.0)));
  EXPECT_FALSE(is_read(Vec3(0.0, 91.0, 0.0)));
  EXPECT_FALSE(is_read(Vec3(0.0, -91.0, 0.0)));
  EXPECT_FALSE(is_read(Vec3(0.0, 0.0, -181.0)));
}

TEST(FastrakRecordTest, ImpossibleValuesAndShapesAreRefused) {
  const FastrakFormat format{{2, 11, 0}, true, false};
  const auto good = encoded(example(), format);
  ASSERT_TRUE(decode_record(good, format));
  const auto with = [&](std::size_t at, std::uint8_t byte) {
    auto bytes = good;
    bytes[at] = byte;
    return decode_record(bytes, format).has_value();
  };
  EXPECT_FALSE(with(0, '1'));    // head
  EXPECT_FALSE(with(1, '5'));    // station
  EXPECT_FALSE(with(2, '!'));    // neither space nor letter
  EXPECT_FALSE(with(31, 0));     // tail
  EXPECT_FALSE(with(18, 0x7f));  // quaternion far from unit length
  EXPECT_TRUE(with(2, 'k'));
  auto not_finite = good;
  not_finite[5] = 0xc0, not_finite[6] = 0x7f;  // NaN in x
  EXPECT_FALSE(decode_record(not_finite, format));
  auto far = good;
  far[6] ^= 0x20;  // a bit in the exponent of x: 2^64 times as far
  EXPECT_FALSE(decode_record(far, format));
  far[2] = 'k';  // may hold anything; its sample must be one that a log can be read with
  const auto flagged = decode_record(far, format);
  ASSERT_TRUE(flagged);
  EXPECT_EQ(pose_of(*flagged, format).p, Vec3::Zero());
  EXPECT_FALSE(decode_record(Bytes(good).first(31), format));
  auto longer = good;
  longer.push_back(' ');
  EXPECT_FALSE(decode_record(longer, format));
}

TEST(FastrakStatusTest, OldLayoutMatchesTheWorkedExample) {
  FastrakStatus status;
  status.identification = "F18 Simulator05 Saint Louis";
  const std::string line = encode_status(status);
  EXPECT_EQ(line, "21S3F0  0      103.00F18 Simulator05 Saint Louis     \r\n");
  EXPECT_EQ(line.size(), kFastrakStatusLength);
}

TEST(FastrakStatusTest, FlagsAreHexadecimalText) {
  FastrakStatus status;
  status.binary = true;
  EXPECT_EQ(encode_status(status).substr(3, 3), "3F1");
  status.centimetres = status.continuous = true;
  EXPECT_EQ(encode_status(status).substr(3, 3), "3FB");
  status.compensation = true;
  status.error = 107;
  status.tag = "F33";
  const auto read = decode_status(encode_status(status));
  ASSERT_TRUE(read);
  EXPECT_TRUE(read->binary && read->centimetres && read->compensation && read->continuous);
  EXPECT_EQ(read->error, 107);
  EXPECT_EQ(read->tag, "F33  ");
}

TEST(FastrakStatusTest, TheRecordThatVrpnWasGivenIsRead) {
  const auto read = decode_status("21S3F0    F33  3.8.0 FAKE FASTRAK FOR VRPN           \r\n");
  ASSERT_TRUE(read);
  EXPECT_EQ(read->firmware, "3.8.0 ");
  EXPECT_EQ(read->error, 0);
}

TEST(FastrakStatusTest, WhatIsNoStatusIsRefused) {
  const std::string good = encode_status({});
  for (const std::size_t at : {0u, 1u, 2u, 3u, 53u, 54u}) {
    std::string bad = good;
    bad[at] = '!';
    EXPECT_FALSE(decode_status(bad)) << at;
  }
  EXPECT_FALSE(decode_status(good.substr(1)));
  EXPECT_FALSE(decode_status(""));
}

TEST(FastrakReplyTest, ReadBacksHaveTheLengthsOfTheManual) {
  const std::array<double, 9> nine{};
  const auto length = [&](std::size_t count, int width, int decimals) {
    return encode_reply(1, 'X', encode_columns(std::span(nine).first(count), width, decimals))
        .size();
  };
  EXPECT_EQ(length(9, 7, 2), 68u);  // A
  EXPECT_EQ(length(3, 7, 2), 26u);  // G, H
  EXPECT_EQ(length(1, 7, 2), 12u);  // I
  EXPECT_EQ(length(3, 8, 3), 29u);  // N, r
  EXPECT_EQ(length(6, 8, 3), 53u);  // V
  EXPECT_EQ(length(4, 7, 3), 33u);  // v, x
  EXPECT_EQ(encode_active(1, {true, true, false, false}), "21l1100\r\n");
  EXPECT_EQ(encode_list(1, std::vector<int>{2, 4, 1}), "21O 2 4 1\r\n");
  EXPECT_THAT(decode_list("21O 2 41652\r\n", 1).value(), testing::ElementsAre(2, 4, 16, 52));
  EXPECT_FALSE(decode_list("22O 2 4 1\r\n", 1));
  EXPECT_FALSE(decode_active("21l1200\r\n"));
}

std::vector<std::uint8_t> random_bytes(std::mt19937& random, std::size_t count) {
  std::vector<std::uint8_t> bytes(count);
  for (auto& b : bytes) b = static_cast<std::uint8_t>(random());
  return bytes;
}

struct Read {
  std::vector<std::vector<std::uint8_t>> records;
  std::size_t skipped = 0;
};

// Feeds `stream` in pieces of `chunk` bytes, as a port would.
Read read_all(const std::vector<std::uint8_t>& stream, const FastrakFormats& formats,
              std::size_t chunk) {
  Read read;
  std::vector<std::uint8_t> buffer;
  bool in_step = true;
  for (std::size_t at = 0; at < stream.size() || !buffer.empty();) {
    const std::size_t n = std::min(chunk, stream.size() - at);
    buffer.insert(buffer.end(), stream.begin() + static_cast<std::ptrdiff_t>(at),
                  stream.begin() + static_cast<std::ptrdiff_t>(at + n));
    at += n;
    const bool no_more = at == stream.size();
    while (!buffer.empty()) {
      const FastrakFound found = find_record(buffer, formats, in_step, no_more);
      read.skipped += found.skipped;
      const auto record = buffer.begin() + static_cast<std::ptrdiff_t>(found.skipped);
      if (found.length > 0)
        read.records.emplace_back(record, record + static_cast<std::ptrdiff_t>(found.length));
      buffer.erase(buffer.begin(), record + static_cast<std::ptrdiff_t>(found.length));
      in_step = found.length > 0 || (in_step && found.skipped == 0);
      if (found.length == 0) break;
    }
  }
  return read;
}

TEST(FindRecordTest, NoiseBetweenRecordsCostsNoneAndIsCountedToTheByte) {
  std::mt19937 random(3);
  for (const auto& items : {std::vector<int>{2, 11, 0}, {2, 4, 1}, {2, 11, 16, 1}, {52, 61, 50}}) {
    for (const bool binary : {false, true}) {
      FastrakFormats formats;
      formats.fill({items, binary, true});
      std::vector<std::uint8_t> stream;
      std::vector<std::vector<std::uint8_t>> sent;
      std::size_t noise = 0;
      for (int i = 0; i < 400; ++i) {
        const auto garbage = random_bytes(random, random() % 3 == 0 ? random() % 20 : 0);
        noise += garbage.size();
        stream.insert(stream.end(), garbage.begin(), garbage.end());
        sent.push_back(encoded(random_record(random), formats[0]));
        stream.insert(stream.end(), sent.back().begin(), sent.back().end());
      }
      for (const std::size_t chunk :
           {std::size_t{1}, std::size_t{7}, std::size_t{64}, stream.size()}) {
        const Read read = read_all(stream, formats, chunk);
        EXPECT_EQ(read.records, sent);
        EXPECT_EQ(read.skipped, noise);
      }
    }
  }
}

// The head, tail and even whole openings of records occur inside binary floats; the record that
// the stream is in step with wins.
TEST(FindRecordTest, AnOpeningInsideARecordDoesNotLoseTheStep) {
  const FastrakFormat format{{2, 4, 0}, true, true};
  FastrakFormats formats;
  formats.fill(format);
  auto bytes = encoded(FastrakRecord{}, format);
  bytes[3] = '0', bytes[4] = '2', bytes[5] = ' ';  // inside x: a small finite number
  std::vector<std::uint8_t> stream;
  for (int i = 0; i < 5; ++i) stream.insert(stream.end(), bytes.begin(), bytes.end());
  for (const std::size_t chunk : {std::size_t{1}, std::size_t{10}, stream.size()}) {
    const Read read = read_all(stream, formats, chunk);
    EXPECT_EQ(read.records.size(), 5u);
    EXPECT_EQ(read.skipped, 0u);
  }
}

TEST(FindRecordTest, ALostByteCostsOneRecord) {
  std::mt19937 random(4);
  FastrakFormats formats;
  formats.fill({{2, 11, 16, 1}, true, true});
  std::vector<std::vector<std::uint8_t>> sent;
  for (int i = 0; i < 20; ++i) sent.push_back(encoded(random_record(random), formats[0]));
  for (std::size_t lost = 0; lost < sent[0].size(); ++lost) {
    std::vector<std::uint8_t> stream;
    for (std::size_t i = 0; i < sent.size(); ++i) {
      auto bytes = sent[i];
      if (i == 9) bytes.erase(bytes.begin() + static_cast<std::ptrdiff_t>(lost));
      stream.insert(stream.end(), bytes.begin(), bytes.end());
    }
    const Read read = read_all(stream, formats, 16);
    auto rest = sent;
    rest.erase(rest.begin() + 9);
    EXPECT_EQ(read.records, rest) << lost;
    EXPECT_EQ(read.skipped, sent[9].size() - 1) << lost;
  }
}

TEST(FindRecordTest, RandomBytesAreAllSkippedAndAllCounted) {
  std::mt19937 random(5);
  FastrakFormats formats;
  formats.fill({{2, 11, 16, 1}, true, true});
  const auto stream = random_bytes(random, 20000);
  const Read read = read_all(stream, formats, 100);
  EXPECT_TRUE(read.records.empty());
  EXPECT_EQ(read.skipped, stream.size());
}

}  // namespace
}  // namespace headpin::devices
