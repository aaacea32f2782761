// Logs whose stamps are not those of the session, and messages that are wrong at the ends of a log.

#include <array>
#include <functional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "devices/base/sources.h"
#include "devices/log/event_log.h"
#include "scene/record/log.h"
#include "scene/record/messages.h"
#include "scene/record/trial_events.h"
#include "tests/scene/log_fixture.h"

namespace headpin::scene {
namespace {

/// A sample, and its stamp in a log.
struct Sent {
  Time stamp;
  devices::Sample sample;
};

/// Eight changes of the buttons, the first and the last far from the others; a hand beside them, or nothing.
std::vector<Sent> eight_changes(bool hand) {
  constexpr auto kChanges_ds = std::to_array({25, 200, 205, 250, 255, 300, 305, 375});
  std::vector<Sent> out;
  std::size_t change = 0;
  for (int i = 1; i <= 400; ++i) {
    const Time time{100'000 * i};
    if (hand) {
      devices::TrackerSample sample = test::tracker(1);
      sample.sequence = i;
      sample.device_time = time;
      out.push_back({time, sample});
    }
    if (change == kChanges_ds.size() || kChanges_ds[change] != i) continue;
    out.push_back({time, devices::MouseSample{.device_time = time, .trigger = change % 2 == 0}});
    ++change;
  }
  return out;
}

devices::Buffer log_of(const std::vector<Sent>& samples) {
  devices::Buffer bytes, data;
  std::int64_t number = 0;
  const auto put = [&](std::string_view channel, Time stamp, const auto& message) {
    encode(message, data);
    devices::append({.number = number++, .time = stamp, .channel = channel, .data = data}, bytes);
  };
  put(kTrialChannel, Time{}, stamped(test::header()));
  for (const Sent& one : samples) {
    if (const auto* mouse = std::get_if<devices::MouseSample>(&one.sample)) {
      put(devices::kMouseChannel, one.stamp, *mouse);
    } else {
      put(devices::kTrackerChannel, one.stamp, std::get<devices::TrackerSample>(one.sample));
    }
  }
  return bytes;
}

void expect_changes(const std::vector<Sent>& samples, std::int64_t read, std::int64_t misdated) {
  const Trial trial = read_log(log_of(samples));
  EXPECT_EQ(trial.devices.at(devices::Device::mouse).samples, read);
  EXPECT_EQ(trial.skipped.misdated, misdated);
}

/// The times of the first or the last change jump by 70 s.
std::vector<Sent> with_a_wrong_time(std::vector<Sent> samples, bool first) {
  devices::MouseSample* wrong = nullptr;
  for (Sent& one : samples) {
    auto* mouse = std::get_if<devices::MouseSample>(&one.sample);
    if (mouse && !(first && wrong)) wrong = mouse;
  }
  wrong->device_time += Time{70'000'000};
  return samples;
}

// As where a trial was streamed faster than it was recorded, or a writer left the stamps out.
TEST(LogTimes, WhereTheStampsPassAtAnotherRateEveryChangeOfTheButtonsIsRead) {
  const std::vector<Sent> real = eight_changes(true);
  const std::vector<std::function<Time(Time)>> stamps = {
      [](Time) { return Time{}; }, [](Time t) { return t / 300; }, [](Time t) { return t / 2; },
      [](Time t) { return 3 * t; }};
  for (const auto& stamp : stamps) {
    std::vector<Sent> samples = real;
    for (Sent& one : samples) one.stamp = stamp(one.stamp);
    expect_changes(samples, 8, 0);
  }
}

TEST(LogTimes, AWrongTimeOfTheFirstOrLastChangeIsPassedOverWhereOtherSamplesShowIt) {
  const std::vector<Sent> real = eight_changes(true);
  expect_changes(real, 8, 0);
  for (const bool first : {true, false}) expect_changes(with_a_wrong_time(real, first), 7, 1);
}

TEST(LogTimes, ATimeOfTheFirstOrLastChangeIsKeptWhereNothingElseShowsThatItIsWrong) {
  const std::vector<Sent> alone = eight_changes(false);
  for (const bool first : {true, false}) expect_changes(with_a_wrong_time(alone, first), 8, 0);
}

// A snapshot is no message of its own: the one before it is not there twice.
TEST(LogTimes, OfALogWithSnapshotsOnlyTheDoubledMessageIsLeftOut) {
  for (const bool doubled : {false, true}) {
    const std::filesystem::path path = fresh_folder("log") / "trial.lcmlog";
    Recorder recorder(path, test::header());
    for (int i = 1; i <= 40; ++i) {
      devices::TrackerSample sample = test::tracker(1);
      sample.sequence = i;
      sample.device_time = Time{100'000 * (i == 20 ? 19 : i)};  // one time comes twice
      recorder.write(devices::Sample(sample));
      recorder.write(test::state(24 * i));
      if (i % 10 == 0) recorder.write(Snapshot{Time{100'000 * i}, 24 * i, {1, 2, 3}});
    }
    recorder.close();
    devices::Buffer bytes;
    const devices::Buffer whole = test::read_bytes(path);
    devices::LogReader reader(whole);
    for (int n = 0; const auto event = reader.next(); ++n) {
      devices::append(*event, bytes);
      if (doubled && n == 5) devices::append(*event, bytes);
    }
    const Trial trial = read_log(bytes);
    EXPECT_EQ(trial.skipped.doubled, doubled ? 1 : 0);
    EXPECT_EQ(trial.backwards, 1);
    EXPECT_EQ(trial.samples.size(), 40u);
    EXPECT_EQ(trial.states.size(), 40u);
    EXPECT_TRUE(trial.complete);
  }
}

/// Samples of one hand, at 10 Hz; all its times are those of the log.
std::vector<Sent> samples_of(std::int32_t station, int first, int count) {
  std::vector<Sent> out;
  for (int i = first; i < first + count; ++i) {
    devices::TrackerSample sample = test::tracker(1);
    sample.station = station;
    sample.sequence = i - first;
    sample.device_time = sample.host_time = sample.session_time = Time{100'000 * i};
    out.push_back({sample.device_time, sample});
  }
  return out;
}

TEST(LogTimes, AWrongTimeOfTheFirstOrLastSampleIsShownByItsOwnOtherTimes) {
  using Tracker = devices::TrackerSample;
  for (Time Tracker::*const wrong :
       {&Tracker::device_time, &Tracker::host_time, &Tracker::session_time}) {
    for (const bool first : {true, false}) {
      std::vector<Sent> samples = samples_of(1, 1, 40);
      std::get<Tracker>((first ? samples.front() : samples.back()).sample).*wrong +=
          Time{70'000'000};
      const Trial trial = read_log(log_of(samples));
      EXPECT_EQ(trial.skipped.misdated, 1);
      EXPECT_EQ(trial.samples.size(), 39u);
    }
  }
}

// Of the log's stamp nothing else tells.
TEST(LogTimes, ASampleWhoseTimesAllJumpAlikeIsKeptWhereNothingElseShowsThatItIsWrong) {
  for (const bool first : {true, false}) {
    std::vector<Sent> samples = samples_of(1, 1, 40);
    auto& jumps =
        std::get<devices::TrackerSample>((first ? samples.front() : samples.back()).sample);
    for (Time* time : {&jumps.device_time, &jumps.host_time, &jumps.session_time}) {
      *time += Time{70'000'000};
    }
    EXPECT_EQ(read_log(log_of(samples)).skipped.misdated, 0);
  }
}

// Each has to be compared with all other clocks.
TEST(LogTimes, OfThousandsOfDevicesOnlySoManyDoubtsAreSettled) {
  constexpr int kEach = 8, kDevices = 200;
  std::vector<Sent> samples = samples_of(1, 1, kEach);
  const auto add = [&](const std::vector<Sent>& more) {
    samples.insert(samples.end(), more.begin(), more.end());
  };
  int next = 1 + kEach;
  for (int device = 0; device < kDevices; ++device, next += kEach) {
    add(samples_of(2 + device, next, kEach));
    auto& last = std::get<devices::TrackerSample>(samples.back().sample);
    for (Time* time : {&last.device_time, &last.host_time, &last.session_time}) {
      *time += Time{70'000'000};
    }
  }
  add(samples_of(1, next, 1));
  const Trial trial = read_log(log_of(samples));
  EXPECT_EQ(trial.skipped.misdated, 64);  // the three times of a sample are one doubt
}

}  // namespace
}  // namespace headpin::scene
