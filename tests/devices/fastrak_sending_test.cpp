// What leaves a unit's line, when, and what does not.

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "devices/fastrak/sending.h"
#include "devices/fastrak/serving.h"
#include "tests/devices/fastrak_unit.h"

namespace headpin::devices {
namespace {

using namespace std::chrono_literals;

FastrakMessage message_of(std::string_view text, bool stream = false, Time due = {}) {
  FastrakMessage message;
  message.bytes.assign(text.begin(), text.end());
  message.due = due;
  message.stream = stream;
  return message;
}

/// A byte takes 100 us on it.
const FastrakPort kTenthOfAMillisecond = {100'000, 8, false};

/// A unit's output on a line that is fast enough to be counted.
struct Output {
  /// Pumps, and gives all that waits for the reader.
  std::string until(Time now) {
    sending.pump(now, {port, [this](Time due) { return asked.push_back(due), silent; },
                       [this](const FastrakMessage&) { ++ended; }});
    return {sending.out().begin(), sending.out().end()};
  }
  FastrakSending sending;
  FastrakPort port = kTenthOfAMillisecond;
  std::vector<Time> asked;  ///< whether the unit was silent
  bool silent = false;
  int ended = 0;
};

TEST(FastrakSendingTest, AByteHasLeftAfterItsTime) {
  Output line;
  line.sending.add(message_of("abc", false, 1ms));
  EXPECT_EQ(line.until(1ms), "");
  EXPECT_EQ(line.until(1100us - 1us), "");
  EXPECT_EQ(line.until(1100us), "a");
  EXPECT_EQ(line.until(1299us), "ab");
  EXPECT_EQ(line.ended, 0);
  EXPECT_EQ(line.until(1300us), "abc");
  EXPECT_EQ(line.ended, 1);
}

// A start bit, the data, a parity bit if there is one, and a stop bit.
TEST(FastrakSendingTest, AByteHasItsBits) {
  const std::vector<std::pair<FastrakPort, Time>> ports = {
      {{10'000, 8, false}, 1000us}, {{10'000, 7, false}, 900us}, {{10'000, 7, true}, 1000us}};
  for (const auto& [port, byte] : ports) {
    Output line;
    line.port = port;
    line.sending.add(message_of("ab"));
    EXPECT_EQ(line.until(byte - 1us), "");
    EXPECT_EQ(line.until(byte), "a");
    EXPECT_EQ(line.until(2 * byte - 1us), "a");
    EXPECT_EQ(line.until(2 * byte), "ab");
  }
}

TEST(FastrakSendingTest, WhatIsDueWhileTheUnitIsSilentIsLostAsAWhole) {
  Output line;
  line.silent = true;
  line.sending.add(message_of("lost", false, 5ms));
  line.until(5ms);
  EXPECT_EQ(line.asked, std::vector<Time>{5ms});
  EXPECT_TRUE(line.sending.is_free());
  line.silent = false;
  line.sending.add(message_of("ab", false, 6ms));
  EXPECT_EQ(line.until(6100us), "a");
  line.silent = true;  // a message that has begun is finished
  EXPECT_EQ(line.until(7ms), "ab");
}

TEST(FastrakSendingTest, AMessageWithoutBytesIsNone) {
  Output line;
  EXPECT_TRUE(line.sending.add({}));
  EXPECT_TRUE(line.sending.is_free());
  Unit unit;
  unit.type("l1,0\rl2,0\r");
  EXPECT_EQ(unit.ask("P"), "");  // no station is on
  EXPECT_EQ(unit.ask("l1\r"), "21l0000\r\n");
}

TEST(FastrakSendingTest, EightKilobytesWaitForTheLineAndNoMore) {
  Output line;
  EXPECT_FALSE(line.sending.add(message_of(std::string(8193, 'x'))));
  EXPECT_TRUE(line.sending.add(message_of(std::string(8192, 'x'))));
  EXPECT_FALSE(line.sending.add(message_of("y")));
  EXPECT_EQ(line.until(10ms).size(), 100u);
  EXPECT_FALSE(line.sending.add(message_of(std::string(101, 'y'))));
  EXPECT_TRUE(line.sending.add(message_of(std::string(100, 'y'))));
}

TEST(FastrakSendingTest, WhatHasBegunIsFinishedAndAnAnswerOutlivesTheStream) {
  for (const bool only_stream : {true, false}) {
    Output line;
    for (const bool stream : {true, false, true, false}) {
      line.sending.add(message_of(stream ? "rrr" : "aaa", stream));
    }
    EXPECT_EQ(line.until(100us), "r");
    line.sending.drop_unsent(only_stream);
    EXPECT_EQ(line.until(1s), only_stream ? "rrraaaaaa" : "rrr");
  }
}

TEST(FastrakSendingTest, ARecordMayBeWrittenWhileTheLastByteLeaves) {
  Output line;
  EXPECT_TRUE(line.sending.is_free());
  line.sending.add(message_of("abc"));
  EXPECT_FALSE(line.sending.is_free());
  line.until(100us);
  EXPECT_FALSE(line.sending.is_free());
  line.until(200us);
  EXPECT_TRUE(line.sending.is_free());
  line.sending.add(message_of("d"));
  EXPECT_FALSE(line.sending.is_free());
  line.until(400us);
  EXPECT_TRUE(line.sending.is_free());
  line.sending.suspend();
  EXPECT_FALSE(line.sending.is_free());
  line.sending.resume(1ms);
  EXPECT_TRUE(line.sending.is_free());
}

TEST(FastrakSendingTest, AReaderMayLeaveAKilobyte) {
  Output line;
  line.sending.add(message_of(std::string(2000, 'x')));
  EXPECT_EQ(line.until(1s).size(), 1024u);
  line.sending.drop_all();
  EXPECT_FALSE(line.sending.is_free());
  line.sending.taken(1);
  EXPECT_TRUE(line.sending.is_free());
}

// Else all that would have left meanwhile came at once.
TEST(FastrakSendingTest, AfterXonTheNextByteTakesItsTime) {
  Output line;
  line.sending.add(message_of("abc"));
  EXPECT_EQ(line.until(100us), "a");
  line.sending.suspend();
  EXPECT_EQ(line.until(1s), "a");
  line.sending.resume(1s);
  EXPECT_EQ(line.until(1s + 99us), "a");
  EXPECT_EQ(line.until(1s + 100us), "ab");
  EXPECT_EQ(line.until(1s + 200us), "abc");
}

// --- Its server ------------------------------------------------------------------------------

/// A stream in which so many bytes wait.
class Pending : public ByteStream {
 public:
  explicit Pending(std::size_t count) : left(count) {}
  std::size_t read(std::span<std::uint8_t> out) override {
    const std::size_t n = std::min(out.size(), left);
    std::fill_n(out.begin(), n, std::uint8_t{' '});
    left -= n;
    return n;
  }
  std::size_t write(Bytes bytes) override { return bytes.size(); }
  bool closed() const override { return false; }

  std::size_t left;
};

TEST(FastrakServingTest, FourKilobytesAreTakenInOneCall) {
  Unit unit;
  Pending stream(10'000);
  serve(unit.emulator, stream, 1ms);
  EXPECT_EQ(stream.left, 10'000u - 4096u);
}

/// A unit that streams since 100 ms.
struct Streaming : Unit {
  explicit Streaming(int receivers) : Unit(with(receivers)) {
    type("C");
    listen(100ms);
  }
  static FastrakEmulatorOptions with(int receivers) {
    FastrakEmulatorOptions options = quiet();
    options.receivers = receivers;
    return options;
  }
};

TEST(FastrakServingTest, ARecordingBeginsAMultipleOfThreeCyclesAfterTheFirstRecord) {
  TrackerSample first;
  first.device_time = 25ms;
  for (const int receivers : {1, 2, 4}) {
    const Streaming unit(receivers);
    for (first.station = 1; first.station <= receivers; ++first.station) {
      const Time begin = begin_of(first, unit.emulator, unit.now);
      EXPECT_GE(begin, unit.now);
      EXPECT_EQ((begin - unit.emulator.stream_zero()) % 25ms, 0ms) << first.station;
    }
  }
}

// Of three stations, a turn takes three cycles: no turn of the others is such a multiple.
TEST(FastrakServingTest, OtherwiseItBeginsWithTheNextMeasurementOrAtOnce) {
  const Streaming unit(3);
  TrackerSample first;
  first.device_time = 50ms;
  for (const int station : {1, 2, 3}) {
    first.station = station;
    const Time begin = begin_of(first, unit.emulator, unit.now);
    EXPECT_EQ(begin + 50ms, *unit.emulator.next_measured(station, unit.now + 50ms));
    EXPECT_EQ((begin - unit.emulator.stream_zero()) % 25ms == 0ms, station == 1);
  }
  first.station = 4;  // has no receiver
  EXPECT_EQ(begin_of(first, unit.emulator, unit.now), unit.now);
}

}  // namespace
}  // namespace headpin::devices
