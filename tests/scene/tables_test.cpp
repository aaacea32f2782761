#include "scene/record/tables.h"

#include <bit>
#include <charconv>
#include <limits>
#include <map>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace headpin::scene {
namespace {

/// A row by the names of its columns.
using Row = std::map<std::string, std::string>;

/// Any CSV after RFC 4180.
std::vector<std::vector<std::string>> fields_of(const std::string& text) {
  std::vector<std::vector<std::string>> lines(1);
  std::string field;
  bool inside = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (inside) {
      const bool twice = c == '"' && i + 1 < text.size() && text[i + 1] == '"';
      if (c != '"' || twice) field += c;
      if (c == '"' && !twice) inside = false;
      i += twice;
    } else if (c == '"') {
      inside = true;
    } else if (c == ',' || c == '\n') {
      lines.back().push_back(std::exchange(field, {}));
      if (c == '\n') lines.emplace_back();
    } else {
      field += c;
    }
  }
  EXPECT_TRUE(field.empty() && lines.back().empty()) << "the last line does not end";
  lines.pop_back();
  return lines;
}

std::int64_t write_table(std::ostream& out, const std::string& name, const Trial& trial) {
  TableWriter writer(out, name, trial.header);
  for (const devices::Sample& sample : trial.samples) writer.add(sample);
  for (const Event& event : trial.events) writer.add(event);
  for (const TickState& state : trial.states) writer.add(state);
  for (const FrameRecord& frame : trial.frames) writer.add(frame);
  return writer.rows();
}

std::vector<Row> table(const std::string& name, const Trial& trial) {
  std::ostringstream out;
  const std::int64_t count = write_table(out, name, trial);
  const auto lines = fields_of(out.str());
  std::vector<Row> rows;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    EXPECT_EQ(lines[i].size(), lines[0].size());
    for (std::size_t k = 0; k < lines[i].size(); ++k) {
      if (k == 0) rows.emplace_back();
      EXPECT_TRUE(rows.back().emplace(lines[0][k], lines[i][k]).second) << "twice: " << lines[0][k];
    }
  }
  EXPECT_EQ(count, static_cast<std::int64_t>(rows.size()));
  return rows;
}

template <typename T>
T number(const std::string& text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  EXPECT_TRUE(error == std::errc{} && end == text.data() + text.size()) << text;
  return value;
}

Time time(const std::string& text) {
  return Time{std::llround(number<double>(text) * 1e6)};
}

void expect_bits(double found, double expected) {
  EXPECT_EQ(std::bit_cast<std::uint64_t>(found), std::bit_cast<std::uint64_t>(expected))
      << found << " " << expected;
}

void expect_vector(const Row& row, const std::vector<std::string>& names, const Vec3& expected) {
  for (int i = 0; i < 3; ++i) {
    expect_bits(number<double>(row.at(names[static_cast<std::size_t>(i)])), expected[i]);
  }
}

void expect_pose(const Row& row, const Pose& expected) {
  expect_vector(row, {"x_m", "y_m", "z_m"}, expected.p);
  expect_bits(number<double>(row.at("qw")), expected.q.w());
  expect_vector(row, {"qx", "qy", "qz"}, expected.q.vec());
}

/// One of each, with numbers that a careless writer would lose.
Trial odd_trial() {
  const double third = 1.0 / 3.0, tiny = std::numeric_limits<double>::denorm_min();
  const double large = std::numeric_limits<double>::max();
  const Pose pose{Quat(0.1, -0.0, third, std::sqrt(0.5)), Vec3(-0.0, tiny, -large)};
  Trial trial;
  trial.header.body_names = {"ball, heavy", "skittle \"1\""};
  devices::TrackerSample tracker;
  tracker.device_time = Time{1'000'001};
  tracker.host_time = Time{1'007'831};
  tracker.sequence = 41;
  tracker.station = 2;
  tracker.X_TS = pose;
  tracker.status = ',';
  tracker.buttons = 1;
  tracker.sent_time = Time{1'000'333};
  tracker.position_estimated = true;
  devices::MouseSample mouse;
  mouse.device_time = Time{-3};
  mouse.right_thumb = mouse.trigger = true;
  trial.samples = {tracker, mouse, devices::TrackerSample{}};
  Event event;
  event.time = Time{4'166};
  event.tick = -1;
  event.kind = "touch";
  event.bodies = {"ball", "skittle 3"};
  event.p_W = Vec3(0.1, 0.2, third);
  event.j_W = Vec3(tiny, -third, large);
  event.value = 0.1 + 0.2;
  event.detail = "{\"a\": 1,\n\"b\": 2}";
  trial.events = {event};
  TickState state;
  state.time = Time{12'500};
  state.tick = 3;
  state.hash = 0x00ab'cdef'0123'4567;
  state.contacts = 17;
  state.bodies = {{pose, {Vec3(third, tiny, 0.0), Vec3(-third, 1e300, -0.0)}, true}, {}};
  trial.states = {state};
  FrameRecord frame;
  frame.time = Time{16'667};
  frame.frame = 1;
  frame.tick = 4;
  frame.X_WE = {pose, Pose{}};
  frame.hash = {7, 0xffff'ffff'ffff'ffff};
  trial.frames = {frame};
  return trial;
}

TEST(Tables, SamplesReadBackToTheBit) {
  const Trial trial = odd_trial();
  const std::vector<Row> trackers = table("trackers", trial), buttons = table("buttons", trial);
  ASSERT_EQ(trackers.size(), 2u);
  ASSERT_EQ(buttons.size(), 1u);
  const auto& expected = std::get<devices::TrackerSample>(trial.samples[0]);
  const Row& row = trackers[0];
  EXPECT_EQ(time(row.at("device_time_s")), expected.device_time);
  EXPECT_EQ(time(row.at("host_time_s")), expected.host_time);
  EXPECT_EQ(number<std::int64_t>(row.at("sequence")), expected.sequence);
  EXPECT_EQ(number<std::int32_t>(row.at("station")), expected.station);
  EXPECT_EQ(row.at("frame"), expected.frame);
  expect_pose(row, expected.X_TS);
  EXPECT_EQ(row.at("status"), std::string(1, expected.status));
  EXPECT_EQ(row.at("stylus"), "1");
  EXPECT_EQ(time(row.at("sent_time_s")), expected.sent_time);
  EXPECT_EQ(row.at("position_estimated"), "1");
  EXPECT_EQ(row.at("orientation_estimated"), "0");
  EXPECT_EQ(trackers[1].at("status"), "");
  Trial unset = trial;
  std::get<devices::TrackerSample>(unset.samples[0]).status = '\0';
  EXPECT_EQ(table("trackers", unset)[0].at("status"), "x");
  EXPECT_EQ(time(buttons[0].at("device_time_s")), Time{-3});
  EXPECT_EQ(buttons[0].at("left_thumb"), "0");
  EXPECT_EQ(buttons[0].at("right_thumb"), "1");
  EXPECT_EQ(buttons[0].at("trigger"), "1");
}

TEST(Tables, ATrackersRowTellsWhenItWasTakenInAndWhereTheWalkHadTheSpaceThen) {
  devices::TrackerSample sample;
  sample.device_time = Time{1'000'000};
  sample.session_time = Time{1'012'500};
  std::ostringstream out;
  TableWriter writer(out, "trackers", {}, [](Time time) -> std::optional<Vec3> {
    if (time < Time{1'000'000}) return std::nullopt;
    return Vec3(seconds(time), -0.1, 0.0);
  });
  writer.add(devices::Sample(sample));
  sample.device_time = sample.session_time = Time{};
  writer.add(devices::Sample(sample));
  const auto lines = fields_of(out.str());
  const std::vector<std::string> names(lines[0].end() - 4, lines[0].end());
  const auto end_of = [&](std::size_t i) {
    return std::vector<std::string>(lines[i].end() - 4, lines[i].end());
  };
  EXPECT_EQ(names,
            (std::vector<std::string>{"session_time_s", "walk_x_m", "walk_y_m", "walk_z_m"}));
  EXPECT_EQ(end_of(1), (std::vector<std::string>{"1.012500", "1.0125", "-0.1", "0"}));
  EXPECT_EQ(end_of(2), (std::vector<std::string>{"0.000000", "", "", ""}));
}

TEST(Tables, AThrowsRowIsEmptyWhereNothingIsKnown) {
  std::ostringstream out;
  TableWriter writer(out, "throws", {});
  ThrowRow row;
  row.body = "ball";
  row.release = Time{2'500'000};
  row.speed = 6.25;
  writer.add(row);
  row.version = "red";
  row.frame = 2, row.ball = 1;
  row.v_WB = Vec3(0.1, 6.2, -0.3);
  row.felled_by_ball = 7, row.felled_by_hand = 1, row.counted = 0, row.foul = true;
  writer.add(row);
  EXPECT_EQ(writer.rows(), 2);
  const auto lines = fields_of(out.str());
  const auto at = [&](std::size_t i, const char* name) {
    const auto found = std::ranges::find(lines[0], name);
    return lines[i].at(static_cast<std::size_t>(found - lines[0].begin()));
  };
  for (const char* name :
       {"version", "frame", "ball", "trigger_time_s", "vx_mps", "entry_time_s", "entry_angle_deg",
        "felled_by_ball", "felled_by_hand", "counted", "foul"}) {
    EXPECT_EQ(at(1, name), "") << name;
  }
  EXPECT_EQ(at(1, "release_time_s"), "2.500000");
  EXPECT_EQ(at(1, "speed_mps"), "6.25");
  EXPECT_EQ(at(2, "version"), "red");
  EXPECT_EQ(at(2, "frame"), "2");
  EXPECT_EQ(at(2, "vy_mps"), "6.2");
  EXPECT_EQ(at(2, "felled_by_ball"), "7");
  EXPECT_EQ(at(2, "counted"), "0");
  EXPECT_EQ(at(2, "foul"), "1");
}

TEST(Tables, EventsReadBackToTheBit) {
  const Trial trial = odd_trial();
  const Event& expected = trial.events[0];
  const std::vector<Row> rows = table("events", trial);
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(time(rows[0].at("time_s")), expected.time);
  EXPECT_EQ(number<std::int64_t>(rows[0].at("tick")), -1);
  EXPECT_EQ(rows[0].at("kind"), expected.kind);
  EXPECT_EQ(rows[0].at("bodies"), "ball;skittle 3");
  expect_vector(rows[0], {"x_m", "y_m", "z_m"}, expected.p_W);
  expect_vector(rows[0], {"impulse_x_ns", "impulse_y_ns", "impulse_z_ns"}, expected.j_W);
  expect_bits(number<double>(rows[0].at("value")), expected.value);
  EXPECT_EQ(rows[0].at("detail"), expected.detail.text());
}

TEST(Tables, StatesAndFramesReadBackToTheBit) {
  const Trial trial = odd_trial();
  const std::vector<Row> states = table("states", trial), frames = table("frames", trial);
  ASSERT_EQ(states.size(), 2u);  // a body a row
  ASSERT_EQ(frames.size(), 2u);  // an eye a row
  for (std::size_t i = 0; i < 2; ++i) {
    const BodyState& body = trial.states[0].bodies[i];
    EXPECT_EQ(states[i].at("body"), trial.header.body_names[i]);
    EXPECT_EQ(number<std::int64_t>(states[i].at("tick")), 3);
    EXPECT_EQ(time(states[i].at("time_s")), trial.states[0].time);
    EXPECT_EQ(states[i].at("hash"), "00abcdef01234567");
    EXPECT_EQ(states[i].at("contacts"), "17");
    expect_pose(states[i], body.X_WB);
    expect_vector(states[i], {"vx_mps", "vy_mps", "vz_mps"}, body.V_WB.v);
    expect_vector(states[i], {"wx_radps", "wy_radps", "wz_radps"}, body.V_WB.w);
    EXPECT_EQ(states[i].at("asleep"), body.asleep ? "1" : "0");
    EXPECT_EQ(frames[i].at("eye"), i == 0 ? "left" : "right");
    EXPECT_EQ(number<std::int64_t>(frames[i].at("frame")), 1);
    EXPECT_EQ(number<std::int64_t>(frames[i].at("tick")), 4);
    EXPECT_EQ(time(frames[i].at("time_s")), trial.frames[0].time);
    expect_pose(frames[i], trial.frames[0].X_WE[i]);
  }
  EXPECT_EQ(frames[1].at("pixels"), "ffffffffffffffff");
}

TEST(Tables, TheDictionaryTellsOfEveryColumn) {
  const Trial trial = odd_trial();
  std::ostringstream out;
  write_dictionary(out);
  const auto dictionary = fields_of(out.str());
  std::size_t told = 1;
  for (const std::string& name : table_names()) {
    std::ostringstream csv;
    write_table(csv, name, trial);
    const std::vector<std::string> columns = fields_of(csv.str())[0];
    for (const std::string& column : columns) {
      ASSERT_LT(told, dictionary.size());
      EXPECT_EQ(dictionary[told][0], name);
      EXPECT_EQ(dictionary[told][1], column);
      EXPECT_FALSE(dictionary[told][4].empty()) << column;
      ++told;
    }
  }
  EXPECT_EQ(told, dictionary.size());
  std::ostringstream none;
  EXPECT_THROW(write_table(none, "bodies", trial), std::invalid_argument);
}

}  // namespace
}  // namespace headpin::scene
