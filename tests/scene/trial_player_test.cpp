// The samples of a recorded trial, handed out again: from the file as it is read, and from memory.

#include <algorithm>
#include <filesystem>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/base/sources.h"
#include "scene/record/file.h"
#include "scene/record/log.h"
#include "tests/scene/log_fixture.h"
#include "tests/support/folder.h"

namespace headpin::scene {
namespace {

namespace fs = std::filesystem;
using test::header;
using test::one_event;
using test::state;
using test::tracker;
using test::two_minutes;
using test::write_bytes;
using testing::HasSubstr;

/// A trial whose samples stand in the log up to half a second out of order, states and frames too.
fs::path out_of_order(std::mt19937& random) {
  const fs::path path = fresh_folder("log") / "trial.lcmlog";
  Recorder recorder(path, header());
  for (int i = 1; i <= 2000; ++i) {
    devices::TrackerSample sample = tracker(i);
    const auto jitter = static_cast<std::int64_t>(random() % 500) * 1000;
    sample.host_time = sample.device_time + Time{jitter};
    recorder.write(devices::Sample(sample));
    if (i > 1000 && i % 2 == 0) recorder.write(state(i));
    if (i > 1500 && i % 8 == 0) {
      recorder.write(FrameRecord{tick_time(i, 240), i / 4, i, {}, {1u, 2u}});
      if (i % 16 == 0) recorder.write(FrameRecord{tick_time(i, 240), i / 4 + 1, i, {}, {1u, 2u}});
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
    devices::ReplaySource replay(trial.samples);
    auto state = trial.states.begin();
    auto frame = trial.frames.begin();
    for (std::int64_t tick = 1; !replay.exhausted(); ++tick) {
      std::vector<devices::Sample> all, some;
      replay.poll(tick_time(tick, 240), all);
      player.poll(tick_time(tick, 240), some);
      ASSERT_EQ(some.size(), all.size()) << tick;
      for (std::size_t i = 0; i < all.size(); ++i) {
        const auto &a = std::get<devices::TrackerSample>(all[i]),
                   &b = std::get<devices::TrackerSample>(some[i]);
        ASSERT_TRUE(a.device_time == b.device_time && a.session_time == b.session_time);
      }
      const TickState* recorded = player.state(tick);
      while (state != trial.states.end() && state->tick < tick) ++state;
      const bool there = state != trial.states.end() && state->tick == tick;
      ASSERT_EQ(recorded != nullptr, there) << tick;
      if (there) {
        ASSERT_EQ(recorded->hash, state->hash);
      }
      while (frame != trial.frames.end() && frame->tick < tick) ++frame;
      for (; frame != trial.frames.end() && frame->tick == tick; ++frame) {
        const std::optional<FrameRecord> seen = player.next_frame(tick);
        ASSERT_TRUE(seen) << tick;
        ASSERT_EQ(seen->frame, frame->frame) << tick;
      }
      ASSERT_FALSE(player.next_frame(tick)) << tick;
    }
    EXPECT_TRUE(player.exhausted());
    // The longest gap is that of the samples in order.
    std::vector<Time> times;
    for (const devices::Sample& sample : trial.samples) times.push_back(devices::available(sample));
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
  devices::Buffer bytes = two_minutes();
  const devices::Buffer padding =
      one_event("LIDAR", devices::Buffer(4'000'000));  // more than is read ahead
  bytes.insert(bytes.begin(), padding.begin(), padding.end());
  write_bytes(path, bytes);
  const TrialFile file(path);
  fs::resize_file(path, fs::file_size(path) / 2);
  TrialPlayer player(file);
  std::vector<devices::Sample> samples;
  EXPECT_THAT([&] { player.poll(Time{1'000'000'000}, samples); },
              testing::ThrowsMessage<std::runtime_error>(HasSubstr("was changed")));
}

// A file that fits into what is read ahead may be in memory whole by then.
TEST(TrialPlayerTest, ASmallFileThatIsCutWhileItIsReadIsReadWholeOrThatIsSaid) {
  const fs::path path = fresh_folder("log") / "trial.lcmlog";
  const devices::Buffer bytes = two_minutes();
  ASSERT_LT(bytes.size(), std::size_t{1} << 20);
  const auto samples_when_cut = [&](std::size_t left, bool begun) {
    write_bytes(path, bytes);
    const TrialFile file(path);
    TrialPlayer player(file);
    std::vector<devices::Sample> samples;
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

TEST(ReplaySourceTest, HandsOutEachSampleOnceWhenItWasAvailable) {
  devices::TrackerSample late = tracker(1);
  late.device_time = Time{1000};
  late.host_time = Time{4000};  // measured first, known last
  devices::TrackerSample quick = tracker(2);
  quick.device_time = Time{2000};
  devices::ReplaySource source({devices::Sample(late), devices::Sample(quick)});
  EXPECT_EQ(source.end(), Time{4000});

  std::vector<devices::Sample> out;
  source.poll(Time{1999}, out);
  EXPECT_TRUE(out.empty());
  source.poll(Time{2000}, out);
  ASSERT_EQ(out.size(), 1u);
  EXPECT_EQ(std::get<devices::TrackerSample>(out[0]).station, quick.station);
  EXPECT_FALSE(source.exhausted());
  source.poll(Time{9000}, out);
  ASSERT_EQ(out.size(), 2u);
  EXPECT_EQ(std::get<devices::TrackerSample>(out[1]).station, late.station);
  EXPECT_TRUE(source.exhausted());
}

// As a record does whose first byte came in the tick before.
TEST(ReplaySourceTest, ASampleThatASessionGotLateIsHandedOutLateAgain) {
  const fs::path path = fresh_folder("log") / "late.lcmlog";
  devices::TrackerSample early = tracker(1), late = tracker(2);
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
  devices::ReplaySource source(read_trial(path).samples);
  std::vector<devices::Sample> out;
  source.poll(tick, out);
  ASSERT_EQ(out.size(), 1u);
  EXPECT_EQ(std::get<devices::TrackerSample>(out[0]).station, early.station);
  source.poll(tick + Time{1}, out);
  ASSERT_EQ(out.size(), 2u);
  EXPECT_EQ(std::get<devices::TrackerSample>(out[1]).device_time, late.device_time);
  EXPECT_EQ(std::get<devices::TrackerSample>(out[1]).host_time, late.host_time);
}

}  // namespace
}  // namespace headpin::scene
