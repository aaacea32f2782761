// XDF as it is written: which chunk when, and what its headers and footers say.

#include "devices/recordings/xdf_writer.h"

#include <array>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/devices/xdf_reading.h"

namespace headpin::devices {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

/// A writer and its file.
struct WrittenXdf {
  std::string file;
  XdfWriter writer{[this](std::string_view bytes) { file += bytes; }, "<room>5</room>"};
  std::size_t read_to = 4;

  /// The chunks since the last call, a letter each: header, stream, data, offset, boundary, footer.
  std::string new_chunks() {
    std::string letters;
    while (read_to < file.size()) {
      const auto byte = [&](std::size_t i) {
        return std::size_t{static_cast<unsigned char>(file.at(read_to + i))};
      };
      const std::size_t bytes = byte(0);
      std::size_t length = 0;
      for (std::size_t i = 0; i < bytes; ++i) length |= byte(1 + i) << (8 * i);
      letters += std::string(" hsdobf").at(byte(1 + bytes));
      read_to += 1 + bytes + length;
    }
    EXPECT_EQ(read_to, file.size());
    return letters;
  }
};

// LabRecorder's intervals: samples 0.5 s, clock offsets 5 s, boundaries 10 s.
TEST(XdfWriter, ChunksAreWrittenAtTheIntervalsOfLabRecorder) {
  WrittenXdf xdf;
  const std::size_t stream = xdf.writer.begin({"n", "t", "double64", {{"a", "", "", ""}}});
  EXPECT_EQ(xdf.new_chunks(), "hs");
  const auto at = [&](double time) {
    xdf.writer.advance(time);
    xdf.writer.add(stream, time, std::array{1.0});
    return xdf.new_chunks();
  };
  EXPECT_EQ(at(100.0), "o");
  EXPECT_EQ(at(100.25), "");
  EXPECT_EQ(at(100.5), "d");
  EXPECT_EQ(at(100.75), "");
  EXPECT_EQ(at(101.0), "d");
  EXPECT_EQ(at(104.75), "d");
  EXPECT_EQ(at(105.0), "o");
  EXPECT_EQ(at(109.75), "d");
  EXPECT_EQ(at(110.0), "ob");
  EXPECT_EQ(at(110.25), "d");
  EXPECT_EQ(at(119.75), "do");
  EXPECT_EQ(at(120.0), "b");
  xdf.writer.finish();
  EXPECT_EQ(xdf.new_chunks(), "dbf");
}

TEST(XdfWriter, AStreamWithoutSamplesHasItsHeaderAndItsFooter) {
  WrittenXdf xdf;
  xdf.writer.begin({"n", "t", "double64", {{"a", "", "", ""}}});
  xdf.writer.begin({"m", "t", "string", {{"a", "", "", ""}}});
  xdf.writer.advance(1.0);
  xdf.writer.advance(2.0);
  xdf.writer.finish();
  EXPECT_EQ(xdf.new_chunks(), "hssoobff");
}

TEST(XdfWriter, FootersSayTheFirstAndTheLastTimeAndTheOffsets) {
  WrittenXdf xdf;
  const std::size_t stream = xdf.writer.begin({"n", "t", "double64", {{"a", "", "", ""}}});
  for (const double time : {2.5, 3.0, 8.0}) {
    xdf.writer.advance(time);
    xdf.writer.add(stream, time + 0.25, std::array{1.0});
  }
  xdf.writer.finish();
  EXPECT_THAT(xdf.file,
              HasSubstr("<info><first_timestamp>2.75</first_timestamp><last_timestamp>8.25"
                        "</last_timestamp><sample_count>3</sample_count><clock_offsets>"
                        "<offset><time>2.5</time><value>0</value></offset>"
                        "<offset><time>8</time><value>0</value></offset></clock_offsets></info>"));
}

// A length of one byte is at most 255.
TEST(XdfWriter, StreamsAndWordsOfAnyLengthComeBack) {
  WrittenXdf xdf;
  xdf.writer.begin({"Hand & head",
                    "MoCap",
                    "double64",
                    {{"x", "PositionX", "meters", "Ball"}, {"y", "PositionY", "meters", ""}}});
  const std::size_t stream = xdf.writer.begin({"Words", "Markers", "string", {{"a", "", "", ""}}});
  const std::vector<std::string> words = {"", std::string(255, 'a'), std::string(256, 'b'),
                                          std::string(70'000, 'c')};
  for (const std::string& word : words) xdf.writer.add(stream, 1.0, std::array{word});
  xdf.writer.finish();
  EXPECT_THAT(xdf.file, Not(HasSubstr("<object></object>")));

  const XdfFile file = read_all_streams(xdf.file);
  EXPECT_THAT(file.notes, ElementsAre());
  EXPECT_EQ(file.header.text_at({"room"}), "5");
  ASSERT_EQ(file.streams.size(), 2u);
  const XdfStream &poses = file.streams[0], &read = file.streams[1];
  EXPECT_EQ(poses.id, 1u);
  EXPECT_EQ(poses.name, "Hand & head");
  EXPECT_EQ(poses.channels.at(0).object, "Ball");
  EXPECT_EQ(poses.channels.at(1).object, "");
  EXPECT_EQ(poses.channels.at(1).type, "PositionY");
  EXPECT_EQ(read.id, 2u);
  EXPECT_EQ(read.words, words);
  EXPECT_EQ(read.times, std::vector<double>(4, 1.0));

  const std::vector<XdfWriter::Count> counts = xdf.writer.counts();
  ASSERT_EQ(counts.size(), 2u);
  EXPECT_EQ(counts[0].name, "Hand & head");
  EXPECT_EQ(counts[0].samples, 0);
  EXPECT_EQ(counts[1].name, "Words");
  EXPECT_EQ(counts[1].samples, 4);
}

}  // namespace
}  // namespace headpin::devices
