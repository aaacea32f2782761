// XDF, as bytes of its specification: chunks, clocks, streams of motion.

#include "scene/record/xdf.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/recordings/xdf_clock.h"
#include "devices/recordings/xdf_motion.h"
#include "devices/recordings/xdf_writer.h"
#include "tests/devices/xdf_reading.h"
#include "tests/support/xdf_bytes.h"

namespace headpin::devices {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(XdfFile, NumbersOfEveryFormatAreRead) {
  const auto numbers = [](const std::string& format, const std::string& value) {
    const XdfFile file = read_all_streams(
        xdf::begin() + xdf::stream(7, "n", "t", format, 0.0, {{"a", ""}, {"b", ""}}) +
        xdf::samples(7, 1, xdf::sample(2.5, value + value)) + xdf::footer(7));
    EXPECT_THAT(file.notes, ElementsAre());
    EXPECT_THAT(file.streams.at(0).times, ElementsAre(2.5));
    return file.streams.at(0).numbers;
  };
  EXPECT_THAT(numbers("int8", xdf::bytes(std::int8_t{-3})), ElementsAre(-3.0, -3.0));
  EXPECT_THAT(numbers("int16", xdf::bytes(std::int16_t{-300})), ElementsAre(-300.0, -300.0));
  EXPECT_THAT(numbers("int32", xdf::bytes(-70000)), ElementsAre(-70000.0, -70000.0));
  EXPECT_THAT(numbers("int64", xdf::bytes(std::int64_t{-5'000'000'000})), ElementsAre(-5e9, -5e9));
  EXPECT_THAT(numbers("float32", xdf::bytes(0.1f)), ElementsAre(double{0.1f}, double{0.1f}));
  EXPECT_THAT(numbers("double64", xdf::bytes(0.1)), ElementsAre(0.1, 0.1));
}

TEST(XdfFile, TimesThatAreLeftOutFollowFromTheRate) {
  const std::string word = xdf::text("a");
  const XdfFile file =
      read_all_streams(xdf::begin() + xdf::stream(1, "s", "t", "string", 4.0, {{"a", ""}}) +
                       xdf::samples(1, 2, xdf::sample(1.0, word) + xdf::sample(word)) +
                       xdf::samples(1, 1, xdf::sample(xdf::text(""))) + xdf::footer(1));
  EXPECT_THAT(file.streams.at(0).times, ElementsAre(1.0, 1.25, 1.5));
  EXPECT_THAT(file.streams.at(0).words, ElementsAre("a", "a", ""));
}

/// A file of ten chunks of one sample each: its time and its number.
std::string ten_samples(bool boundaries) {
  std::string file = xdf::begin() + xdf::stream(1, "s", "t", "int8", 0.0, {{"a", ""}});
  for (int i = 0; i < 10; ++i) {
    file += xdf::samples(1, 1, xdf::sample(i, std::string(1, static_cast<char>(i))));
    if (boundaries) file += xdf::boundary();
  }
  return file + xdf::footer(1);
}

TEST(XdfFile, ThatWasCutIsReadToWhereItIsWhole) {
  const std::string whole = ten_samples(false);
  EXPECT_THAT(read_all_streams(whole).notes, ElementsAre());
  std::size_t before = 0;
  for (std::size_t size = xdf::begin().size(); size < whole.size(); ++size) {
    const XdfFile file = read_all_streams(whole.substr(0, size));
    const std::vector<double> times =
        file.streams.empty() ? std::vector<double>{} : file.streams[0].times;
    for (std::size_t i = 0; i < times.size(); ++i) EXPECT_EQ(times[i], static_cast<double>(i));
    EXPECT_GE(times.size(), before);
    before = times.size();
    if (!file.streams.empty()) {
      EXPECT_THAT(file.notes, testing::Contains(HasSubstr("no footer"))) << size;
    }
  }
  EXPECT_EQ(before, 10u);
}

TEST(XdfFile, IsReadOnAtTheNextBoundaryAfterDamage) {
  std::string file = ten_samples(true);
  const std::string third = xdf::samples(1, 1, xdf::sample(3.0, "\x03"));
  file[file.find(third)] = '\x09';  // no number has nine bytes
  const XdfFile read = read_all_streams(file);
  EXPECT_THAT(read.streams.at(0).times, ElementsAre(0, 1, 2, 4, 5, 6, 7, 8, 9));
  EXPECT_THAT(read.notes, ElementsAre(HasSubstr("damaged")));
}

TEST(XdfFile, OfAnyBytesIsReadOrRefused) {
  const std::string whole = ten_samples(true);
  std::mt19937 random(7);
  for (int i = 0; i < 20'000; ++i) {
    std::string file = whole;
    for (int flips = 1 + static_cast<int>(random() % 4); flips > 0; --flips)
      file[4 + random() % (file.size() - 4)] = static_cast<char>(random());
    for (const XdfStream& stream : read_all_streams(file).streams) {
      ASSERT_EQ(stream.numbers.size() + stream.words.size(),
                stream.times.size() * stream.channels.size());
    }
  }
  EXPECT_THROW(read_all_streams("XDG:"), std::invalid_argument);
  EXPECT_THROW(read_all_streams(""), std::invalid_argument);
}

TEST(PlainXml, TextsComeBackAsTheyWereWritten) {
  const std::string text = "a < b && c > \"d\"\r\n\tÄ € 𝄞 ]]>";
  const XmlElement read =
      parse_xml("<?xml?><!-- < --><a b=\"1\"><c/>" + xml_escaped(text) + "</a>");
  EXPECT_EQ(read.name, "a");
  EXPECT_EQ(read.text, text);
  EXPECT_EQ(parse_xml("<a><![CDATA[<&amp;]]>&#65;&#x42;&no;</a>").text, "<&amp;AB&no;");
  EXPECT_EQ(xml_escaped("a\xff\x01\xc0\x80"
                        "b"),
            "a????b");
}

TEST(PlainXml, ThatIsNotWholeIsRefused) {
  for (const char* text :
       {"", "a", "<a>", "</a>", "<a></b>", "<a/><b/>", "<a", "<", "<>", "<!--"}) {
    EXPECT_THROW(parse_xml(text), std::invalid_argument) << text;
  }
  std::string deep;
  for (int i = 0; i < 100'000; ++i) deep += "<a>";
  EXPECT_THROW(parse_xml(deep), std::invalid_argument);
}

/// Offsets every 5 s of a clock that drifts by 20 ppm, which is ahead of the recorder by 30 s.
std::vector<XdfClockOffset> drifting(double from, double count) {
  std::vector<XdfClockOffset> offsets;
  for (double i = 0; i < count; ++i) {
    const double time = from + 5.0 * i;
    offsets.push_back({time, -30.0 + 2e-5 * (time - 1000.0), static_cast<std::size_t>(i)});
  }
  return offsets;
}

TEST(XdfClock, ALineIsUndone) {
  std::vector<std::string> notes;
  const std::vector<double> times = {999.0, 1000.0, 1234.5};
  const std::vector<double> same = synchronised(times, drifting(1000.0, 60), notes);
  for (std::size_t i = 0; i < times.size(); ++i) {
    EXPECT_NEAR(same[i], times[i] - 30.0 + 2e-5 * (times[i] - 1000.0), 1e-9);  // rounding
  }
  EXPECT_THAT(synchronised(times, drifting(1000.0, 1), notes), ElementsAre(969.0, 970.0, 1204.5));
  EXPECT_EQ(synchronised(times, {}, notes), times);
  EXPECT_THAT(notes, ElementsAre());
}

// Of 60 offsets one is wrong by 50 ms. Least squares would be off by 50 ms / 60 = 0.8 ms at least; Huber's
// loss lets one point pull with the weight of 0.1 ms only: 0.1 ms / 59, and up to four times that at the ends.
TEST(XdfClock, AnOutlierHasLittleWeight) {
  std::vector<XdfClockOffset> offsets = drifting(1000.0, 60);
  offsets[50].value += 0.05;
  std::vector<std::string> notes;
  for (const double time : {1000.0, 1150.0, 1295.0}) {
    const double exact = time - 30.0 + 2e-5 * (time - 1000.0);
    EXPECT_NEAR(synchronised(std::vector{time}, offsets, notes)[0], exact, 8e-6);
  }
}

TEST(XdfClock, EachSideOfAResetHasItsOwnLine) {
  std::vector<XdfClockOffset> offsets = drifting(1000.0, 10);
  std::vector<double> times;
  for (int i = 0; i < 10; ++i) times.push_back(1000.0 + 5.0 * i);
  // The computer started again: its clock counts from 0, 70 s after the first offset.
  for (int i = 0; i < 10; ++i) {
    offsets.push_back({5.0 * i, 1040.0, static_cast<std::size_t>(10 + i)});
    times.push_back(5.0 * i);
  }
  std::vector<std::string> notes;
  const std::vector<double> same = synchronised(times, offsets, notes);
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_NEAR(same[i], 970.0 + (5.0 + 1e-4) * static_cast<double>(i), 1e-9) << i;
    EXPECT_NEAR(same[10 + i], 1040.0 + 5.0 * static_cast<double>(i), 1e-9) << i;
  }
  EXPECT_THAT(notes, ElementsAre(HasSubstr("reset after 1045.000 s")));
}

/// Type and unit of a channel of motion.
std::string of_type(const std::string& type, const std::string& unit,
                    const std::string& object = "") {
  return (object.empty() ? "" : "<object>" + object + "</object>") + "<type>" + type +
         "</type><unit>" + unit + "</unit>";
}

/// Positions in millimetres and a quaternion, in a layout of LSL's meta-data; the label says nothing.
xdf::Channels channels_of(const std::string& object) {
  xdf::Channels channels;
  for (const char* type : {"PositionX", "PositionY", "PositionZ"})
    channels.push_back({"c", of_type(type, "millimeters", object)});
  for (const char* type : {"OrientationA", "OrientationB", "OrientationC", "OrientationD"})
    channels.push_back({"c", of_type(type, "quaternion", object)});
  return channels;
}

std::string pose_in_mm(double x, double y, double z) {
  std::string out;
  for (const double number : {x, y, z, 1.0, 0.0, 0.0, 0.0}) out += xdf::bytes(number);
  return out;
}

/// A head on the recorder's clock, a hand on a clock that is 100 s ahead, EEG and markers.
std::string recording_of_two_clocks() {
  std::string file =
      xdf::begin() + xdf::stream(1, "Vive", "MoCap", "double64", 0.0, channels_of("HMD")) +
      xdf::stream(2, "Vive", "MoCap", "double64", 0.0, channels_of("Right controller")) +
      xdf::stream(3, "Amplifier", "EEG", "int16", 500.0, {{"Cz", ""}, {"Trigger", ""}}) +
      xdf::stream(4, "Task", "Markers", "string", 0.0, {{"marker", ""}}) +
      xdf::offset(2, 110.0, -100.0);
  for (int i = 0; i < 120; ++i) {
    const double t = 10.0 + 0.01 * i;
    file += xdf::samples(1, 1, xdf::sample(t, pose_in_mm(0.0, 1600.0 + i, 0.0)));
    file += xdf::samples(2, 1, xdf::sample(t + 100.0, pose_in_mm(300.0, 900.0 + 2.0 * i, -100.0)));
    file += xdf::samples(3, 1,
                         xdf::sample(t, xdf::bytes(std::int16_t{1}) + xdf::bytes(std::int16_t{2})));
  }
  file += xdf::samples(
      4, 2, xdf::sample(10.2, xdf::text("grab ball")) + xdf::sample(10.9, xdf::text("release")));
  for (const std::uint32_t id : {1u, 2u, 3u, 4u}) file += xdf::footer(id);
  return file;
}

TEST(XdfMotion, HeadAndHandOfTwoClocksAreTogether) {
  const std::string file = recording_of_two_clocks();
  const MotionTracks read = parse_xdf_motion(bytes_in(file), "x.xdf", {});
  const MotionRecording recording = recording_of(read, {}, "x.xdf");
  ASSERT_EQ(recording.times.size(), 120u);
  EXPECT_TRUE(recording.left_hand.empty());
  for (std::size_t i = 0; i < 120; ++i) {
    EXPECT_EQ(recording.times[i], Time{10'000} * static_cast<std::int64_t>(i));
    EXPECT_NEAR(recording.head[i].p.y(), 1.6 + 0.001 * static_cast<double>(i), 1e-12);
    // 110 s and 10 s differ in their last bits, and so the hand is interpolated over 1e-6 of a step.
    EXPECT_NEAR(recording.right_hand[i].p.y(), 0.9 + 0.002 * static_cast<double>(i), 1e-6);
  }
  ASSERT_EQ(recording.triggers[1].size(), 2u);
  EXPECT_EQ(recording.triggers[1][0].time, Time{200'000});
  EXPECT_TRUE(recording.triggers[1][0].value);
  EXPECT_EQ(recording.triggers[1][1].time, Time{900'000});
  EXPECT_THAT(recording.notes, testing::Contains(HasSubstr("'Amplifier' (EEG, 2 channels)")));
  EXPECT_THAT(recording.notes, testing::Contains(HasSubstr("markers 'Task marker'")));
}

// The markers are the trigger of both hands.
TEST(XdfMotion, MarkersThatSayNothingOfTheTriggerAreToldOnce) {
  std::string file = xdf::begin();
  std::uint32_t id = 0;
  for (const std::string object : {"HMD", "Left controller", "Right controller"})
    file += xdf::stream(++id, object, "MoCap", "double64", 0.0, channels_of(object));
  file += xdf::stream(4, "Task", "Markers", "string", 0.0, {{"marker", ""}});
  for (int i = 0; i < 120; ++i) {
    const std::string one = xdf::sample(10.0 + 0.01 * i, pose_in_mm(0.0, 1600.0 + i, 0.0));
    for (id = 1; id <= 3; ++id) file += xdf::samples(id, 1, one);
  }
  file += xdf::samples(4, 3,
                       xdf::sample(10.1, xdf::text("cue")) + xdf::sample(10.2, xdf::text("grab")) +
                           xdf::sample(10.9, xdf::text("release")));
  for (id = 1; id <= 4; ++id) file += xdf::footer(id);
  const MotionTracks read = parse_xdf_motion(bytes_in(file), "x.xdf", {});
  EXPECT_EQ(read.triggers[0].size(), 2u);
  EXPECT_EQ(read.triggers[1].size(), 2u);
  EXPECT_EQ(std::ranges::count_if(
                read.notes,
                [](const std::string& note) { return note.find("blank") != std::string::npos; }),
            1);
}

TEST(XdfMotion, EulerAnglesOfTheirTypesAreRead) {
  xdf::Channels channels;
  for (const std::string object : {"Head", "Left hand"}) {
    for (const char* type : {"PositionX", "PositionY", "PositionZ"})
      channels.push_back({"c", of_type(type, "meters", object)});
    for (const char* type : {"OrientationH", "OrientationP", "OrientationR"})
      channels.push_back({"c", of_type(type, "degrees", object)});
  }
  std::string values;
  for (const float number : {0.f, 1.f, 2.f, 90.f, 0.f, 0.f, 3.f, 4.f, 5.f, 0.f, 0.f, 90.f})
    values += xdf::bytes(number);
  const std::string file = xdf::begin() + xdf::stream(1, "M", "MoCap", "float32", 0.0, channels) +
                           xdf::samples(1, 1, xdf::sample(1.0, values)) +
                           xdf::samples(1, 1, xdf::sample(1.1, values)) + xdf::footer(1);
  const MotionRecording recording =
      recording_of(parse_xdf_motion(bytes_in(file), "x.xdf", {}), {}, "x.xdf");
  ASSERT_EQ(recording.left_hand.size(), 2u);
  // A heading of 90 degrees turns ahead to the left; a roll turns right up.
  EXPECT_LT((recording.head[0].q * -Vec3::UnitZ() + Vec3::UnitX()).norm(), 1e-12);
  EXPECT_LT((recording.left_hand[0].q * Vec3::UnitX() - Vec3::UnitY()).norm(), 1e-12);
}

// As LSL's program for OptiTrack labels them, but without <object>.
TEST(XdfMotion, TheObjectIsFoundInLabelsThatEndWithALetter) {
  xdf::Channels channels;
  const std::string letters = "XYZABCD";
  for (const std::string object : {"Head", "Right wrist"}) {
    for (const char letter : letters) {
      const std::string kind = letter < 'X' ? "Orientation" : "Position";
      channels.push_back({object + "_" + letter, of_type(kind + letter, "")});
    }
  }
  const std::string half = xdf::bytes(0.5), two = xdf::bytes(2.0);
  const std::string pose = two + two + two + half + half + half + half;
  const std::string file = xdf::begin() + xdf::stream(1, "M", "MoCap", "double64", 0.0, channels) +
                           xdf::samples(1, 1, xdf::sample(1.0, pose + pose)) + xdf::footer(1);
  const MotionTracks read = parse_xdf_motion(bytes_in(file), "x.xdf", {});
  EXPECT_THAT(read.without_rotation, ElementsAre());
  const MotionRecording recording = recording_of(read, {}, "x.xdf");
  ASSERT_EQ(recording.right_hand.size(), 1u);
  EXPECT_EQ(recording.right_hand[0].q.coeffs(), Quat(0.5, 0.5, 0.5, 0.5).coeffs());
}

std::string why_no_motion(const std::string& file) {
  try {
    parse_xdf_motion(bytes_in(file), "x.xdf", {});
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

// One clock offset for each 5 s until a time of 1e13 us would be a file without an end.
TEST(XdfWriter, ATimeFarAwayMakesTheFileNoLonger) {
  std::string file;
  XdfWriter writer([&](std::string_view bytes) { file += bytes; }, "");
  const std::size_t stream = writer.begin({"n", "t", "double64", {{"a", "", "", ""}}});
  for (const double time : {0.0, 1.0, 6.0, 1e7, 1e7 + 6.0}) {
    writer.advance(time);
    writer.add(stream, time, std::array{1.0});
  }
  writer.finish();
  EXPECT_LT(file.size(), 5000u);
  const XdfFile read = read_all_streams(file);
  EXPECT_THAT(read.notes, ElementsAre());
  EXPECT_THAT(read.streams.at(0).times, ElementsAre(0.0, 1.0, 6.0, 1e7, 1e7 + 6.0));
  std::vector<double> offsets;
  for (const XdfClockOffset& offset : read.streams.at(0).offsets) offsets.push_back(offset.time);
  EXPECT_THAT(offsets, ElementsAre(0.0, 6.0, 1e7, 1e7 + 6.0));
}

TEST(XdfMotion, AFileWithoutMotionIsRefusedWithItsStreams) {
  const std::string begun = recording_of_two_clocks().substr(0, 200);
  EXPECT_THAT(why_no_motion(begun), HasSubstr("found none; the file ends inside a chunk"));
  const std::string file =
      xdf::begin() + xdf::stream(3, "Amp", "EEG", "int16", 500.0, {{"Pz", ""}});
  EXPECT_THAT(why_no_motion(file),
              HasSubstr("x.xdf: expected a stream with the positions of head and hand; "
                        "found 'Amp' (EEG, 1 channel)"));
}

}  // namespace
}  // namespace headpin::devices
