#include "scene/record/log.h"

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <span>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lcm/lcm.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include "base/output_file.h"
#include "devices/base/version.h"
#include "devices/log/event_log.h"
#include "scene/record/file.h"
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
using test::read_bytes;
using test::record;
using test::recorded;
using test::state;
using test::tracker;
using test::write_bytes;
using testing::HasSubstr;

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
    const auto& read = std::get<devices::TrackerSample>(trial.samples[static_cast<std::size_t>(i)]);
    const devices::TrackerSample written = tracker(i);
    EXPECT_EQ(read.device_time, written.device_time);
    EXPECT_EQ(read.host_time, written.host_time);
    EXPECT_EQ(read.sequence, written.sequence);
    EXPECT_EQ(read.station, written.station);
    EXPECT_TRUE(same(read.X_TS, written.X_TS));
    EXPECT_EQ(read.status, written.status);
    EXPECT_EQ(read.buttons, written.buttons);
    EXPECT_EQ(read.frame, written.frame);
  }
  const auto& mouse = std::get<devices::MouseSample>(trial.samples.back());
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
  EXPECT_EQ(read.software_version, devices::software_version());
  EXPECT_FALSE(read.software_version.empty());
  for (const fs::directory_entry& type :
       fs::directory_iterator(HEADPIN_SOURCE_DIR "/devices/lcm/types")) {
    const devices::Buffer text = read_bytes(type.path());
    EXPECT_THAT(read.schema, HasSubstr(std::string(text.begin(), text.end()))) << type.path();
  }
}

TEST(LogTest, LiblcmReadsTheSameEvents) {
  const fs::path path = fresh_folder("log") / "trial.lcmlog";
  record(path);
  const devices::Buffer bytes = read_bytes(path);
  devices::LogReader ours(bytes);
  lcm_eventlog_t* theirs = lcm_eventlog_create(path.c_str(), "r");
  ASSERT_NE(theirs, nullptr);
  int events = 0;
  while (lcm_eventlog_event_t* expected = lcm_eventlog_read_next_event(theirs)) {
    const std::optional<devices::LogEvent> found = ours.next();
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
  const devices::Buffer bytes = recorded();
  devices::LogReader reader(bytes);
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
    devices::Buffer bytes;
    devices::append({1, Time{1}, name, {}}, bytes);
    devices::append({2, Time{2}, "after", {}}, bytes);
    devices::LogReader reader(bytes);
    const auto first = reader.next();
    ASSERT_TRUE(first);
    EXPECT_EQ(first->channel, size == 999 ? name : "after");
    EXPECT_EQ(reader.skipped_bytes(), size == 999 ? 0 : 1028);
  }
}

TEST(LogTest, ForeignChannelsAreListedAndLeaveTheTrialWhole) {
  devices::Buffer bytes = recorded();
  const devices::Buffer foreign = one_event("LIDAR", {1, 2, 3});
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

// As a logger gets it that begins to listen in the middle of a session.
TEST(LogTest, AHeaderThatIsRepeatedIsTheSameTrials) {
  const devices::Buffer whole = recorded();
  const auto first = whole.begin() + static_cast<std::ptrdiff_t>(header_field(whole, 1, 0));
  const auto from = whole.begin() + static_cast<std::ptrdiff_t>(header_field(whole, 4, 0));
  const auto later = whole.begin() + static_cast<std::ptrdiff_t>(header_field(whole, 8, 0));
  devices::Buffer bytes(from, later);
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
  devices::Buffer bytes = recorded();
  const fs::path path = fresh_folder("log") / "other.lcmlog";
  TrialHeader other = header();
  other.participant = "P08";
  Recorder(path, other).close();
  const devices::Buffer again = read_bytes(path);
  bytes.insert(bytes.end(), again.begin(), again.end());
  const Trial trial = read_log(bytes);
  EXPECT_TRUE(trial.complete);
  EXPECT_EQ(trial.samples.size(), 13u);
  EXPECT_EQ(trial.skipped.other_trials, 1);
}

TEST(LogTest, ASessionThatPublishedItselfIsTheTrialAndWhatItHeardIsNot) {
  devices::Buffer bytes = recorded(), told;
  const auto add = [&](const std::string& channel, const auto& message) {
    devices::Buffer data;
    encode(message, data);
    const devices::Buffer event = one_event(channel, data);
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

TEST(LogTest, ALongPauseNeedsAWord) {
  const fs::path path = fresh_folder("log") / "trial.lcmlog";
  {
    Recorder recorder(path, header());
    for (const int second : {1, 2, 3, 100, 101, 102}) {
      devices::TrackerSample sample = tracker(0);
      sample.device_time = Time{1'000'000 * second};
      recorder.write(devices::Sample(sample));
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
      devices::TrackerSample sample = tracker(0);
      sample.frame = frame;
      recorder.write(devices::Sample(sample));
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
  EXPECT_THAT(message({}), HasSubstr("x.lcmlog: is empty; expected an LCM event log"));
  const devices::Buffer whole = one_event("LIDAR", devices::Buffer(100, 1));
  EXPECT_THAT(message(std::span(whole).first(100)),
              HasSubstr("is cut short within its first event: no whole event in 100 bytes"));
  EXPECT_THAT(message(devices::Buffer(5000, 'x')),
              HasSubstr("not an LCM event log: no whole event in 5000 bytes"));
  EXPECT_THAT(message(one_event("LIDAR", {1})), HasSubstr("no message on HEADPIN_TRIAL"));
  TrialHeader later = header();
  later.format_version = 3;
  devices::Buffer data;
  encode(later, data);
  EXPECT_THAT(message(one_event("HEADPIN_TRIAL", data)),
              HasSubstr("format version 3, expected 1 to 2"));
  EXPECT_THROW(read_trial(folder / "missing.lcmlog"), std::runtime_error);
  EXPECT_THROW(read_trial(folder), std::runtime_error);
}

TEST(RecorderTest, KeepsWhatIsThereUnlessToldToOverwrite) {
  const fs::path path = fresh_folder("log") / "trial.lcmlog";
  write_bytes(path, devices::Buffer{1, 2, 3});
  EXPECT_THROW(record(path), std::runtime_error);
  EXPECT_THROW(record(path, {.live = true}), std::runtime_error);
  EXPECT_EQ(read_bytes(path), (devices::Buffer{1, 2, 3}));
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
        Recorder recorder(base::OutputFile(path, {.live = true}), header());
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
    Recorder recorder(base::OutputFile(path, {.live = true}), header());
    for (;; ++written) recorder.write(state(written));
  } catch (const std::runtime_error& error) {
    std::fprintf(stderr, "%s", error.what());
  }
  std::_Exit(written);  // what other tests of this process have begun has no threads here
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
  EXPECT_THROW(Recorder(base::OutputFile("/dev/full", {.overwrite = true, .live = true}), header()),
               std::runtime_error);
}

}  // namespace
}  // namespace headpin::scene
