#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lcm/lcm.h>
#include <sys/time.h>

#include "devices/base/sources.h"
#include "devices/lcm/link.h"
#include "devices/lcm/log_source.h"
#include "devices/lcm/source.h"
#include "devices/log/event_log.h"
#include "tests/support/folder.h"
#include "tests/support/samples_of_log.h"

namespace headpin::devices {
namespace {

TrackerSample tracker(std::int64_t us, std::int32_t station = kHandStation) {
  TrackerSample sample;
  sample.device_time = Time{us};
  sample.station = station;
  sample.X_TS = {rotation(Vec3(0.1, 0.2, 0.3)), Vec3(1.0, 2.0, 3.0)};
  return sample;
}

std::vector<Sample> poll(Source& source, Time now) {
  std::vector<Sample> out;
  source.poll(now, out);
  return out;
}

TEST(LcmLinkTest, WhatIsPublishedArrivesOnTheSessionsClock) {
  LcmLink link("memq://");
  Clocks clocks;
  LcmSource source(link, clocks);
  link.publish(Sample(tracker(1'700'000'000'000'000)));
  link.publish(Sample(MouseSample{Time{1'700'000'000'008'000}, Time{}, true, false, true}));
  source.receive(Time{50'000});
  const std::vector<Sample> out = poll(source, Time{60'000});
  ASSERT_EQ(out.size(), 2u);
  const auto& sample = std::get<TrackerSample>(out[0]);
  EXPECT_EQ(sample.device_time, Time{50'000});
  EXPECT_EQ(sample.host_time, Time{50'000});
  EXPECT_EQ(sample.X_TS.p, tracker(0).X_TS.p);
  const auto& mouse = std::get<MouseSample>(out[1]);
  EXPECT_EQ(mouse.device_time, Time{58'000});  // 8 ms after the first, as the publisher says
  EXPECT_TRUE(mouse.trigger);
  EXPECT_EQ(source.intake().counts().received, 2);
}

TEST(LcmLinkTest, ALogEndsAndIsNotWrittenTo) {
  const std::filesystem::path path = fresh_folder("link") / "link.log";
  {
    LcmLink log("file://" + path.string() + "?mode=w");
    log.publish(Sample(tracker(5'000)));
  }
  EXPECT_THROW(LcmLink("file://" + path.string()), std::runtime_error);
  LogSource source({.path = path, .speed = 0.0});
  std::vector<Sample> out;
  for (Time now{}; !source.exhausted(); now += Time{4'000}) source.poll(now, out);
  EXPECT_EQ(out.size(), 1u);
  std::filesystem::remove(path);
}

// liblcm's reader dies of a length of 0x7fffffff and ends at the first bad header; ours goes on.
TEST(LcmLinkTest, ADamagedLogPlaysWhatIsWhole) {
  const std::filesystem::path path = fresh_folder("link") / "damaged.log";
  std::string bytes;
  {
    {
      LcmLink log("file://" + path.string() + "?mode=w");
      for (int i = 0; i < 3; ++i) log.publish(Sample(tracker(5'000 * i)));
    }
    std::ifstream file(path, std::ios::binary);
    bytes.assign(std::istreambuf_iterator<char>(file), {});
  }
  const std::size_t event = bytes.size() / 3;
  for (const std::string& length : {std::string("\x7f\xff\xff\xff"), std::string("\0\0\0\1", 4)}) {
    std::string damaged = bytes;
    damaged.replace(event + 24, 4, length);  // of the second event's data
    std::ofstream(path, std::ios::binary) << damaged;
    LogSource source({.path = path, .speed = 0.0});
    std::vector<Sample> out;
    for (const Time now : {Time{1'000'000}, Time{2'000'000}}) source.poll(now, out);
    EXPECT_EQ(out.size(), 2u);
    EXPECT_TRUE(source.exhausted());
  }
  std::filesystem::remove(path);
  EXPECT_THROW(LogSource({.path = path}), std::runtime_error);
  EXPECT_THROW(LcmLink("file://" HEADPIN_SOURCE_DIR "/assets/trials/demo.lcmlog?sped=0"),
               std::invalid_argument);
}

// One of less than is read ahead is in memory by then.
TEST(LcmLinkTest, ASmallLogThatIsCutToNothingWhileItPlaysIsPlayedWhole) {
  const std::filesystem::path path = fresh_folder("link") / "cut.log";
  for (const bool begun : {false, true}) {
    {
      LcmLink log("file://" + path.string() + "?mode=w");
      for (int i = 0; i < 25; ++i) log.publish(Sample(tracker(5'000)));
    }
    LogSource source({.path = path, .speed = 0.0}, 10);
    std::size_t count = begun ? poll(source, Time{4'000}).size() : 0;
    std::filesystem::resize_file(path, 0);
    for (Time now{8'000}; now <= Time{100'000}; now += Time{4'000})
      count += poll(source, now).size();
    EXPECT_TRUE(source.exhausted());
    EXPECT_EQ(count, 25u);
    std::filesystem::remove(path);
  }
}

// At its pace on the session's clock, however late the session is.
TEST(LcmLinkTest, ALogPlaysAtItsPace) {
  const std::string demo = HEADPIN_SOURCE_DIR "/assets/trials/demo.lcmlog";
  FileWindow file(demo);
  const Time begin = LogReader(file).next()->time;
  const std::vector<Stamped<Sample>> expected = test::stamped_samples_of(demo);
  for (const double speed : {1.0, 4.0}) {
    LogSource source({.path = demo, .speed = speed});
    Time last{};
    std::vector<Sample> out;
    for (Time now{}; !source.exhausted(); now += Time{4'000}) {
      source.poll(now, out);
      last = now;
    }
    EXPECT_EQ(out.size(), expected.size());
    const double took = seconds(last) * speed;
    EXPECT_NEAR(took, seconds(expected.back().time - begin), 0.05);
  }
}

TEST(LcmLinkTest, ASampleIsHandedOutOnceAndNotBeforeItsTime) {
  LcmLink link("memq://");
  Clocks clocks;
  LcmSource source(link, clocks);
  link.publish(Sample(tracker(0)));
  link.publish(Sample(tracker(5'000)));  // measured after the tick at hand, by its own clock
  source.receive(Time{100'000});
  EXPECT_EQ(poll(source, Time{104'000}).size(), 1u);
  EXPECT_EQ(poll(source, Time{108'000}).size(), 1u);
  EXPECT_TRUE(poll(source, Time{900'000}).empty());
}

// A session polls ticks; what comes in after a poll must not look as if it had been there before.
TEST(LcmLinkTest, AReplayHandsOutEverySampleAtTheSameTick) {
  LcmLink link("memq://");
  Clocks clocks;
  LcmSource source(link, clocks);
  std::vector<Sample> recorded;
  std::vector<std::pair<Time, std::size_t>> live;
  for (int tick = 1; tick <= 40; ++tick) {
    const Time now = tick_time(tick, 240);
    link.publish(Sample(tracker(5000 + 4100 * tick, 1 + tick % 2)));
    source.receive(tick % 3 == 0 ? now : now - Time{700});  // some in the instant of the last tick
    if (tick % 5 == 0) continue;                            // a tick that comes late
    const std::vector<Sample> out = poll(source, now);
    recorded.insert(recorded.end(), out.begin(), out.end());
    live.emplace_back(now, recorded.size());
  }
  ReplaySource replay(recorded);
  std::vector<Sample> out;
  for (const auto& [now, count] : live) {
    replay.poll(now, out);
    EXPECT_EQ(out.size(), count) << "at " << now.count() << " us";
  }
}

/// A program that measures every 10 ms, whose clock shows other times than ours and goes wrong.
struct Program {
  std::int32_t station;
  Time behind;         ///< its clock's zero, on ours
  double drift = 0.0;  ///< what it goes too fast
  TrackerSample at(Time ours) const {
    const auto since = static_cast<double>((ours - behind).count());
    return tracker(std::llround((1.0 + drift) * since), station);
  }
};

// A session joins programs that run already, at clocks of their own; what they said before waited
// in the socket while it made itself ready.
TEST(LcmLinkTest, NeitherWhatWaitedNorWhoStartedEarlierMakesASampleLate) {
  LcmLink link("memq://");
  Clocks clocks;
  LcmSource source(link, clocks);
  const Program head{kHeadStation, Time{-60'000'000}}, hand{kHandStation, Time{-60'700'000}};
  const Program late{3, Time{4'000'000}};
  for (Time t{-400'000}; t < Time{}; t += Time{10'000}) {
    link.publish(Sample(head.at(t)));
    link.publish(Sample(hand.at(t)));
  }
  source.drain();
  std::vector<Sample> samples;
  for (Time now{10'000}; now < Time{10'000'000}; now += Time{10'000}) {
    link.publish(Sample(head.at(now)));
    link.publish(Sample(hand.at(now)));
    if (now >= late.behind) link.publish(Sample(late.at(now)));
    source.receive(now + Time{now.count() % 7 * 1000});  // up to 6 ms late
    samples.clear();
    source.poll(now + Time{9'000}, samples);
    if (now < Time{100'000}) continue;
    for (const Sample& sample : samples) {
      const std::int32_t station = std::get<TrackerSample>(sample).station;
      if (station == late.station && now < late.behind + Time{100'000}) continue;
      EXPECT_LE(std::chrono::abs(device_time(sample) - now), Time{1'000})
          << station << " at " << now.count();
    }
  }
  EXPECT_EQ(source.intake().counts().clock_jumps, 0);
  ASSERT_EQ(source.intake().publishers().size(), 3u);
  EXPECT_EQ(source.intake().publishers().at(device_at(kHeadStation)).samples, 999);
  EXPECT_LE(source.intake().publishers().at(device_at(3)).late(), Time{7'000});
}

TEST(LcmLinkTest, AClockThatDriftsIsFollowed) {
  for (const double drift : {-200e-6, 200e-6}) {
    LcmLink link("memq://");
    Clocks clocks;
    LcmSource source(link, clocks);
    const Program head{kHeadStation, Time{}, drift};
    std::vector<Sample> samples;
    for (Time now{10'000}; now < Time{120'000'000}; now += Time{10'000}) {
      link.publish(Sample(head.at(now)));
      source.receive(now + Time{now.count() % 7 * 500});  // up to 3 ms late
      source.poll(now + Time{9'000}, samples);
    }
    // 24 ms apart by now, if it were not.
    EXPECT_LE(std::chrono::abs(device_time(samples.back()) - Time{119'990'000}), Time{1'500})
        << drift;
    for (std::size_t i = 1; i < samples.size(); ++i) {
      const Time interval = device_time(samples[i]) - device_time(samples[i - 1]);
      ASSERT_LE(std::chrono::abs(interval - Time{10'000}), Time{1'000}) << i;
    }
  }
}

TEST(LcmLinkTest, APublisherThatStartsAgainIsFollowed) {
  LcmLink link("memq://");
  Clocks clocks;
  LcmSource source(link, clocks);
  link.publish(Sample(tracker(80'000'000)));
  source.receive(Time{1'000'000});
  link.publish(Sample(tracker(0)));
  source.receive(Time{2'000'000});
  const std::vector<Sample> out = poll(source, Time{3'000'000});
  ASSERT_EQ(out.size(), 2u);
  EXPECT_EQ(device_time(out[1]), Time{2'000'000});
  EXPECT_EQ(source.intake().counts().clock_jumps, 1);
}

TEST(LcmLinkTest, TheQueueIsBoundedAndWhatItDropsIsCounted) {
  LcmLink link("memq://");
  Clocks clocks;
  LcmSource source(link, clocks, 10);
  for (int i = 0; i < 35; ++i) {
    link.publish(Sample(tracker(i * 100)));
    if (i % 5 == 4) source.receive(Time{i * 100});
  }
  const std::vector<Sample> out = poll(source, Time{1'000'000});
  EXPECT_EQ(out.size(), 10u);
  EXPECT_EQ(source.intake().counts().received, 35);
  EXPECT_EQ(source.intake().counts().dropped, 25);
}

// A log that comes all at once is taken in as the queue has room, and nothing of it is lost.
TEST(LcmLinkTest, AFloodIsTakenInOverSeveralTicks) {
  const std::filesystem::path path = fresh_folder("link") / "flood.log";
  {
    LcmLink log("file://" + path.string() + "?mode=w");
    for (int i = 0; i < 25; ++i) log.publish(Sample(tracker(5'000)));
  }
  LogSource source({.path = path, .speed = 0.0}, 10);
  std::size_t handed_out = 0;
  for (Time now{4'000}; now <= Time{40'000}; now += Time{4'000}) {
    const std::int64_t before = source.intake().counts().received;
    handed_out += poll(source, now).size();
    EXPECT_LE(source.intake().counts().received - before, 10);
  }
  EXPECT_EQ(handed_out, 25u);
  EXPECT_EQ(source.intake().counts().dropped, 0);
}

/// By the clock that LCM stamps with.
Time wall() {
  return std::chrono::duration_cast<Time>(std::chrono::system_clock::now().time_since_epoch());
}

// A session that is late asks for a message long after it came. Its clock stands still here, so that
// what is told of the arrival is between the readings of the wall's clock before and after.
TEST(LcmLinkTest, AMessageIsStampedWithWhenItCameHoweverLateItIsAskedFor) {
  LcmLink link("memq://");
  Clocks clocks;
  LcmSource source(link, clocks);
  static constexpr Time kNow{10'000'000}, kLongest{1'000'000};
  source.use_clock([] { return kNow; });
  const Time before = wall();
  link.publish(Sample(tracker(0)));
  const Time sent = wall();
  while (wall() - sent < Time{20'000}) continue;
  const Time asked = wall();
  source.receive(Time{1'000});  // the tick that it is asked for at says nothing
  const Time taken = wall();
  const std::vector<Sample> out = poll(source, kNow);
  ASSERT_EQ(out.size(), 1u);
  const Time came = std::get<TrackerSample>(out[0]).host_time;
  EXPECT_GE(came, kNow - std::min(taken - before, kLongest));
  EXPECT_LE(came, kNow - std::min(asked - sent, kLongest));
}

// A session that is stopped just as it looks for samples is not one that failed.
TEST(LcmLinkTest, ASignalWhileItIsAskedLosesNothing) {
  static volatile std::sig_atomic_t came = 0;
  struct sigaction old {
  }, count{};
  count.sa_handler = [](int) { came = came + 1; };  // no SA_RESTART
  ASSERT_EQ(sigaction(SIGALRM, &count, &old), 0);
  LcmLink link("memq://");
  Clocks clocks;
  LcmSource source(link, clocks);
  const itimerval often{{0, 100}, {0, 100}}, never{};
  ASSERT_EQ(setitimer(ITIMER_REAL, &often, nullptr), 0);
  std::int64_t sent = 0;
  for (; came < 500; ++sent) {
    link.publish(Sample(tracker(sent)));
    for (int i = 0; i < 100; ++i) poll(source, Time{sent});
  }
  setitimer(ITIMER_REAL, &never, nullptr);
  sigaction(SIGALRM, &old, nullptr);
  poll(source, Time{sent});
  EXPECT_EQ(source.intake().counts().received, sent);
}

TEST(LcmLinkTest, ForeignAndImpossibleMessagesAreCountedAndPassedOver) {
  LcmLink link("memq://");
  Clocks clocks;
  LcmSource source(link, clocks);
  TrackerSample bad = tracker(0);
  bad.X_TS.p.x() = std::nan("");
  link.publish(Sample(bad));
  link.publish_pose("TRACKER", Time{0}, Pose{});
  link.publish_pose("SOMETHING", Time{0}, Pose{});
  source.receive(Time{1000});
  EXPECT_TRUE(poll(source, Time{1'000'000}).empty());
  EXPECT_EQ(source.intake().counts().implausible, 1);
  EXPECT_EQ(source.intake().counts().undecodable, 1);
  TrackerSample in_the_world = tracker(0);
  in_the_world.frame = "W";
  link.publish(Sample(in_the_world));
  source.receive(Time{2'000'000});
  EXPECT_TRUE(poll(source, Time{3'000'000}).empty());
  EXPECT_EQ(source.intake().counts().foreign, 1);
}

TEST(LcmLinkTest, PosesHaveTheBytesOfBotCoresType) {
  const std::string path = fresh_folder("link") / "poses.lcmlog";
  {
    LcmLink link("file://" + path + "?mode=w");
    link.publish_pose("HEAD_POSE", Time{0x0102030405060708}, {Quat(1, 0, 0, 0), Vec3(2, 0, 0)});
  }
  FileWindow file(path);
  LogReader reader(file);
  const auto event = reader.next();
  ASSERT_TRUE(event.has_value());
  EXPECT_EQ(event->channel, "HEAD_POSE");
  ASSERT_EQ(event->data.size(), 8u + 8u + 3u * 8u + 4u * 8u);
  // Behind the fingerprint: utime, trans, quat (w first), all big-endian.
  EXPECT_EQ(event->data[8], 0x01);
  EXPECT_EQ(event->data[15], 0x08);
  EXPECT_EQ(event->data[16], 0x40);  // 2.0 = 0x4000...
  EXPECT_EQ(event->data[40], 0x3f);  // 1.0 = 0x3ff0...
  EXPECT_EQ(event->data[41], 0xf0);
}

// Somebody who leaves device_utime at 0 has no clock: what they say was measured when it came.
TEST(LcmLinkTest, WhatHasNoTimeIsTakenToBeMeasuredWhenItCame) {
  LcmLink link("memq://");
  Clocks clocks;
  LcmSource source(link, clocks);
  std::vector<Sample> samples;
  for (int i = 0; i < 400; ++i) {
    TrackerSample sample = tracker(0);
    sample.sequence = i;
    link.publish(Sample(sample));
    link.publish(Sample(MouseSample{Time{}, Time{}, false, false, i % 2 == 1}));
    source.poll(Time{1'000'000 + 10'000 * i}, samples);
  }
  ASSERT_EQ(samples.size(), 800u);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    EXPECT_EQ(device_time(samples[i]), Time(1'000'000 + 10'000 * (static_cast<int>(i) / 2))) << i;
  }
  EXPECT_EQ(source.intake().counts().unstamped, 2 * 399);  // 0 may be the time of the first
  EXPECT_EQ(source.intake().counts().clock_jumps, 0);
  EXPECT_EQ(source.intake().lost(), 0);
}

// A log of two programs that play the same trial, the second 700 ms after the first.
TEST(LcmLinkTest, OfTwoPublishersOfAStationOneIsKept) {
  LcmLink link("memq://");
  Clocks clocks;
  LcmSource source(link, clocks);
  const Program first{kHandStation, Time{-60'000'000}}, second{kHandStation, Time{-59'300'000}};
  std::vector<Sample> samples;
  const auto play = [&](Time from, Time to, bool one, bool two) {
    for (Time now = from; now < to; now += Time{10'000}) {
      if (one) link.publish(Sample(first.at(now)));
      if (two) link.publish(Sample(second.at(now)));
      source.receive(now);
      source.poll(now + Time{9'000}, samples);
    }
  };
  play(Time{10'000}, Time{500'000}, true, false);
  play(Time{500'000}, Time{3'000'000}, true, true);
  EXPECT_EQ(samples.size(), 299u);
  EXPECT_EQ(source.intake().counts().others, 250);
  EXPECT_EQ(source.intake().publishers().at(device_at(kHandStation)).others, 250);
  for (std::size_t i = 1; i < samples.size(); ++i) {
    ASSERT_EQ(device_time(samples[i]) - device_time(samples[i - 1]), Time{10'000}) << i;
  }
  play(Time{3'000'000}, Time{5'000'000}, false, true);  // the first has ended: the second is heard
  EXPECT_EQ(samples.size(), 299u + 101u);
  EXPECT_EQ(source.intake().counts().others, 250 + 99);
}

// The same log with the buttons: the second program's trigger is not the participant's, until the first
// program has ended.
TEST(LcmLinkTest, OfTwoMiceTheOneWithTheStationsClockIsKept) {
  LcmLink link("memq://");
  Clocks clocks;
  LcmSource source(link, clocks);
  const Program first{kHandStation, Time{-60'000'000}}, second{kHandStation, Time{-59'300'000}};
  std::vector<Sample> samples;
  int pressed = 0;
  const auto play = [&](Time from, Time to, bool one, bool two) {
    for (Time now = from; now < to; now += Time{10'000}) {
      const bool down = now.count() / 10'000 % 200 == 50;
      const auto button = [&](const Program& program) {
        const Time theirs = device_time(Sample{program.at(now)});
        if (down) link.publish(Sample(MouseSample{theirs, Time{}, false, false, true}));
      };
      if (one) link.publish(Sample(first.at(now)));
      if (two) link.publish(Sample(second.at(now)));
      if (one) button(first);
      if (two) button(second);
      source.receive(now);
      samples.clear();
      source.poll(now + Time{9'000}, samples);
      for (const Sample& sample : samples) {
        pressed += std::holds_alternative<MouseSample>(sample) ? 1 : 0;
      }
    }
  };
  play(Time{10'000}, Time{1'500'000}, true, false);
  play(Time{1'500'000}, Time{7'000'000}, true, true);
  EXPECT_EQ(pressed, 4);  // at 0.5, 2.5, 4.5 and 6.5 s, once each
  EXPECT_EQ(source.intake().publishers().at(Device::mouse).others, 3);
  play(Time{7'000'000}, Time{11'000'000}, false, true);
  EXPECT_EQ(pressed, 6);
}

}  // namespace
}  // namespace headpin::devices
