#include <gmock/gmock.h>

#include "devices/base/sources.h"
#include "devices/fastrak/serving.h"
#include "scene/record/log.h"
#include "scene/record/source.h"
#include "tests/devices/fastrak_unit.h"

namespace headpin::scene {
namespace {

const std::string kDemo = HEADPIN_SOURCE_DIR "/assets/trials/demo.lcmlog";

/// All that a source gives when it is polled so often.
std::vector<devices::Sample> all_of(devices::Source& source, Time tick) {
  std::vector<devices::Sample> samples;
  for (Time now{}; !source.exhausted() && now < Time{60'000'000}; now += tick) {
    source.poll(now, samples);
  }
  return samples;
}

TEST(OpenSource, ATrialPlaysAsItIsReplayed) {
  devices::Clocks clocks;
  const devices::OpenSource trial = open_source(kDemo, clocks, {});
  EXPECT_EQ(trial.name, kDemo);
  EXPECT_EQ(trial.recording, kDemo);
  EXPECT_FALSE(trial.has_stylus);
  EXPECT_EQ(trial.source->status({}).activity, "playing");
  EXPECT_THAT(trial.source->status(Time{1'500'000}).line, testing::StartsWith("playing 1.5 of "));
  devices::ReplaySource replay(read_trial(kDemo).samples);
  const std::vector<devices::Sample> played = all_of(*trial.source, Time{4166}),
                                     expected = all_of(replay, Time{7});
  ASSERT_EQ(played.size(), expected.size());
  for (std::size_t i = 0; i < played.size(); ++i) {
    EXPECT_EQ(devices::available(played[i]), devices::available(expected[i])) << i;
    EXPECT_EQ(devices::device_of(played[i]), devices::device_of(expected[i])) << i;
  }
  EXPECT_EQ(trial.source->status({}).activity, "at its end");
}

TEST(OpenSource, ALogIsPlayedOverLcm) {
  devices::Clocks clocks;
  const devices::OpenSource log = open_source("lcm:file://" + kDemo + "?speed=0", clocks, {});
  log.source->start();
  EXPECT_EQ(log.recording, kDemo);
  EXPECT_EQ(all_of(*log.source, Time{4166}).size(), read_trial(kDemo).samples.size());
  const devices::SourceStatus status = log.source->status(Time{4166});
  EXPECT_EQ(status.activity, "playing");
  EXPECT_EQ(status.counts.front(), (std::pair<std::string, std::int64_t>("dropped_samples", 0)));
}

TEST(OpenSource, AFastrakIsHeardAtTheEndOfItsLine) {
  devices::PseudoTerminal pty;
  devices::Unit unit;
  devices::Clocks clocks;
  const devices::OpenSource fastrak = open_source("fastrak:" + pty.name(), clocks, {});
  fastrak.source->start();
  EXPECT_TRUE(fastrak.has_stylus);
  EXPECT_EQ(fastrak.recording, "");
  EXPECT_NE(fastrak.source->status({}).activity, "streaming");
  std::vector<devices::Sample> samples;
  // Without a clock of its own, time is what the polls say, however long the machine takes.
  while (samples.size() < 20 && unit.now < Time{60'000'000}) {
    unit.now += Time{1000};
    devices::serve(unit.emulator, pty, unit.now);
    fastrak.source->poll(unit.now, samples);
  }
  EXPECT_GE(samples.size(), 20u);
  const devices::SourceStatus status = fastrak.source->status(unit.now);
  EXPECT_EQ(status.activity, "streaming");
  EXPECT_EQ(status.trouble, "");
  EXPECT_EQ(status.counts.front().first, "records");
  EXPECT_GE(status.counts.front().second, 20);
  EXPECT_THAT(status.line, testing::StartsWith("Fastrak streaming, 0 records missed"));
}

TEST(FaultNewsTest, TellsAKindAtOnceAndThenAtMostEveryTenSeconds) {
  devices::FaultNews news;
  EXPECT_THAT(news.take({{0, "none"}, {0, "none"}}, Time{}), testing::IsEmpty());
  EXPECT_THAT(news.take({{0, "none"}, {1, "one"}}, Time{1'000'000}), testing::ElementsAre("one"));
  // Both kinds, when the ten seconds are over; what did not occur again is not repeated.
  EXPECT_THAT(news.take({{3, "three"}, {2, "two"}}, Time{10'999'999}), testing::IsEmpty());
  EXPECT_THAT(news.take({{3, "three"}, {2, "two"}}, Time{11'000'000}),
              testing::ElementsAre("three", "two"));
  EXPECT_THAT(news.take({{3, "three"}, {2, "two"}}, Time{30'000'000}), testing::IsEmpty());
  EXPECT_THAT(news.take({{3, "three"}, {9, "nine"}}, Time{30'000'001}),
              testing::ElementsAre("nine"));
  EXPECT_THAT(news.take_rest({{4, "four"}, {9, "nine"}}), testing::ElementsAre("four"));
}

TEST(OpenSource, SaysWhatItCannotOpen) {
  devices::Clocks clocks;
  const auto refusal = [&clocks](const std::string& name) -> std::string {
    try {
      open_source(name, clocks, {});
    } catch (const std::exception& error) {
      return error.what();
    }
    return "opened";
  };
  EXPECT_THAT(refusal("nobody.lcmlog"), testing::HasSubstr("nobody.lcmlog"));
  EXPECT_THAT(refusal(HEADPIN_SOURCE_DIR "/README.md"), testing::HasSubstr("not an LCM event log"));
  EXPECT_THAT(refusal("fastrak:/dev/nobody"), testing::HasSubstr("/dev/nobody"));
  EXPECT_THROW(open_source("fastrak:tcp:here:none", clocks, {}), std::invalid_argument);
  EXPECT_EQ(refusal("fastrak:"),
            "fastrak: expected the name of a serial port or tcp:HOST:PORT after the colon, found "
            "nothing");
  EXPECT_THROW(open_source("fastrak:", clocks, {}), std::invalid_argument);
  EXPECT_THAT(refusal("lcm:carrier-pigeon://"),
              testing::HasSubstr("lcm:carrier-pigeon://: expected an LCM URL such as"));
  EXPECT_THROW(open_source("lcm:foo", clocks, {}), std::invalid_argument);
  EXPECT_THAT(refusal("lcm:file://" + kDemo + "?mode=w"),
              testing::HasSubstr("this would be written; to read a log, expected file://"));
  EXPECT_THAT(refusal("xyz:abc"), testing::HasSubstr("unknown kind of source 'xyz'"));
}

}  // namespace
}  // namespace headpin::scene
