#include "devices/trial/log.h"

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lcm/lcm.h>
#include <sys/resource.h>

#include "devices/base/version.h"
#include "devices/trial/event_log.h"
#include "devices/trial/file.h"
#include "devices/trial/messages.h"
#include "devices/trial/sources.h"
#include "tests/support/folder.h"

namespace headpin::devices {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// A folder of this process's own, empty.
Buffer read_bytes(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return Buffer(std::istreambuf_iterator<char>(file), {});
}

void write_bytes(const fs::path& path, std::span<const std::uint8_t> bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
}

TrackerSample tracker(int i) {
  TrackerSample sample;
  sample.device_time = Time{8333 * i};
  sample.sequence = i / 2;
  sample.station = 1 + i % 2;
  sample.X_TS = {rotation(Vec3(0.1 * i, 0.2, -0.3)), Vec3(0.01 * i, -1.0 / 3.0, 1e-9)};
  sample.status = i == 3 ? 'W' : ' ';
  sample.buttons = static_cast<std::uint8_t>(i & 1);
  return sample;
}

TickState state(int tick) {
  TickState state{
      tick_time(tick, 240), tick, 0xfedcba9876543210u + static_cast<unsigned>(tick), tick % 3, {}};
  for (int b = 0; b < 3; ++b) {
    state.bodies.push_back({{rotation(Vec3(0.1 * b, 0.0, 0.0)), Vec3(b, 0.25, 0.125)},
                            {Vec3(0.0, 7.5, -0.1), Vec3(b, 1.0, 2.0)},
                            b == 1});
  }
  return state;
}

TrialHeader header() {
  TrialHeader h;
  h.participant = "P07";
  h.condition = "e=0.7 f=0.7";
  h.seed = 0xffffffffffffffffu;
  h.scenario = "[ball]\nmass = 7.0  # \xc3\xa4\n";
  h.body_names = {"ball", "skittle_1", "skittle_2"};
  return h;
}

Event event() {
  Event e{Time{5000},
          1,
          "first_contact",
          {"ball", "skittle_1"},
          Vec3(0.1, 5.0, 0.15),
          Vec3(0.0, -3.0, 0.5),
          6.5,
          ""};
  return e;
}

/// A short trial with some of everything: the header, then 12 samples, a button, an event, 6
/// states, a frame.
void record(const fs::path& path, Recorder::Options options = {}) {
  Recorder recorder(path, header(), options);
  for (int i = 0; i < 12; ++i) {
    recorder.write(Sample(tracker(i)));
    if (i % 2 == 0) recorder.write(state(i / 2));
  }
  recorder.write(Sample(MouseSample{Time{100'000}, Time{}, false, true, true}));
  recorder.write(event());
  recorder.write(FrameRecord{Time{16'666}, 1, 4, {tracker(1).X_TS, tracker(2).X_TS}, {7u, ~0ull}});
  recorder.close();
}
constexpr int kMessages = 1 + 12 + 6 + 1 + 1 + 1;

Buffer recorded() {
  const fs::path path = fresh_folder("log") / "trial.lcmlog";
  record(path);
  return read_bytes(path);
}

bool same(const Pose& a, const Pose& b) {
  return a.q.coeffs() == b.q.coeffs() && a.p == b.p;
}

TEST(LogTest, WhatWasWrittenIsReadBackToTheLastBit) {
  const fs::path path = fresh_folder("log") / "trial.lcmlog";
  record(path);
  const Trial trial = read_trial(path);

  EXPECT_TRUE(trial.complete);
  EXPECT_TRUE(trial.skipped.nothing());
  EXPECT_EQ(trial.header.participant, "P07");
  EXPECT_EQ(trial.header.condition, "e=0.7 f=0.7");
  EXPECT_EQ(trial.header.seed, 0xffffffffffffffffu);
  EXPECT_EQ(trial.header.scenario, header().scenario);
  EXPECT_EQ(trial.header.body_names, header().body_names);

  ASSERT_EQ(trial.samples.size(), 13u);
  for (int i = 0; i < 12; ++i) {
    const auto& read = std::get<TrackerSample>(trial.samples[static_cast<std::size_t>(i)]);
    const TrackerSample written = tracker(i);
    EXPECT_EQ(read.device_time, written.device_time);
    EXPECT_EQ(read.host_time, written.host_time);
    EXPECT_EQ(read.sequence, written.sequence);
    EXPECT_EQ(read.station, written.station);
    EXPECT_TRUE(same(read.X_TS, written.X_TS));
    EXPECT_EQ(read.status, written.status);
    EXPECT_EQ(read.buttons, written.buttons);
    EXPECT_EQ(read.frame, written.frame);
  }
  const auto& mouse = std::get<MouseSample>(trial.samples.back());
  EXPECT_FALSE(mouse.left_thumb);
  EXPECT_TRUE(mouse.right_thumb);
  EXPECT_TRUE(mouse.trigger);

  ASSERT_EQ(trial.events.size(), 1u);
  EXPECT_EQ(trial.events[0].kind, event().kind);
  EXPECT_EQ(trial.events[0].bodies, event().bodies);
  EXPECT_EQ(trial.events[0].p_W, event().p_W);
  EXPECT_EQ(trial.events[0].j_W, event().j_W);
  EXPECT_EQ(trial.events[0].value, event().value);

  ASSERT_EQ(trial.states.size(), 6u);
  for (int i = 0; i < 6; ++i) {
    const TickState& read = trial.states[static_cast<std::size_t>(i)];
    const TickState written = state(i);
    EXPECT_EQ(read.time, written.time);
    EXPECT_EQ(read.tick, written.tick);
    EXPECT_EQ(read.hash, written.hash);
    EXPECT_EQ(read.contacts, written.contacts);
    ASSERT_EQ(read.bodies.size(), 3u);
    for (std::size_t b = 0; b < 3; ++b) {
      EXPECT_TRUE(same(read.bodies[b].X_WB, written.bodies[b].X_WB));
      EXPECT_EQ(read.bodies[b].V_WB.v, written.bodies[b].V_WB.v);
      EXPECT_EQ(read.bodies[b].V_WB.w, written.bodies[b].V_WB.w);
      EXPECT_EQ(read.bodies[b].asleep, written.bodies[b].asleep);
    }
  }
  ASSERT_EQ(trial.frames.size(), 1u);
  EXPECT_EQ(trial.frames[0].frame, 1);
  EXPECT_EQ(trial.frames[0].tick, 4);
  EXPECT_TRUE(same(trial.frames[0].X_WE[1], tracker(2).X_TS));
  EXPECT_EQ(trial.frames[0].hash[1], ~0ull);
}

TEST(LogTest, SaysWhichSoftwareWroteItAndHowToReadIt) {
  const fs::path path = fresh_folder("log") / "trial.lcmlog";
  record(path);
  const TrialHeader read = read_trial(path).header;
  EXPECT_EQ(read.format_version, kFormatVersion);
  EXPECT_EQ(read.software_version, software_version());
  EXPECT_FALSE(read.software_version.empty());
  for (const fs::directory_entry& type :
       fs::directory_iterator(HEADPIN_SOURCE_DIR "/devices/lcm/types")) {
    const Buffer text = read_bytes(type.path());
    EXPECT_THAT(read.schema, HasSubstr(std::string(text.begin(), text.end()))) << type.path();
  }
}

TEST(LogTest, LiblcmReadsTheSameEvents) {
  const fs::path path = fresh_folder("log") / "trial.lcmlog";
  record(path);
  const Buffer bytes = read_bytes(path);
  LogReader ours(bytes);
  lcm_eventlog_t* theirs = lcm_eventlog_create(path.c_str(), "r");
  ASSERT_NE(theirs, nullptr);
  int events = 0;
  while (lcm_eventlog_event_t* expected = lcm_eventlog_read_next_event(theirs)) {
    const std::optional<LogEvent> found = ours.next();
    ASSERT_TRUE(found.has_value());
    EXPECT_EQ(found->number, expected->eventnum);
    EXPECT_EQ(found->time.count(), expected->timestamp);
    EXPECT_EQ(found->channel, expected->channel);
    const auto* data = static_cast<const std::uint8_t*>(expected->data);
    EXPECT_TRUE(std::ranges::equal(found->data, std::span(data, data + expected->datalen)));
    lcm_eventlog_free_event(expected);
    ++events;
  }
  lcm_eventlog_destroy(theirs);
  EXPECT_EQ(events, kMessages + 1);  // and the end event
  EXPECT_FALSE(ours.next().has_value());
}

TEST(LogTest, HeaderStampsNeverRunBackAndFollowTheMessages) {
  const Buffer bytes = recorded();
  LogReader reader(bytes);
  Time last{};
  while (const auto event = reader.next()) {
    EXPECT_GE(event->time, last);
    last = event->time;
  }
  EXPECT_EQ(last, Time{100'000});  // the button, the latest of all
}

// liblcm reads names of up to 999 bytes; a longer one is damage.
TEST(LogTest, ANameOfAChannelHas999BytesAtMost) {
  for (const std::size_t size : {std::size_t{999}, std::size_t{1000}}) {
    const std::string name(size, 'n');
    Buffer bytes;
    append({1, Time{1}, name, {}}, bytes);
    append({2, Time{2}, "after", {}}, bytes);
    LogReader reader(bytes);
    const auto first = reader.next();
    ASSERT_TRUE(first);
    EXPECT_EQ(first->channel, size == 999 ? name : "after");
    EXPECT_EQ(reader.skipped_bytes(), size == 999 ? 0 : 1028);
  }
}

TEST(LogTest, CutOffAnywhereItIsGoodUpToTheCut) {
  const Buffer bytes = recorded();
  std::vector<std::size_t> ends;  // of each event in the file
  LogReader reader(bytes);
  while (const auto event = reader.next()) {
    ends.push_back(static_cast<std::size_t>(event->data.data() - bytes.data()) +
                   event->data.size());
  }
  ASSERT_EQ(ends.back(), bytes.size());
  for (std::size_t cut = 0; cut < bytes.size(); ++cut) {
    const Trial trial = read_log(std::span(bytes).first(cut));
    std::int64_t messages = 0;
    for (const auto& [name, channel] : trial.channels) messages += channel.messages;
    const auto whole = std::ranges::upper_bound(ends, cut) - ends.begin();
    ASSERT_EQ(messages, whole) << "cut at " << cut;
    ASSERT_FALSE(trial.complete) << "cut at " << cut;
    const std::size_t end = whole == 0 ? 0 : ends[static_cast<std::size_t>(whole - 1)];
    ASSERT_EQ(trial.skipped.cut_bytes, static_cast<std::int64_t>(cut - end)) << "cut at " << cut;
    ASSERT_EQ(trial.skipped.bytes, 0) << "cut at " << cut;
  }
}

TEST(LogTest, AFlippedByteCostsAtMostTwoMessages) {
  const Buffer good = recorded();
  std::mt19937 random(1);
  for (int n = 0; n < 3000; ++n) {
    Buffer bytes = good;
    const std::size_t at = random() % bytes.size();
    bytes[at] = static_cast<std::uint8_t>(bytes[at] ^ (1u + random() % 255u));
    const Trial trial = read_log(bytes);
    const std::size_t read = trial.has_header + trial.samples.size() + trial.states.size() +
                             trial.events.size() + trial.frames.size();
    // The one it is in; and the next, when a length now reaches into it.
    ASSERT_GE(read + 2, static_cast<std::size_t>(kMessages)) << "byte " << at;
  }
}

TEST(LogTest, RandomBytesNeverHurt) {
  std::mt19937 random(2);
  const Buffer good = recorded();
  for (int n = 0; n < 2000; ++n) {
    Buffer bytes = good;
    const std::size_t from = random() % bytes.size();
    const std::size_t size = std::min<std::size_t>(bytes.size() - from, random() % 200);
    for (std::size_t i = 0; i < size; ++i) {
      bytes[from + i] = static_cast<std::uint8_t>(random());
    }
    const Trial trial = read_log(bytes);
    ASSERT_LE(trial.samples.size(), 13u);
  }
}

TEST(LogTest, GarbageBetweenEventsLosesNoneOfThem) {
  const Buffer good = recorded();
  LogReader reader(good);
  Buffer bytes;
  std::mt19937 random(3);
  std::int64_t garbage = 0;
  std::size_t from = 0;
  while (const auto event = reader.next()) {
    const auto end =
        static_cast<std::size_t>(event->data.data() - good.data()) + event->data.size();
    bytes.insert(bytes.end(), good.begin() + static_cast<std::ptrdiff_t>(from),
                 good.begin() + static_cast<std::ptrdiff_t>(end));
    from = end;
    for (auto i = 4 + random() % 40; i > 0; --i, ++garbage) {
      bytes.push_back(static_cast<std::uint8_t>(random() % 0xED));  // never begins a magic word
    }
  }
  const Trial trial = read_log(bytes);
  EXPECT_TRUE(trial.complete);
  EXPECT_EQ(trial.samples.size(), 13u);
  EXPECT_EQ(trial.skipped.bytes, garbage);
}

/// Where the field of 4 bytes at `offset` of the header of the `n`th event stands.
std::size_t header_field(const Buffer& bytes, int n, std::size_t offset) {
  LogReader reader(bytes);
  std::size_t start = 0;
  for (int i = 0; i <= n; ++i) {
    const auto event = reader.next();
    start =
        static_cast<std::size_t>(event->data.data() - bytes.data()) - event->channel.size() - 28;
  }
  return start + offset;
}

void put_int32(Buffer& bytes, std::size_t at, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i) {
    bytes[at + i] = static_cast<std::uint8_t>(value >> (24 - 8 * i));
  }
}

TEST(LogTest, SizesThatLieCostOnlyTheirOwnEvent) {
  for (const std::size_t field : {std::size_t{20}, std::size_t{24}}) {
    for (const std::uint32_t lie : {0u, 1u, 300u, 2000u, 1000000u, 0x7fffffffu, 0x80000000u, ~0u}) {
      Buffer bytes = recorded();
      put_int32(bytes, header_field(bytes, 5, field), lie);
      const Trial trial = read_log(bytes);
      EXPECT_FALSE(trial.complete);
      EXPECT_EQ(trial.samples.size() + trial.states.size(), 13u + 6u - 1u)
          << "field " << field << " says " << lie;
    }
  }
}

/// A log of one event.
Buffer one_event(const std::string& channel, const Buffer& data) {
  Buffer bytes(28 + channel.size() + data.size());
  put_int32(bytes, 0, 0xEDA1DA01u);
  put_int32(bytes, 20, static_cast<std::uint32_t>(channel.size()));
  put_int32(bytes, 24, static_cast<std::uint32_t>(data.size()));
  const auto rest = std::ranges::copy(channel, bytes.begin() + 28).out;
  std::ranges::copy(data, rest);
  return bytes;
}

// Any two stamps may be subtracted.
TEST(LogTest, AStampThatIsNoTimeIsTakenForTheFarthestOne) {
  const fs::path path = fresh_folder("log") / "stamp.lcmlog";
  {
    Recorder recorder(path, header());
    for (int i = 0; i < 20; ++i) recorder.write(tracker(i));
    recorder.close();
  }
  Buffer bytes = read_bytes(path);
  std::size_t at = 0;
  for (int i = 0; i < 10; ++i) {
    at = 28 + at + (static_cast<std::size_t>(bytes[at + 22]) << 8 | bytes[at + 23]) +
         (static_cast<std::size_t>(bytes[at + 26]) << 8 | bytes[at + 27]);
  }
  bytes[at + 12] ^= 0x80;  // the highest bit of the stamp
  write_bytes(path, bytes);
  LogReader reader(bytes);
  Time least{};
  while (const auto event = reader.next()) least = std::min(least, event->time);
  EXPECT_LT(least, Time{0});
  EXPECT_GT(least, Time{std::numeric_limits<std::int64_t>::min() / 1000});
  EXPECT_EQ(read_trial(path).samples.size(), 19u);  // it is misdated
}

TEST(LogTest, ListsThatClaimMoreThanThereIsAreRefusedUnread) {
  Buffer data;
  encode(state(1), data);
  const std::size_t count = 8 + 3 * 8 + 4;  // fingerprint, three stamps, contacts
  for (const std::uint32_t lie : {0u, 2u, 4u, 0x7fffffffu, 0x80000000u, ~0u}) {
    Buffer bytes = data;
    put_int32(bytes, count, lie);
    const Trial trial = read_log(one_event("STATE", bytes));
    EXPECT_EQ(trial.skipped.undecodable, 1) << lie;
    EXPECT_TRUE(trial.states.empty());
  }
}

TEST(LogTest, StringsThatClaimMoreThanThereIsAreRefusedUnread) {
  Buffer data;
  encode(event(), data);
  const std::size_t length = 8 + 2 * 8;  // fingerprint, two stamps, then the kind
  for (const std::uint32_t lie : {0u, 1u, 5u, 0x7fffffffu, 0x80000000u, ~0u}) {
    Buffer bytes = data;
    put_int32(bytes, length, lie);
    EXPECT_EQ(read_log(one_event("EVENT", bytes)).skipped.undecodable, 1) << lie;
  }
}

TEST(LogTest, AWrongFingerprintIsPassedOverAndCounted) {
  Buffer data;
  encode(tracker(1), data);
  data[3] ^= 1;
  EXPECT_EQ(read_log(one_event("TRACKER", data)).skipped.undecodable, 1);
  encode(tracker(1), data);
  EXPECT_EQ(read_log(one_event("MOUSE3D", data)).skipped.undecodable, 1);
}

TEST(LogTest, NumbersThatCannotBeArePassedOverAndCounted) {
  const auto implausible = [](TrackerSample sample) {
    Buffer data;
    encode(sample, data);
    return read_log(one_event("TRACKER", data)).skipped.implausible;
  };
  EXPECT_EQ(implausible(tracker(1)), 0);
  TrackerSample sample = tracker(1);
  sample.X_TS.p.y() = std::nan("");
  EXPECT_EQ(implausible(sample), 1);
  sample = tracker(1);
  sample.X_TS.p.x() = -1.1e8;
  EXPECT_EQ(implausible(sample), 1);
  sample.X_TS.p.x() = -6e6;
  EXPECT_EQ(implausible(sample), 0);
  sample = tracker(1);
  sample.X_TS.q.coeffs() *= 1.01;
  EXPECT_EQ(implausible(sample), 1);
  sample = tracker(1);
  sample.device_time = Time::min();
  EXPECT_EQ(implausible(sample), 1);
}

TEST(LogTest, ForeignChannelsAreListedAndLeaveTheTrialWhole) {
  Buffer bytes = recorded();
  const Buffer foreign = one_event("LIDAR", {1, 2, 3});
  bytes.insert(bytes.end(), foreign.begin(), foreign.end());
  const Trial trial = read_log(bytes);
  EXPECT_TRUE(trial.complete);
  EXPECT_TRUE(trial.skipped.nothing());
  EXPECT_EQ(trial.channels.at("LIDAR").messages, 1);
  EXPECT_EQ(trial.channels.at("LIDAR").bytes, 3);
}

TEST(LogTest, AChannelHasTheStampsOfItsFirstAndItsLastMessage) {
  const Trial trial = read_log(recorded());
  const Channel& channel = trial.channels.at("TRACKER");
  ASSERT_GT(channel.messages, 1);
  EXPECT_LT(channel.first, channel.last);
}

TEST(LogTest, ATrialLastsUntilItsLastFrame) {
  const std::string path = fresh_folder("frames") / "a.lcmlog";
  Recorder recorder(path, {});
  TickState state;
  state.time = Time{1'000'000};
  state.tick = 240;
  state.bodies.resize(1);
  recorder.write(state);
  FrameRecord frame;
  frame.time = Time{1'010'000};
  frame.tick = 240;
  recorder.write(frame);
  recorder.close();
  const TrialFile trial(path);
  EXPECT_EQ(trial.summary().first, Time{1'000'000});
  EXPECT_EQ(trial.summary().last, Time{1'010'000});
}

TEST(LogTest, AMessageLostOnTheWayMakesItIncomplete) {
  Buffer bytes = recorded();
  const std::size_t from = header_field(bytes, 4, 0), to = header_field(bytes, 5, 0);
  bytes.erase(bytes.begin() + static_cast<std::ptrdiff_t>(from),
              bytes.begin() + static_cast<std::ptrdiff_t>(to));
  const Trial trial = read_log(bytes);
  EXPECT_TRUE(trial.skipped.nothing());
  EXPECT_FALSE(trial.complete);
}

// As a logger gets it that begins to listen in the middle of a session.
TEST(LogTest, AHeaderThatIsRepeatedIsTheSameTrials) {
  const Buffer whole = recorded();
  const auto first = whole.begin() + static_cast<std::ptrdiff_t>(header_field(whole, 1, 0));
  const auto from = whole.begin() + static_cast<std::ptrdiff_t>(header_field(whole, 4, 0));
  const auto later = whole.begin() + static_cast<std::ptrdiff_t>(header_field(whole, 8, 0));
  Buffer bytes(from, later);
  for (int i = 0; i < 2; ++i) bytes.insert(bytes.end(), whole.begin(), first);
  bytes.insert(bytes.end(), later, whole.end());
  const Trial trial = read_log(bytes);
  EXPECT_TRUE(trial.has_header);
  EXPECT_EQ(trial.header.participant, header().participant);
  EXPECT_EQ(trial.skipped.other_trials, 0);
  const Trial all = read_log(whole);
  EXPECT_EQ(trial.samples.size() + trial.states.size(), all.samples.size() + all.states.size() - 3);
  EXPECT_EQ(trial.events.size(), all.events.size());
  EXPECT_FALSE(trial.complete);  // as it misses what came before
}

TEST(LogTest, ASecondTrialBehindTheFirstIsNotMixedIn) {
  Buffer bytes = recorded();
  const fs::path path = fresh_folder("log") / "other.lcmlog";
  TrialHeader other = header();
  other.participant = "P08";
  Recorder(path, other).close();
  const Buffer again = read_bytes(path);
  bytes.insert(bytes.end(), again.begin(), again.end());
  const Trial trial = read_log(bytes);
  EXPECT_TRUE(trial.complete);
  EXPECT_EQ(trial.samples.size(), 13u);
  EXPECT_EQ(trial.skipped.other_trials, 1);
}

TEST(LogTest, TimesThatRunBackAreCountedPerDevice) {
  const fs::path path = fresh_folder("log") / "trial.lcmlog";
  {
    Recorder recorder(path, header());
    TrackerSample head = tracker(0), hand = tracker(1);
    for (const int time : {1000, 2000, 1500, 3000, 3000}) {
      head.device_time = Time{time};
      recorder.write(Sample(head));
    }
    hand.device_time = Time{2500};  // behind the head's, but the first of its own
    recorder.write(Sample(hand));
    recorder.close();
  }
  const Trial trial = read_trial(path);
  EXPECT_EQ(trial.backwards, 2);
  EXPECT_EQ(trial.samples.size(), 6u);
  EXPECT_TRUE(trial.complete);
}

/// Two minutes of a head and a hand, with states between.
Buffer two_minutes() {
  const fs::path path = fresh_folder("log") / "trial.lcmlog";
  Recorder recorder(path, header());
  for (int i = 1; i <= 1200; ++i) {
    TrackerSample sample = tracker(i);
    sample.device_time = Time{100'000 * i};
    sample.host_time = sample.device_time + Time{5'000};
    recorder.write(Sample(sample));
    TickState at = state(24 * i);
    recorder.write(at);
  }
  recorder.close();
  return read_bytes(path);
}

// A flipped bit in a time, or in a tick, must not make a session last for years.
TEST(LogTest, ATimeThatThoseAroundItDoNotShareIsPassedOver) {
  const Buffer good = two_minutes();
  const Trial whole = read_log(good);
  ASSERT_TRUE(whole.skipped.nothing());
  ASSERT_LT(whole.longest_gap.length(), Time{200'000});
  std::mt19937 random(3);
  std::map<std::string_view, int> seen;
  LogReader reader(good);
  while (const auto event = reader.next()) {
    const bool sample = event->channel == kTrackerChannel;
    if ((!sample && event->channel != kStateChannel) || random() % 20 != 0) continue;
    // Behind the fingerprint: device and host time of a sample, time and tick of a state.
    Buffer bytes = good;
    const auto field =
        static_cast<std::size_t>(event->data.data() - good.data()) + 8 + 8 * (random() % 2);
    const auto bit = static_cast<unsigned>(20 + random() % 36);  // a second and more
    bytes[field + 7 - bit / 8] ^= static_cast<std::uint8_t>(1u << (bit % 8));
    const Trial trial = read_log(bytes);
    const std::int64_t lost = trial.skipped.misdated + trial.skipped.implausible;
    ASSERT_LE(lost, 1);
    ASSERT_LT(trial.longest_gap.length(), Time{1'300'000}) << event->channel << " bit " << bit;
    ASSERT_LT(trial.states.back().tick, 30'000) << "bit " << bit;
    for (const Sample& s : trial.samples) ASSERT_LT(available(s), Time{125'000'000}) << bit;
    ++seen[event->channel];
  }
  EXPECT_GT(seen[kTrackerChannel], 20);
  EXPECT_GT(seen[kStateChannel], 20);
}

// Two presses do not tell which of them has the wrong time, however far it is from the log's stamps.
TEST(LogTest, OneOfTwoPressesIsNeverPassedOver) {
  const fs::path path = fresh_folder("log") / "trial.lcmlog";
  Recorder recorder(path, header());
  for (int i = 1; i <= 100; ++i) {
    TrackerSample sample = tracker(i);
    sample.device_time = Time{100'000 * i};
    recorder.write(Sample(sample));
    const bool down = i == 20;
    if (down || i == 60) {
      recorder.write(Sample(MouseSample{.device_time = Time{2'000'000}, .trigger = down}));
    }
  }
  recorder.close();
  const Trial trial = read_trial(path);
  EXPECT_EQ(trial.skipped.misdated, 0);
  EXPECT_EQ(trial.devices.at(0).samples, 2);
}

TEST(LogTest, SaysWhichMessagesAreAmiss) {
  const fs::path path = fresh_folder("log") / "trial.lcmlog";
  Recorder recorder(path, header());
  for (int i = 1; i <= 200; ++i) {
    TrackerSample sample;
    sample.station = 2;
    sample.sequence = i < 50 ? i : i + 7;
    sample.device_time = Time{100'000 * i};
    if (i == 120 || i == 121) sample.frame = "lab";
    if (i == 150) sample.X_TS.p.x() = std::nan("");
    recorder.write(Sample(sample));
    if (i == 30) {
      recorder.write(TickState{Time{3'000'000}, 720, 0, 0, {}});
      sample.device_time = Time{2'950'000};  // behind the state, though it was there before
      sample.station = 3;
      recorder.write(Sample(sample));
      sample.device_time = Time{2'980'000};  // the rest of it came with the poll after: usual
      sample.station = 4;
      recorder.write(Sample(sample));
    }
  }
  recorder.close();
  const Trial trial = read_trial(path);
  std::vector<std::string> found;
  for (const Trouble& t : trial.trouble) {
    found.push_back(t.kind + " " + t.device + " " + std::to_string(t.messages) + " " +
                    std::to_string(t.from.count()) + " " + std::to_string(t.to.count()));
  }
  // A sample that was passed over is missing from its device's count as well.
  EXPECT_THAT(
      found, testing::ElementsAre(
                 "late left hand 1 3000000 3000000", "lost right hand 7 5000000 5000000",
                 "foreign right hand 2 12000000 12100000", "lost right hand 2 12200000 12200000",
                 "implausible TRACKER 1 15000000 15000000", "lost right hand 1 15100000 15100000"));
}

TEST(LogTest, ASessionThatPublishedItselfIsTheTrialAndWhatItHeardIsNot) {
  Buffer bytes = recorded(), told;
  const auto add = [&](const std::string& channel, const auto& message) {
    Buffer data;
    encode(message, data);
    const Buffer event = one_event(channel, data);
    told.insert(told.end(), event.begin(), event.end());
  };
  TrialHeader own = stamped(header());
  own.participant = "own";
  add("SESSION_HEADPIN_TRIAL", own);
  add("TRACKER", tracker(1));
  add("SESSION_TRACKER", tracker(2));
  add("HEADPIN_TRIAL", stamped(header()));
  add("SESSION_HEADPIN_TRIAL", own);
  add("SESSION_STATE", state(1));
  Event end = event();
  end.kind = kEndEvent;
  end.value = 3.0;
  add("SESSION_EVENT", end);
  bytes.insert(bytes.end(), told.begin(), told.end());
  const Trial trial = read_log(bytes);
  EXPECT_EQ(trial.header.participant, "own");
  EXPECT_EQ(trial.samples.size(), 1u);
  EXPECT_EQ(trial.states.size(), 1u);
  EXPECT_TRUE(trial.complete);
  EXPECT_TRUE(trial.skipped.nothing());
  EXPECT_EQ(trial.channels.at("TRACKER").messages, 13);
}

/// A trial whose samples stand in the log up to half a second out of order, states and frames too.
fs::path out_of_order(std::mt19937& random) {
  const fs::path path = fresh_folder("log") / "trial.lcmlog";
  Recorder recorder(path, header());
  for (int i = 1; i <= 2000; ++i) {
    TrackerSample sample = tracker(i);
    const auto jitter = static_cast<std::int64_t>(random() % 500) * 1000;
    sample.host_time = sample.device_time + Time{jitter};
    recorder.write(Sample(sample));
    if (i > 1000 && i % 2 == 0) recorder.write(state(i));
    if (i > 1500 && i % 8 == 0) {
      recorder.write(FrameRecord{tick_time(i, 240), i / 8, i, {}, {1u, 2u}});
    }
  }
  recorder.close();
  return path;
}

TEST(TrialPlayerTest, HandsOutWhatAReplayOfTheWholeTrialDoes) {
  std::mt19937 random(7);
  for (int n = 0; n < 5; ++n) {
    const fs::path path = out_of_order(random);
    const TrialFile file(path);
    const Trial trial = read_log(path);
    EXPECT_GT(trial.disorder, Time{});
    TrialPlayer player(file, {.states = true, .frames = true});
    ReplaySource replay(trial.samples);
    auto state = trial.states.begin();
    auto frame = trial.frames.begin();
    for (std::int64_t tick = 1; !replay.exhausted(); ++tick) {
      std::vector<Sample> all, some;
      replay.poll(tick_time(tick, 240), all);
      player.poll(tick_time(tick, 240), some);
      ASSERT_EQ(some.size(), all.size()) << tick;
      for (std::size_t i = 0; i < all.size(); ++i) {
        const auto &a = std::get<TrackerSample>(all[i]), &b = std::get<TrackerSample>(some[i]);
        ASSERT_TRUE(a.device_time == b.device_time && a.session_time == b.session_time);
      }
      const TickState* recorded = player.state(tick);
      while (state != trial.states.end() && state->tick < tick) ++state;
      const bool there = state != trial.states.end() && state->tick == tick;
      ASSERT_EQ(recorded != nullptr, there) << tick;
      if (there) {
        ASSERT_EQ(recorded->hash, state->hash);
      }
      const FrameRecord* seen = player.frame(tick);
      while (frame != trial.frames.end() && frame->tick < tick) ++frame;
      ASSERT_EQ(seen != nullptr, frame != trial.frames.end() && frame->tick == tick) << tick;
    }
    EXPECT_TRUE(player.exhausted());
    // The longest gap is that of the samples in order.
    std::vector<Time> times;
    for (const Sample& sample : trial.samples) times.push_back(available(sample));
    std::ranges::sort(times);
    Time longest = times.front();
    for (std::size_t i = 1; i < times.size(); ++i) {
      longest = std::max(longest, times[i] - times[i - 1]);
    }
    EXPECT_EQ(trial.longest_gap.length(), longest);
  }
}

TEST(TrialPlayerTest, AFileThatIsCutWhileItIsReadIsSaid) {
  const fs::path path = fresh_folder("log") / "trial.lcmlog";
  Buffer bytes = two_minutes();
  const Buffer padding = one_event("LIDAR", Buffer(4'000'000));  // more than is read ahead
  bytes.insert(bytes.begin(), padding.begin(), padding.end());
  write_bytes(path, bytes);
  const TrialFile file(path);
  fs::resize_file(path, fs::file_size(path) / 2);
  TrialPlayer player(file);
  std::vector<Sample> samples;
  EXPECT_THAT([&] { player.poll(Time{1'000'000'000}, samples); },
              testing::ThrowsMessage<std::runtime_error>(HasSubstr("was changed")));
}

// A file that fits into what is read ahead may be in memory whole by then.
TEST(TrialPlayerTest, ASmallFileThatIsCutWhileItIsReadIsReadWholeOrThatIsSaid) {
  const fs::path path = fresh_folder("log") / "trial.lcmlog";
  const Buffer bytes = two_minutes();
  ASSERT_LT(bytes.size(), std::size_t{1} << 20);
  const auto samples_when_cut = [&](std::size_t left, bool begun) {
    write_bytes(path, bytes);
    const TrialFile file(path);
    TrialPlayer player(file);
    std::vector<Sample> samples;
    if (begun) player.poll(Time{}, samples);
    fs::resize_file(path, left);
    player.poll(Time{1'000'000'000}, samples);
    return samples.size();
  };
  const std::size_t all = samples_when_cut(bytes.size(), false);
  ASSERT_GT(all, 2u);
  for (const std::size_t left :
       {std::size_t{0}, std::size_t{1}, bytes.size() / 2, bytes.size() - 1}) {
    for (const bool begun : {false, true}) {
      try {
        EXPECT_EQ(samples_when_cut(left, begun), all) << left;
      } catch (const std::runtime_error& error) {
        EXPECT_THAT(error.what(), HasSubstr("was changed")) << left;
      }
    }
  }
}

TEST(LogTest, ALongPauseNeedsAWord) {
  const fs::path path = fresh_folder("log") / "trial.lcmlog";
  {
    Recorder recorder(path, header());
    for (const int second : {1, 2, 3, 100, 101, 102}) {
      TrackerSample sample = tracker(0);
      sample.device_time = Time{1'000'000 * second};
      recorder.write(Sample(sample));
    }
    recorder.close();
  }
  const Trial trial = read_log(path);
  EXPECT_EQ(trial.samples.size(), 6u);
  EXPECT_EQ(trial.longest_gap.from, Time{3'000'000});
  EXPECT_EQ(trial.longest_gap.to, Time{100'000'000});
  EXPECT_THAT([&] { read_trial(path); },
              testing::ThrowsMessage<std::runtime_error>(
                  HasSubstr("no sample for 97.000 s, from 3.000 s on; expected 60 s at most")));
  EXPECT_EQ(read_trial(path, Time{97'000'000}).samples.size(), 6u);
}

TEST(LogTest, APoseInAnotherFrameIsRefusedAndCounted) {
  const fs::path path = fresh_folder("log") / "trial.lcmlog";
  {
    Recorder recorder(path, header());
    for (const char* frame : {"T", "", "W"}) {
      TrackerSample sample = tracker(0);
      sample.frame = frame;
      recorder.write(Sample(sample));
    }
    recorder.close();
  }
  const Trial trial = read_trial(path);
  EXPECT_EQ(trial.samples.size(), 2u);
  EXPECT_EQ(trial.skipped.foreign, 1);
}

TEST(LogTest, SaysWhatIsWrongWithAFileThatIsNoTrial) {
  const fs::path folder = fresh_folder("log");
  const auto message = [&](std::span<const std::uint8_t> bytes) -> std::string {
    write_bytes(folder / "x.lcmlog", bytes);
    try {
      read_trial(folder / "x.lcmlog");
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "read";
  };
  EXPECT_THAT(message({}), HasSubstr("not an LCM event log: no whole event in 0 bytes"));
  EXPECT_THAT(message(Buffer(5000, 'x')), HasSubstr("no whole event in 5000 bytes"));
  EXPECT_THAT(message(one_event("LIDAR", {1})), HasSubstr("no message on HEADPIN_TRIAL"));
  TrialHeader later = header();
  later.format_version = 3;
  Buffer data;
  encode(later, data);
  EXPECT_THAT(message(one_event("HEADPIN_TRIAL", data)),
              HasSubstr("format version 3, expected 1 to 2"));
  EXPECT_THROW(read_trial(folder / "missing.lcmlog"), std::runtime_error);
  EXPECT_THROW(read_trial(folder), std::runtime_error);
}

TEST(RecorderTest, KeepsWhatIsThereUnlessToldToOverwrite) {
  const fs::path path = fresh_folder("log") / "trial.lcmlog";
  write_bytes(path, Buffer{1, 2, 3});
  EXPECT_THROW(record(path), std::runtime_error);
  EXPECT_THROW(record(path, {.live = true}), std::runtime_error);
  EXPECT_EQ(read_bytes(path), (Buffer{1, 2, 3}));
  record(path, {.overwrite = true});
  EXPECT_TRUE(read_trial(path).complete);
}

TEST(RecorderTest, LeavesNothingUnderTheFinalNameWhenNotClosed) {
  const fs::path folder = fresh_folder("log");
  {
    Recorder recorder(folder / "trial.lcmlog", header());
    recorder.write(state(0));
  }
  EXPECT_TRUE(fs::is_empty(folder));
}

TEST(RecorderTest, KilledAtAnyMomentALiveLogHoldsAllThatWasWritten) {
  const fs::path path = fresh_folder("log") / "live.lcmlog";
  EXPECT_EXIT(
      {
        Recorder recorder(path, header(), {.live = true});
        for (int tick = 0; tick < 100; ++tick) recorder.write(state(tick));
        raise(SIGKILL);
      },
      testing::KilledBySignal(SIGKILL), "");
  const Trial trial = read_trial(path);
  EXPECT_EQ(trial.states.size(), 100u);
  EXPECT_TRUE(trial.skipped.nothing());
  EXPECT_FALSE(trial.complete);
}

/// Writes states until a file may not grow past 20000 bytes, which stands for a full disk; exits
/// with how many were written.
[[noreturn]] void record_until_full(const fs::path& path) {
  signal(SIGXFSZ, SIG_IGN);
  const rlimit limit{20'000, 20'000};
  setrlimit(RLIMIT_FSIZE, &limit);
  int written = 0;
  try {
    Recorder recorder(path, header(), {.live = true});
    for (;; ++written) recorder.write(state(written));
  } catch (const std::runtime_error& error) {
    std::fprintf(stderr, "%s", error.what());
  }
  std::exit(written);
}

TEST(RecorderTest, AFullDiskIsAnErrorThatLosesNothingWrittenBefore) {
  const fs::path path = fresh_folder("log") / "live.lcmlog";
  const auto all_that_was_written = [&](int status) {
    return WIFEXITED(status) && WEXITSTATUS(status) > 10 &&
           static_cast<std::size_t>(WEXITSTATUS(status)) == read_trial(path).states.size();
  };
  EXPECT_EXIT(record_until_full(path), all_that_was_written,
              "File too large; the events before it are kept");
  EXPECT_TRUE(read_trial(path).skipped.nothing());
  EXPECT_THROW(Recorder("/dev/full", header(), {.overwrite = true, .live = true}),
               std::runtime_error);
}

TEST(ReplaySourceTest, HandsOutEachSampleOnceWhenItWasAvailable) {
  TrackerSample late = tracker(1);
  late.device_time = Time{1000};
  late.host_time = Time{4000};  // measured first, known last
  TrackerSample quick = tracker(2);
  quick.device_time = Time{2000};
  ReplaySource source({Sample(late), Sample(quick)});
  EXPECT_EQ(source.end(), Time{4000});

  std::vector<Sample> out;
  source.poll(Time{1999}, out);
  EXPECT_TRUE(out.empty());
  source.poll(Time{2000}, out);
  ASSERT_EQ(out.size(), 1u);
  EXPECT_EQ(std::get<TrackerSample>(out[0]).station, quick.station);
  EXPECT_FALSE(source.exhausted());
  source.poll(Time{9000}, out);
  ASSERT_EQ(out.size(), 2u);
  EXPECT_EQ(std::get<TrackerSample>(out[1]).station, late.station);
  EXPECT_TRUE(source.exhausted());
}

// As a record does whose first byte came in the tick before.
TEST(ReplaySourceTest, ASampleThatASessionGotLateIsHandedOutLateAgain) {
  const fs::path path = fresh_folder("log") / "late.lcmlog";
  TrackerSample early = tracker(1), late = tracker(2);
  early.device_time = early.host_time = Time{3000};
  late.device_time = Time{1000};
  late.host_time = Time{4000};
  {
    Recorder recorder(path, header());
    recorder.write(early);
    recorder.write(state(1));
    recorder.write(late);
    recorder.close();
  }
  const Time tick = read_trial(path).states[0].time;
  ASSERT_GT(tick, late.host_time);
  ReplaySource source(read_trial(path).samples);
  std::vector<Sample> out;
  source.poll(tick, out);
  ASSERT_EQ(out.size(), 1u);
  EXPECT_EQ(std::get<TrackerSample>(out[0]).station, early.station);
  source.poll(tick + Time{1}, out);
  ASSERT_EQ(out.size(), 2u);
  EXPECT_EQ(std::get<TrackerSample>(out[1]).device_time, late.device_time);
  EXPECT_EQ(std::get<TrackerSample>(out[1]).host_time, late.host_time);
}

}  // namespace
}  // namespace headpin::devices
