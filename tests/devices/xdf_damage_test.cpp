// XDF chunk by chunk: limits of its numbers, and what is left of a damaged file.

#include <array>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/devices/xdf_reading.h"
#include "tests/support/xdf_bytes.h"

namespace headpin::devices {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// The beginning of a file with one stream of small numbers.
std::string of_small_numbers() {
  return xdf::begin() + xdf::stream(1, "s", "t", "int8", 0.0, {{"a", ""}});
}

std::string small_number(double time) {
  return xdf::samples(1, 1, xdf::sample(time, "\x05"));
}

TEST(XdfFile, ALengthHas1Or4Or8Bytes) {
  const std::string content = xdf::bytes(std::uint16_t{7}) + "abc";
  const auto notes_with = [&](const std::string& length) {
    return read_all_streams(of_small_numbers() + length + content + xdf::footer(1)).notes;
  };
  EXPECT_THAT(notes_with("\x01" + xdf::bytes(std::uint8_t{5})), IsEmpty());
  EXPECT_THAT(notes_with("\x04" + xdf::bytes(std::uint32_t{5})), IsEmpty());
  EXPECT_THAT(notes_with("\x08" + xdf::bytes(std::uint64_t{5})), IsEmpty());
  EXPECT_THAT(notes_with("\x02" + xdf::bytes(std::uint16_t{5})),
              testing::Contains(HasSubstr("a length has no 1, 4 or 8 bytes")));
}

TEST(XdfFile, AChunkHasATagFrom1To100) {
  const auto notes_with = [](const std::string& chunk) {
    return read_all_streams(of_small_numbers() + chunk + xdf::boundary() + xdf::footer(1)).notes;
  };
  for (const int tag : {7, 100}) {
    EXPECT_THAT(notes_with(xdf::chunk(static_cast<std::uint16_t>(tag), "abc")), IsEmpty());
    EXPECT_THAT(notes_with(xdf::chunk(static_cast<std::uint16_t>(tag), "")), IsEmpty());
  }
  EXPECT_THAT(notes_with(xdf::chunk(0, "abc")), ElementsAre(HasSubstr("(unknown tag 0)")));
  EXPECT_THAT(notes_with(xdf::chunk(101, "abc")), ElementsAre(HasSubstr("(unknown tag 101)")));
  EXPECT_THAT(notes_with("\x01\x01z"), ElementsAre(HasSubstr("(it has no tag)")));
}

TEST(XdfFile, AStreamHas1To100000Channels) {
  const auto with_channels = [](const std::string& count) {
    return read_all_streams(xdf::begin() +
                            xdf::chunk(2, xdf::bytes(std::uint32_t{1}) + "<info><channel_count>" +
                                              count + "</channel_count><channel_format>int8" +
                                              "</channel_format></info>"));
  };
  EXPECT_EQ(with_channels("1").streams.at(0).channels.size(), 1u);
  EXPECT_EQ(with_channels("100000").streams.at(0).channels.size(), 100'000u);
  for (const std::string none : {"0", "-1", "100001", "nan", ""}) {
    const XdfFile file = with_channels(none);
    EXPECT_THAT(file.streams, IsEmpty());
    EXPECT_THAT(
        file.notes,
        ElementsAre(HasSubstr(fmt::format("expected 1 to 100000 channels, found '{}'", none))));
  }
}

TEST(XdfFile, AHeaderHasAtMost4000000Bytes) {
  const auto with_bytes = [](std::size_t size) {
    const std::string begin = "<info><version>1.0</version>", end = "</info>";
    return read_all_streams(
        "XDF:" + xdf::chunk(1, begin + std::string(size - begin.size() - end.size(), ' ') + end));
  };
  const XdfFile longest = with_bytes(4'000'000);
  EXPECT_EQ(longest.header.text_at({"version"}), "1.0");
  EXPECT_THAT(longest.notes, IsEmpty());
  EXPECT_THAT(with_bytes(4'000'001).notes, ElementsAre(HasSubstr("its XML is too long")));
}

TEST(XdfFile, TheHeaderIsReadAlone) {
  const std::string file = xdf::begin() + "whatever follows";
  const auto header = xdf_header(bytes_in(file));
  ASSERT_TRUE(header.has_value());
  EXPECT_EQ(header->text_at({"version"}), "1.0");
  const std::string magic = "XDF:";
  for (const std::string& none :
       {std::string(), magic, "XDG:" + xdf::begin().substr(4), xdf::begin().substr(0, 20),
        magic + xdf::stream(1, "s", "t", "int8", 0.0, {{"a", ""}}), magic + xdf::chunk(1, "<a>")}) {
    EXPECT_FALSE(xdf_header(bytes_in(none)).has_value());
  }
}

TEST(XdfFile, AChunkMayHaveNoSamples) {
  const XdfFile file = read_all_streams(of_small_numbers() + xdf::samples(1, 0, "") +
                                        small_number(2.0) + xdf::footer(1));
  EXPECT_THAT(file.notes, IsEmpty());
  EXPECT_THAT(file.streams.at(0).times, ElementsAre(2.0));
}

TEST(XdfFile, WithoutARateATimeThatIsLeftOutIsTheOneBefore) {
  const XdfFile file = read_all_streams(of_small_numbers() + small_number(2.0) +
                                        xdf::samples(1, 1, xdf::sample("\x06")) + xdf::footer(1));
  EXPECT_THAT(file.streams.at(0).times, ElementsAre(2.0, 2.0));
}

// Of a chunk with too few bytes no sample is kept, and the times go on from the last one that is.
TEST(XdfFile, ADamagedChunkOfSamplesIsLeftOutWhole) {
  for (const std::string format : {"double64", "string"}) {
    const std::string value = format == "string" ? xdf::text("five") : xdf::bytes(5.0);
    const std::string good = xdf::sample(1.0, value);
    const XdfFile file = read_all_streams(
        xdf::begin() + xdf::stream(1, "s", "t", format, 2.0, {{"a", ""}}) +
        xdf::samples(1, 1, good) +
        xdf::samples(1, 3, xdf::sample(7.0, value) + xdf::sample(8.0, value) + '\x08') +
        xdf::samples(1, 1, xdf::sample(value)) + xdf::footer(1));
    const XdfStream& stream = file.streams.at(0);
    EXPECT_THAT(stream.times, ElementsAre(1.0, 1.5));
    EXPECT_EQ(stream.numbers.size() + stream.words.size(), 2u);
    EXPECT_THAT(file.notes, ElementsAre(HasSubstr("it is shorter than what it says")));
  }
}

TEST(XdfFile, AChunkThatEndsInTheNumberOfItsStreamIsDamaged) {
  const XdfFile file = read_all_streams(of_small_numbers() + xdf::chunk(3, "\x01") +
                                        small_number(2.0) + xdf::footer(1));
  EXPECT_THAT(file.streams.at(0).times, ElementsAre(2.0));
  EXPECT_THAT(file.notes, ElementsAre(HasSubstr("it is shorter than what it says")));
}

TEST(XdfFile, FiveDamagedPlacesAreToldAndTheOthersCounted) {
  const auto notes_of = [](int damaged) {
    std::string file = of_small_numbers();
    for (int i = 0; i < damaged; ++i) file += xdf::samples(9, 0, "");
    return read_all_streams(file + xdf::footer(1)).notes;
  };
  const auto told = HasSubstr("is damaged (stream 9 has no header): ignored");
  EXPECT_THAT(notes_of(5), ElementsAre(told, told, told, told, told));
  EXPECT_THAT(notes_of(7), ElementsAre(told, told, told, told, told, "2 more places are damaged"));
}

TEST(XdfFile, OfAFileThatWasCutTheBytesThatAreLostAreTold) {
  const std::string whole =
      of_small_numbers() + xdf::stream(2, "u", "t", "int8", 0.0, {{"a", ""}}) + xdf::footer(2);
  const std::string cut = small_number(3.0).substr(0, 13);
  EXPECT_THAT(
      read_all_streams(whole + cut).notes,
      ElementsAre(
          fmt::format("the file ends inside a chunk, or is damaged from byte {} on (it is longer "
                      "than the rest of the file): the 13 bytes from there are ignored",
                      whole.size()),
          "1 of 2 streams have no footer: the recorder did not end the file"));
}

// It is searched in pieces.
TEST(XdfFile, ABoundaryIsFoundHoweverFarItIs) {
  const std::string begin = of_small_numbers() + small_number(1.0) + '\x09';
  const std::string end = xdf::boundary() + small_number(2.0) + xdf::footer(1);
  for (const std::size_t far : {0u, 1000u, 131'000u, 200'000u}) {
    EXPECT_THAT(read_all_streams(begin + std::string(far, 'x') + end).streams.at(0).times,
                ElementsAre(1.0, 2.0));
  }
  for (std::size_t far = 65'490; far < 65'545; ++far) {
    EXPECT_THAT(read_all_streams(begin + std::string(far, 'x') + end).streams.at(0).times,
                ElementsAre(1.0, 2.0))
        << far;
  }
}

// As where the length of the chunk before is wrong.
TEST(XdfFile, ABoundaryThatStandsWhereAChunkShouldBeginIsFound) {
  const XdfFile file = read_all_streams(of_small_numbers() + std::string(kXdfBoundary) +
                                        small_number(2.0) + xdf::footer(1));
  EXPECT_THAT(file.streams.at(0).times, ElementsAre(2.0));
  EXPECT_THAT(file.notes, ElementsAre(HasSubstr("are damaged")));
}

// It was taken as 0 without a word. Times that are left out follow from it.
TEST(XdfFile, ARateThatIsNoneIsTold) {
  const auto with_rate = [](const std::string& rate) {
    const std::string info = "<info><name>s</name><channel_count>1</channel_count><nominal_srate>" +
                             rate + "</nominal_srate><channel_format>int8</channel_format></info>";
    return read_all_streams(xdf::begin() + xdf::chunk(2, xdf::bytes(std::uint32_t{1}) + info) +
                            small_number(2.0) + xdf::samples(1, 1, xdf::sample("\x06")) +
                            xdf::footer(1));
  };
  for (const std::string none : {"fast", "nan", "-nan", "inf", "-100", "1e400"}) {
    const XdfFile file = with_rate(none);
    EXPECT_THAT(file.streams.at(0).times, ElementsAre(2.0, 2.0)) << none;
    EXPECT_THAT(file.notes,
                ElementsAre(HasSubstr("stream 's': expected a nominal_srate of 0 or more, found")))
        << none;
  }
  for (const std::string rate : {"4", " 4.0\n", "4.0 Hz"}) {
    const XdfFile file = with_rate(rate);
    EXPECT_THAT(file.streams.at(0).times, ElementsAre(2.0, 2.25)) << rate;
    EXPECT_THAT(file.notes, IsEmpty()) << rate;
  }
  EXPECT_THAT(with_rate("0").notes, IsEmpty());
  EXPECT_THAT(with_rate("").notes, IsEmpty());
}

TEST(XdfFile, WhatAFooterSaysIsNotUsed) {
  for (const std::string says :
       {"<info><first_timestamp>x</first_timestamp><last_timestamp>nan</last_timestamp>"
        "<sample_count>-1</sample_count></info>",
        "<info", "\xff\xfe", ""}) {
    const XdfFile file = read_all_streams(of_small_numbers() + small_number(2.0) +
                                          xdf::chunk(6, xdf::bytes(std::uint32_t{1}) + says));
    EXPECT_THAT(file.streams.at(0).times, ElementsAre(2.0));
    EXPECT_THAT(file.notes, IsEmpty());
  }
}

/// A file with a stream that has this name and tells this rate.
std::string of_a_rate(const std::string& name, const std::string& rate) {
  const std::string info = "<info><name>" + name + "</name><channel_count>1</channel_count>" +
                           "<nominal_srate>" + rate +
                           "</nominal_srate><channel_format>int8</channel_format></info>";
  return xdf::begin() + xdf::chunk(2, xdf::bytes(std::uint32_t{1}) + info) + xdf::footer(1);
}

// It was read as the number before it: 100 of 100,5.
TEST(XdfFile, ARateIsANumberAndNothingElse) {
  for (const std::string none : {"100,5", "60fast", "60 fast", "1e3x", "4.0 Hz?"}) {
    const XdfFile file = read_all_streams(of_a_rate("s", none));
    EXPECT_EQ(file.streams.at(0).rate_hz, 0.0) << none;
    EXPECT_THAT(file.notes, ElementsAre(HasSubstr("found '" + none + "': taken as 0"))) << none;
  }
  for (const std::string rate :
       {"100.5", " 100.5 ", "100.5Hz", "1.005e2 Hz", "100.5 hz", "100.5HZ"}) {
    const XdfFile file = read_all_streams(of_a_rate("s", rate));
    EXPECT_EQ(file.streams.at(0).rate_hz, 100.5) << rate;
    EXPECT_THAT(file.notes, IsEmpty()) << rate;
  }
}

TEST(XdfFile, ARateThatIsNoneIsToldOnlyOfAStreamThatIsWanted) {
  const std::string file = of_a_rate("s", "fast");
  EXPECT_THAT(read_xdf(bytes_in(file), "x.xdf", [](const XdfStream&) { return false; }).notes,
              IsEmpty());
}

TEST(XdfFile, NamesAndRatesInANoteEndWithAWholeLetter) {
  const std::string name = std::string(39, 'n') + "ä", rate = "x" + std::string(18, 'r') + "€";
  EXPECT_THAT(read_all_streams(of_a_rate(name, rate)).notes,
              ElementsAre(testing::AllOf(HasSubstr("'" + std::string(39, 'n') + "':"),
                                         HasSubstr("'x" + std::string(18, 'r') + "':"))));
}

}  // namespace
}  // namespace headpin::devices
