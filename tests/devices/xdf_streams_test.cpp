// Streams of XDF as one table: which are read, what their columns are called, which one is the trigger.

#include <array>
#include <limits>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/recordings/xdf_motion.h"
#include "tests/devices/xdf_reading.h"
#include "tests/support/folder.h"
#include "tests/support/xdf_bytes.h"

namespace headpin::devices {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// The position of an object, and its heading: channels of LSL's types with one label.
xdf::Channels place_of(const std::string& object, const std::string& label = "c") {
  xdf::Channels channels;
  for (const char* type : {"PositionX", "PositionY", "PositionZ"}) {
    channels.push_back(
        {label, fmt::format("{}<type>{}</type>",
                            object.empty() ? "" : "<object>" + object + "</object>", type)});
  }
  return channels;
}

std::string three(double x, double y, double z) {
  return xdf::bytes(x) + xdf::bytes(y) + xdf::bytes(z);
}

/// Head and right hand as streams 1 and 2, with ten samples each; the hand's are half a step later.
std::string head_and_hand() {
  std::string file = xdf::begin() + xdf::stream(1, "A", "MoCap", "double64", 0.0, place_of("HMD")) +
                     xdf::stream(2, "B", "MoCap", "double64", 0.0, place_of("Right controller"));
  for (const std::uint32_t id : {1u, 2u}) {
    for (int i = 0; i < 10; ++i) {
      file += xdf::samples(id, 1, xdf::sample(1.0 + 0.01 * i + 0.005 * (id - 1.0), three(i, 1, 2)));
    }
  }
  return file + xdf::footer(1) + xdf::footer(2);
}

/// Markers as stream 3: the words of each sample.
std::string markers(const xdf::Channels& channels,
                    const std::vector<std::vector<std::string>>& samples) {
  std::string file = xdf::stream(3, "Task", "Markers", "string", 0.0, channels);
  double time = 1.0;
  for (const std::vector<std::string>& words : samples) {
    std::string values;
    for (const std::string& word : words) values += xdf::text(word);
    file += xdf::samples(3, 1, xdf::sample(time += 0.02, values));
  }
  return file + xdf::footer(3);
}

MotionTracks tracks_of(const std::string& file, const MotionOptions& options = {}) {
  return parse_xdf_motion(bytes_in(file), "x.xdf", options);
}

/// Notes but those on rotations, which these streams have not, and on words that are no motion.
std::vector<std::string> notes_of_streams(const std::string& file,
                                          const MotionOptions& options = {}) {
  std::vector<std::string> notes = tracks_of(file, options).notes;
  std::erase_if(notes, [](const std::string& note) {
    return note.ends_with("has no rotation") || note.starts_with("not understood: ");
  });
  return notes;
}

TableFindings findings_of(const std::string& file, const MotionOptions& options = {}) {
  return inspect_xdf(bytes_in(file), "x.xdf", options);
}

std::vector<std::string> columns_of(const std::string& file, const MotionOptions& options = {}) {
  std::vector<std::string> names;
  for (const auto& column : findings_of(file, options).columns) names.push_back(column.name);
  return names;
}

TEST(XdfStreams, AreOneTableInTheOrderOfTheirTimes) {
  const TableFindings found = findings_of(head_and_hand());
  EXPECT_EQ(found.kind, "XDF");
  EXPECT_TRUE(found.of_streams);
  EXPECT_EQ(found.rows, 20u);
  EXPECT_THAT(notes_of_streams(head_and_hand()), IsEmpty());
  const MotionTracks read = tracks_of(head_and_hand());
  ASSERT_EQ(read.tracks.size(), 2u);
  for (const auto& [name, track] : read.tracks) EXPECT_EQ(track.samples().size(), 10u) << name;
}

TEST(XdfStreams, OfOneNameAreCounted) {
  std::string file = xdf::begin();
  std::uint32_t id = 0;
  for (const std::string object : {"HMD", "Right controller", "Left controller"})
    file += xdf::stream(++id, "Vive", "MoCap", "double64", 0.0, place_of(object));
  EXPECT_THAT(columns_of(file),
              ElementsAre("time", "Vive HMD x", "Vive HMD y", "Vive HMD z",
                          "Vive 2 Right controller x", "Vive 2 Right controller y",
                          "Vive 2 Right controller z", "Vive 3 Left controller x",
                          "Vive 3 Left controller y", "Vive 3 Left controller z"));
}

TEST(XdfStreams, ColumnsAreCalledByWhatTheirHeaderSays) {
  xdf::Channels ball = place_of("", "Ball Centre");
  ball.push_back({"ball_centre_qa", "<type>OrientationA</type>"});
  EXPECT_THAT(
      columns_of(xdf::begin() + xdf::stream(1, "M", "MoCap", "double64", 0.0, ball) +
                 xdf::stream(2, "N", "MoCap", "double64", 0.0, place_of("", "")) +
                 xdf::stream(3, "Task", "Markers", "string", 0.0, {{"", ""}}) +
                 xdf::stream(4, "Log", "Markers", "string", 0.0, {{"", ""}, {"", ""}}) +
                 xdf::stream(5, "Answer", "Markers", "string", 0.0, {{"answer given", ""}})),
      ElementsAre("time", "M ball centre x", "M ball centre y", "M ball centre z",
                  "M ball centre qw", "N x", "N y", "N z", "Task", "Log channel 1", "Log channel 2",
                  "answer given"));
}

TEST(XdfStreams, WithoutAPositionOrAButtonAreIgnoredAndFiveOfThemNamed) {
  const auto last_note = [](std::uint32_t others) {
    std::string file = head_and_hand();
    for (std::uint32_t i = 0; i < others; ++i) {
      const std::uint32_t id = 10 + i;
      file += xdf::stream(id, fmt::format("S{}", i), "Force", "float32", 0.0,
                          {{"weight", ""}, {"x", ""}}) +
              xdf::footer(id);
    }
    const std::vector<std::string> notes = notes_of_streams(file);
    return notes.empty() ? "" : notes.back();
  };
  const std::string five =
      "streams without motion are ignored: 'S0' (Force, 2 channels), 'S1' (Force, 2 channels), "
      "'S2' (Force, 2 channels), 'S3' (Force, 2 channels), 'S4' (Force, 2 channels)";
  EXPECT_EQ(last_note(0), "");
  EXPECT_EQ(last_note(1), "streams without motion are ignored: 'S0' (Force, 2 channels)");
  EXPECT_EQ(last_note(5), five);
  EXPECT_EQ(last_note(7), five + " and 2 more");
}

TEST(XdfStreams, WithAButtonAreRead) {
  const std::string file =
      head_and_hand() +
      xdf::stream(3, "Pad", "Input", "int8", 0.0, {{"battery", ""}, {"trigger", ""}, {"hum", ""}});
  EXPECT_THAT(columns_of(file), testing::IsSupersetOf({"Pad battery", "Pad trigger", "Pad hum"}));
  // A channel "Trigger" of EEG is none of a hand.
  EXPECT_THAT(
      columns_of(head_and_hand() + xdf::stream(3, "Amp", "EEG", "int8", 0.0, {{"Trigger", ""}})),
      testing::Not(testing::Contains("Amp Trigger")));
}

TEST(XdfStreams, ThatTheUserNamesAreRead) {
  const std::string file =
      head_and_hand() + xdf::stream(3, "Force", "EMG", "int8", 0.0, {{"level", ""}}) +
      xdf::stream(4, "Eyes", "Gaze", "double64", 0.0, {{"x m", ""}, {"y m", ""}, {"z m", ""}}) +
      xdf::stream(5, "Eyes right", "Gaze", "double64", 0.0, {{"u", ""}}) +
      xdf::stream(6, "Far m", "Gaze", "double64", 0.0, {{"v m", ""}});
  // Those that are read beside head and hand.
  const auto read = [&](const MotionOptions& options) {
    std::vector<std::string> names = columns_of(file, options);
    names.erase(names.begin(), names.begin() + 7);
    return names;
  };
  EXPECT_THAT(read({}), IsEmpty());
  EXPECT_THAT(read({.columns = {{"right.trigger", "Force level"}}}), ElementsAre("Force level"));
  EXPECT_THAT(read({.columns = {{"trigger", "Force level"}}}), ElementsAre("Force level"));
  EXPECT_THAT(read({.columns = {{"trigger", "level"}}}), ElementsAre("Force level"));
  EXPECT_THAT(read({.columns = {{"left", "Eyes * m"}}}),
              ElementsAre("Eyes x m", "Eyes y m", "Eyes z m"));
  EXPECT_THAT(read({.names = {"", "Eyes ", ""}}),
              testing::IsSupersetOf({"Eyes x m", "Eyes y m", "Eyes z m"}));
}

TEST(XdfStreams, ASampleIsCalledByItsNumberInItsStream) {
  std::string file = xdf::begin() + xdf::stream(1, "A", "MoCap", "double64", 0.0, place_of("HMD")) +
                     xdf::stream(2, "B", "MoCap", "double64", 0.0, place_of("Right hand"));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (int i = 0; i < 10; ++i) {
    file += xdf::samples(1, 1, xdf::sample(1.0 + i, three(i, i == 2 ? nan : 1.0, 2))) +
            xdf::samples(2, 1, xdf::sample(1.0 + i, three(i, i == 5 ? nan : 1.0, 2)));
  }
  EXPECT_THAT(notes_of_streams(file + xdf::footer(1) + xdf::footer(2)),
              ElementsAre(HasSubstr("1 samples of the head have blank cells, no numbers or no "
                                    "rotation (the first in line 3)"),
                          HasSubstr("(the first in line 6)")));
}

TEST(XdfStreams, TheFirstChannelWithGrabAndReleaseIsTheTrigger) {
  const xdf::Channels one = {{"what", ""}}, two = {{"who", ""}, {"what", ""}};
  const auto told = [](const std::string& file) {
    return notes_of_streams(head_and_hand() + file);
  };
  EXPECT_THAT(told(markers(one, {{"cue"}, {"stop"}, {"cue"}})), IsEmpty());
  EXPECT_THAT(told(markers(one, {{"cue"}, {"grab"}, {"grab"}})), IsEmpty());
  EXPECT_THAT(told(markers(one, {{"release"}, {"cue"}})), IsEmpty());
  EXPECT_THAT(told(markers(one, {{"grab"}, {"release"}})),
              ElementsAre("grab and release are the markers 'Task what'"));
  const MotionTracks read =
      tracks_of(head_and_hand() +
                markers(two, {{"grab", "cue"}, {"me", "grab"}, {"me", "cue"}, {"me", "release"}}));
  EXPECT_THAT(read.notes, testing::Contains("grab and release are the markers 'Task what'"));
  ASSERT_EQ(read.triggers[1].size(), 2u);
  EXPECT_TRUE(read.triggers[1][0].value);
  EXPECT_FALSE(read.triggers[1][1].value);
}

TEST(XdfStreams, MarkersAreNoTriggerBesideAButtonOrATriggerThatIsTold) {
  const std::string marked = head_and_hand() + markers({{"what", ""}}, {{"grab"}, {"release"}});
  const auto notes = [&](const std::string& label, const MotionOptions& options) {
    std::string file = marked + xdf::stream(4, "Pad", "Input", "int8", 0.0, {{label, ""}});
    for (int i = 0; i < 10; ++i) {
      file += xdf::samples(
          4, 1, xdf::sample(1.0 + 0.01 * i, i > 3 && i < 7 ? "\x01" : std::string(1, '\0')));
    }
    return tracks_of(file + xdf::footer(4), options).notes;
  };
  const auto are_markers = HasSubstr("grab and release are the markers");
  EXPECT_THAT(notes("battery", {}), testing::Contains(are_markers));
  EXPECT_THAT(notes("trigger", {}), testing::Not(testing::Contains(are_markers)));
  EXPECT_THAT(notes("battery", {.columns = {{"trigger", "Pad battery"}}}),
              testing::Not(testing::Contains(are_markers)));
}

// A cell is one column of one sample, most of them empty: 6000 rows of 10004 columns.
TEST(XdfStreams, OfMoreThan60MillionCellsAreRefused) {
  std::string file = head_and_hand() +
                     xdf::chunk(2, xdf::bytes(std::uint32_t{3}) +
                                       "<info><name>Wide</name><channel_count>10000</channel_count>"
                                       "<channel_format>string</channel_format></info>") +
                     xdf::stream(4, "Task", "Markers", "string", 0.0, {{"a", ""}});
  std::string samples;
  for (int i = 0; i < 200; ++i) samples += xdf::sample(i, xdf::text("a"));
  for (int i = 0; i < 30; ++i) file += xdf::samples(4, 200, samples);
  EXPECT_EQ(complaint([&] { tracks_of(file); }),
            "x.xdf: 6020 samples in 10008 columns are too many; expected at most 60000000 cells");
}

}  // namespace
}  // namespace headpin::devices
