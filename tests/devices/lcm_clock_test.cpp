// Publishers whose clock, and recordings whose stamps, go back.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <vector>

#include <gtest/gtest.h>

#include "devices/base/clocks.h"
#include "devices/lcm/link.h"
#include "devices/lcm/log_source.h"
#include "devices/lcm/source.h"
#include "devices/log/event_log.h"
#include "devices/log/sample_messages.h"
#include "tests/support/folder.h"

namespace headpin::devices {
namespace {

TrackerSample sample_at(std::int64_t us, std::int64_t sequence) {
  TrackerSample sample;
  sample.device_time = Time{us};
  sample.sequence = sequence;
  sample.station = kHandStation;
  return sample;
}

// Later samples with earlier times: the clock was set back, and none of them is late. (Without a sender's
// address, one that is half a second behind is another publisher.)
TEST(LcmClock, OfAPublisherThatIsSetBackStartsAgain) {
  for (const std::int64_t back_us : {100'000, 300'000, 450'000}) {
    LcmLink link("memq://");
    Clocks clocks;
    LcmSource source(link, clocks);
    std::vector<Sample> out;
    for (int i = 0; i < 200; ++i) {
      const std::int64_t now_us = 50'000 + 10'000 * i;
      const std::int64_t theirs = 5'000'000 + 10'000 * i - (i >= 100 ? back_us : 0);
      link.publish(Sample(sample_at(theirs, i)));
      source.receive(Time{now_us});
      source.poll(Time{now_us}, out);
      ASSERT_GE(out.size(), static_cast<std::size_t>(std::max(i, 1)));  // one may be due later
      const Time off = Time{now_us} - std::get<TrackerSample>(out.back()).device_time;
      ASSERT_LE(std::abs(off.count()), 20'000) << back_us << " at " << i;
    }
    EXPECT_EQ(source.intake().counts().clock_jumps, 1) << back_us;
  }
}

// A datagram that another one overtook tells nothing of the clock.
TEST(LcmClock, OfAPublisherWhoseSamplesComeOutOfOrderGoesOn) {
  LcmLink link("memq://");
  Clocks clocks;
  LcmSource source(link, clocks);
  std::vector<Sample> out;
  for (int i = 0; i < 100; ++i) {
    const int number = i == 60 ? 51 : i > 50 && i < 60 ? i + 1 : i;  // 51 comes behind 60
    link.publish(Sample(sample_at(5'000'000 + 10'000 * number, number)));
    source.receive(Time{50'000 + 10'000 * i});
    source.poll(Time{50'000 + 10'000 * i}, out);
  }
  EXPECT_EQ(source.intake().counts().clock_jumps, 0);
}

// A Fastrak's status is a space or a letter; a publisher that sets none leaves 0.
TEST(StatusLetter, IsOneThatAFastrakSends) {
  TrackerSample sample = sample_at(10'000, 1);
  for (const char good : {' ', 'a', 'A', 'z'}) {
    sample.status = good;
    EXPECT_EQ(status_letter(sample), good);
  }
  for (const char no : {'\0', '\xff', '3', '\n', ','}) {
    sample.status = no;
    EXPECT_EQ(status_letter(sample), 'x') << static_cast<int>(no);
  }
}

// As a logger writes what two threads send: neighbours are in the other order.
TEST(LogSource, PlaysMessagesThatAreOutOfOrderAtTheirPace) {
  const std::filesystem::path path = fresh_folder("clock") / "swapped.lcmlog";
  Buffer bytes;
  for (int i = 0; i < 200; ++i) {
    const int number = i ^ 1;
    Buffer data;
    encode(sample_at(10'000 * number, number), data);
    append({i, Time{1'700'000'000'000'000 + 10'000 * number}, kTrackerChannel, data}, bytes);
  }
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), std::ssize(bytes));
  LogSource source({.path = path});
  std::vector<Sample> out;
  Time now{};
  for (; !source.exhausted(); now += Time{4'000}) source.poll(now, out);
  EXPECT_EQ(out.size(), 200u);
  EXPECT_NEAR(seconds(now), 2.0, 0.03);
}

TEST(LogSource, PlaysAMessageOnceItsTimeHasCome) {
  const std::filesystem::path path = fresh_folder("clock") / "two.lcmlog";
  Buffer bytes;
  for (int i = 0; i < 2; ++i) {
    Buffer data;
    encode(sample_at(4'000 * i, i), data);
    append({i, Time{1'700'000'000'000'000 + 4'000 * i}, kTrackerChannel, data}, bytes);
  }
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), std::ssize(bytes));
  LogSource source({.path = path});
  std::vector<Sample> out;
  source.poll(Time{100'000}, out);
  EXPECT_EQ(out.size(), 1u);
  source.poll(Time{103'999}, out);
  EXPECT_EQ(out.size(), 1u);
  source.poll(Time{104'000}, out);
  EXPECT_EQ(out.size(), 2u);
}

}  // namespace
}  // namespace headpin::devices
