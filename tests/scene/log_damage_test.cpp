// Logs that are cut, damaged or lie: what is lost with them, and what is said of it.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/base/sources.h"
#include "devices/log/event_log.h"
#include "scene/record/file.h"
#include "scene/record/log.h"
#include "scene/record/messages.h"
#include "tests/scene/log_fixture.h"
#include "tests/support/folder.h"

namespace headpin::scene {
namespace {

namespace fs = std::filesystem;
using test::event;
using test::header;
using test::header_field;
using test::kMessages;
using test::one_event;
using test::put_int32;
using test::read_bytes;
using test::recorded;
using test::state;
using test::tracker;
using test::two_minutes;
using test::write_bytes;

TEST(LogTest, CutOffAnywhereItIsGoodUpToTheCut) {
  const devices::Buffer bytes = recorded();
  std::vector<std::size_t> ends;  // of each event in the file
  devices::LogReader reader(bytes);
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
  const devices::Buffer good = recorded();
  std::mt19937 random(1);
  for (int n = 0; n < 3000; ++n) {
    devices::Buffer bytes = good;
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
  const devices::Buffer good = recorded();
  for (int n = 0; n < 2000; ++n) {
    devices::Buffer bytes = good;
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
  const devices::Buffer good = recorded();
  devices::LogReader reader(good);
  devices::Buffer bytes;
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

TEST(LogTest, SizesThatLieCostOnlyTheirOwnEvent) {
  for (const std::size_t field : {std::size_t{20}, std::size_t{24}}) {
    for (const std::uint32_t lie : {0u, 1u, 300u, 2000u, 1000000u, 0x7fffffffu, 0x80000000u, ~0u}) {
      devices::Buffer bytes = recorded();
      put_int32(bytes, header_field(bytes, 5, field), lie);
      const Trial trial = read_log(bytes);
      EXPECT_FALSE(trial.complete);
      EXPECT_EQ(trial.samples.size() + trial.states.size(), 13u + 6u - 1u)
          << "field " << field << " says " << lie;
    }
  }
}

// Any two stamps may be subtracted.
TEST(LogTest, AStampThatIsNoTimeIsTakenForTheFarthestOne) {
  const fs::path path = fresh_folder("log") / "stamp.lcmlog";
  {
    Recorder recorder(path, header());
    for (int i = 0; i < 20; ++i) recorder.write(tracker(i));
    recorder.close();
  }
  devices::Buffer bytes = read_bytes(path);
  std::size_t at = 0;
  for (int i = 0; i < 10; ++i) {
    at = 28 + at + (static_cast<std::size_t>(bytes[at + 22]) << 8 | bytes[at + 23]) +
         (static_cast<std::size_t>(bytes[at + 26]) << 8 | bytes[at + 27]);
  }
  bytes[at + 12] ^= 0x80;  // the highest bit of the stamp
  write_bytes(path, bytes);
  devices::LogReader reader(bytes);
  Time least{};
  while (const auto event = reader.next()) least = std::min(least, event->time);
  EXPECT_LT(least, Time{0});
  EXPECT_GT(least, Time{std::numeric_limits<std::int64_t>::min() / 1000});
  EXPECT_EQ(read_trial(path).samples.size(), 19u);  // it is misdated
}

TEST(LogTest, ListsThatClaimMoreThanThereIsAreRefusedUnread) {
  devices::Buffer data;
  encode(state(1), data);
  const std::size_t count = 8 + 3 * 8 + 4;  // fingerprint, three stamps, contacts
  for (const std::uint32_t lie : {0u, 2u, 4u, 0x7fffffffu, 0x80000000u, ~0u}) {
    devices::Buffer bytes = data;
    put_int32(bytes, count, lie);
    const Trial trial = read_log(one_event("STATE", bytes));
    EXPECT_EQ(trial.skipped.undecodable, 1) << lie;
    EXPECT_TRUE(trial.states.empty());
  }
}

TEST(LogTest, StringsThatClaimMoreThanThereIsAreRefusedUnread) {
  devices::Buffer data;
  encode(event(), data);
  const std::size_t length = 8 + 2 * 8;  // fingerprint, two stamps, then the kind
  for (const std::uint32_t lie : {0u, 1u, 5u, 0x7fffffffu, 0x80000000u, ~0u}) {
    devices::Buffer bytes = data;
    put_int32(bytes, length, lie);
    EXPECT_EQ(read_log(one_event("EVENT", bytes)).skipped.undecodable, 1) << lie;
  }
}

TEST(LogTest, AWrongFingerprintIsPassedOverAndCounted) {
  devices::Buffer data;
  encode(tracker(1), data);
  data[3] ^= 1;
  EXPECT_EQ(read_log(one_event("TRACKER", data)).skipped.undecodable, 1);
  encode(tracker(1), data);
  EXPECT_EQ(read_log(one_event("MOUSE3D", data)).skipped.undecodable, 1);
}

TEST(LogTest, NumbersThatCannotBeArePassedOverAndCounted) {
  const auto implausible = [](devices::TrackerSample sample) {
    devices::Buffer data;
    encode(sample, data);
    return read_log(one_event("TRACKER", data)).skipped.implausible;
  };
  EXPECT_EQ(implausible(tracker(1)), 0);
  devices::TrackerSample sample = tracker(1);
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

TEST(LogTest, AMessageLostOnTheWayMakesItIncomplete) {
  devices::Buffer bytes = recorded();
  const std::size_t from = header_field(bytes, 4, 0), to = header_field(bytes, 5, 0);
  bytes.erase(bytes.begin() + static_cast<std::ptrdiff_t>(from),
              bytes.begin() + static_cast<std::ptrdiff_t>(to));
  const Trial trial = read_log(bytes);
  EXPECT_TRUE(trial.skipped.nothing());
  EXPECT_FALSE(trial.complete);
}

TEST(LogTest, TimesThatRunBackAreCountedPerDevice) {
  const fs::path path = fresh_folder("log") / "trial.lcmlog";
  {
    Recorder recorder(path, header());
    devices::TrackerSample head = tracker(0), hand = tracker(1);
    for (const int time : {1000, 2000, 1500, 3000, 3000}) {
      head.device_time = Time{time};
      ++head.sequence;
      recorder.write(devices::Sample(head));
    }
    hand.device_time = Time{2500};  // behind the head's, but the first of its own
    recorder.write(devices::Sample(hand));
    recorder.close();
  }
  const Trial trial = read_trial(path);
  EXPECT_EQ(trial.backwards, 2);
  EXPECT_EQ(trial.samples.size(), 6u);
  EXPECT_TRUE(trial.complete);
}

/// All of one trial is there, and each part of it once.
void expect_once(const Trial& trial, const Trial& once) {
  EXPECT_EQ(trial.samples.size(), once.samples.size());
  EXPECT_EQ(trial.states.size(), once.states.size());
  EXPECT_EQ(trial.frames.size(), once.frames.size());
  EXPECT_EQ(trial.events.size(), once.events.size());
  EXPECT_EQ(trial.backwards, 0);
  EXPECT_EQ(trial.skipped.misdated, 0);
  EXPECT_GT(trial.skipped.doubled, 0);
  EXPECT_TRUE(trial.complete);
  ASSERT_FALSE(trial.trouble.empty());
  EXPECT_EQ(trial.trouble.front().kind, "doubled");
}

TEST(LogTest, ATrialThatIsInALogTwiceIsReadOnce) {
  const devices::Buffer short_one = recorded();
  devices::Buffer twice = short_one;
  twice.insert(twice.end(), short_one.begin(), short_one.end());
  expect_once(read_log(twice), read_log(short_one));
  EXPECT_EQ(read_log(twice).skipped.doubled,
            kMessages - 1);  // all but the header, which may repeat
  // Two programs sent it at once, the second some seconds later.
  const devices::Buffer one = two_minutes();
  std::vector<std::pair<Time, devices::LogEvent>> events;
  for (const Time later : {Time{0}, Time{7'300'000}}) {
    devices::LogReader reader(one);
    while (const auto event = reader.next()) events.emplace_back(event->time + later, *event);
  }
  std::ranges::stable_sort(events, {}, [](const auto& sent) { return sent.first; });
  devices::Buffer both;
  for (std::int64_t number = 0; auto& [time, event] : events) {
    event.time = time;
    event.number = number++;
    devices::append(event, both);
  }
  expect_once(read_log(both), read_log(one));
}

// A flipped bit in a time, or in a tick, must not make a session last for years.
TEST(LogTest, ATimeThatThoseAroundItDoNotShareIsPassedOver) {
  const devices::Buffer good = two_minutes();
  const Trial whole = read_log(good);
  ASSERT_TRUE(whole.skipped.nothing());
  ASSERT_LT(whole.longest_gap.length(), Time{200'000});
  std::mt19937 random(3);
  std::map<std::string_view, int> seen;
  devices::LogReader reader(good);
  while (const auto event = reader.next()) {
    const bool sample = event->channel == devices::kTrackerChannel;
    if ((!sample && event->channel != kStateChannel) || random() % 20 != 0) continue;
    // Behind the fingerprint: device and host time of a sample, time and tick of a state.
    devices::Buffer bytes = good;
    const auto field =
        static_cast<std::size_t>(event->data.data() - good.data()) + 8 + 8 * (random() % 2);
    const auto bit = static_cast<unsigned>(20 + random() % 36);  // a second and more
    bytes[field + 7 - bit / 8] ^= static_cast<std::uint8_t>(1u << (bit % 8));
    const Trial trial = read_log(bytes);
    const std::int64_t lost = trial.skipped.misdated + trial.skipped.implausible;
    ASSERT_LE(lost, 1);
    ASSERT_LT(trial.longest_gap.length(), Time{1'300'000}) << event->channel << " bit " << bit;
    ASSERT_LT(trial.states.back().tick, 30'000) << "bit " << bit;
    for (const devices::Sample& s : trial.samples)
      ASSERT_LT(devices::available(s), Time{125'000'000}) << bit;
    ++seen[event->channel];
  }
  EXPECT_GT(seen[devices::kTrackerChannel], 20);
  EXPECT_GT(seen[kStateChannel], 20);
}

// Two presses do not tell which of them has the wrong time, however far it is from the log's stamps.
TEST(LogTest, OneOfTwoPressesIsNeverPassedOver) {
  const fs::path path = fresh_folder("log") / "trial.lcmlog";
  Recorder recorder(path, header());
  for (int i = 1; i <= 100; ++i) {
    devices::TrackerSample sample = tracker(i);
    sample.device_time = Time{100'000 * i};
    recorder.write(devices::Sample(sample));
    const bool down = i == 20;
    if (down || i == 60) {
      recorder.write(
          devices::Sample(devices::MouseSample{.device_time = Time{2'000'000}, .trigger = down}));
    }
  }
  recorder.close();
  const Trial trial = read_trial(path);
  EXPECT_EQ(trial.skipped.misdated, 0);
  EXPECT_EQ(trial.devices.at(devices::Device::mouse).samples, 2);
}

// A line that stood still for 1.3 s: the press arrived late, and its device says when it was.
TEST(LogTest, APressThatCameLateIsNotPassedOver) {
  const fs::path path = fresh_folder("log") / "trial.lcmlog";
  Recorder recorder(path, header());
  for (int i = 1; i <= 20; ++i) {
    devices::MouseSample press{.device_time = Time{2'000'000 * i}, .trigger = i % 2 == 1};
    press.host_time = press.device_time + Time{i == 13 ? 1'300'000 : 5'000};
    press.session_time = press.host_time + Time{1'000};
    recorder.write(devices::Sample(press));
  }
  recorder.close();
  const Trial trial = read_trial(path);
  EXPECT_EQ(trial.skipped.misdated, 0);
  EXPECT_EQ(trial.devices.at(devices::Device::mouse).samples, 20);
}

TEST(LogTest, SaysWhichMessagesAreAmiss) {
  const fs::path path = fresh_folder("log") / "trial.lcmlog";
  Recorder recorder(path, header());
  for (int i = 1; i <= 200; ++i) {
    devices::TrackerSample sample;
    sample.station = 2;
    sample.sequence = i < 50 ? i : i + 7;
    sample.device_time = Time{100'000 * i};
    if (i == 120 || i == 121) sample.frame = "lab";
    if (i == 150) sample.X_TS.p.x() = std::nan("");
    recorder.write(devices::Sample(sample));
    if (i == 30) {
      recorder.write(TickState{Time{3'000'000}, 720, 0, 0, {}});
      sample.device_time = Time{2'950'000};  // behind the state, though it was there before
      sample.station = 3;
      recorder.write(devices::Sample(sample));
      sample.device_time = Time{2'980'000};  // the rest of it came with the poll after: usual
      sample.station = 4;
      recorder.write(devices::Sample(sample));
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

TEST(LogTest, WhatIsMissingIsSaidInWholeSentences) {
  TrialSummary trial;
  trial.complete = true;
  EXPECT_EQ(what_is_missing(trial), "");
  trial.skipped.misdated = 1;
  EXPECT_EQ(what_is_missing(trial), "is complete, but 1 message in it is wrong and not used");
  trial.skipped.implausible = 2;
  trial.skipped.other_trials = 1;
  EXPECT_EQ(what_is_missing(trial),
            "is complete, but 3 messages in it are wrong and not used; the file has another trial "
            "after it, which is not read");
  trial.complete = false;
  trial.last = Time{3'000'000};
  trial.skipped.bytes = 1;
  trial.skipped.implausible = 0;
  trial.skipped.other_trials = 0;
  EXPECT_EQ(what_is_missing(trial),
            "is incomplete: it ends at 3.000 s; 1 message and 1 byte of it cannot be read");
  trial.skipped.cut_bytes = 11;
  trial.skipped.misdated = 0;
  EXPECT_EQ(what_is_missing(trial),
            "is incomplete: it ends at 3.000 s; 12 bytes of it cannot be read");
}

}  // namespace
}  // namespace headpin::scene
