// What the driver says on its line, at which rate and when, and which of the bytes it hears count.

#include <algorithm>
#include <array>
#include <bit>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/fastrak/driver.h"
#include "devices/fastrak/serving.h"
#include "tests/devices/fastrak_bench.h"

namespace headpin::devices {
namespace {

using namespace std::chrono_literals;
using test::Bench;
using test::tracker;
using test::unit;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

Bytes line_bytes(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// A line as a test watches and disturbs it.
struct Watch {
  std::string said;                          ///< by the driver, taken by the line
  std::vector<int> rates;                    ///< set by the driver
  std::string comes;                         ///< bytes that come before those of the unit
  bool takes = true;                         ///< whether it takes what the driver says
  std::string trouble;                       ///< as ByteStream says it
  bool has_baud = true;                      ///< likewise
  std::function<int()> unit_rate;            ///< at another one, nothing is understood
  std::string forgotten;                     ///< a command with this beginning is lost, once
  std::pair<std::string, std::string> echo;  ///< a command, and what comes when it is said
};

class WatchedLine : public ByteStream {
 public:
  explicit WatchedLine(Watch& watch, std::unique_ptr<ByteStream> line = nullptr)
      : watch_(watch), line_(std::move(line)) {}
  std::size_t read(std::span<std::uint8_t> out) override {
    if (!watch_.comes.empty()) {
      const std::size_t n = watch_.comes.copy(reinterpret_cast<char*>(out.data()), out.size());
      watch_.comes.erase(0, n);
      return n;
    }
    const std::size_t n = line_ ? line_->read(out) : 0;
    return understood() ? n : 0;
  }
  std::size_t write(Bytes bytes) override {
    if (!watch_.takes) return 0;
    const std::string text(bytes.begin(), bytes.end());
    watch_.said += text;
    if (text == watch_.echo.first) watch_.comes += watch_.echo.second;
    if (!watch_.forgotten.empty() && text.starts_with(watch_.forgotten)) {
      watch_.forgotten.clear();
      return bytes.size();
    }
    return line_ && understood() ? line_->write(bytes) : bytes.size();
  }
  bool closed() const override { return false; }
  std::string trouble() const override { return watch_.trouble; }
  void set_baud(int rate) override { watch_.rates.push_back(rate); }
  bool has_baud() const override { return watch_.has_baud; }

 private:
  bool understood() const {
    return !watch_.unit_rate ||
           (!watch_.rates.empty() && watch_.rates.back() == watch_.unit_rate());
  }

  Watch& watch_;
  std::unique_ptr<ByteStream> line_;
};

/// The two ends of a line that is watched at the driver's.
test::Ends watched(Watch& watch) {
  auto [unit_end, host] = memory_streams();
  return {std::move(unit_end), std::make_unique<WatchedLine>(watch, std::move(host))};
}

/// A driver at a line without a unit.
struct Alone {
  explicit Alone(FastrakOptions options = {})
      : driver(std::make_unique<WatchedLine>(watch), clocks, std::move(options)) {}
  Alone(const Alone&) = delete;
  Alone& operator=(const Alone&) = delete;

  void run(Time span) {
    for (const Time end = now + span; now < end;) driver.poll(now += 1ms, samples);
  }

  Watch watch;
  Time now{};
  std::vector<Sample> samples;
  Clocks clocks;
  FastrakDriver driver;
};

/// The unit says nothing for three seconds, and the driver starts it again.
void let_it_restart(Bench& bench) {
  FastrakFaults faults = parse_faults("noise=0");
  faults.silence.push_back({bench.now, bench.now + 3s});
  bench.emulator.set_faults(faults);
  bench.run(3s);
  ASSERT_EQ(bench.driver.statistics().restarts, 1);
  ASSERT_TRUE(bench.run_until_streaming());
}

// --- Attempts ----------------------------------------------------------------------------------

struct Attempt {
  int rate;
  std::string said;
  Time lasted;
};

/// The first attempts at a line on which nobody answers.
std::vector<Attempt> attempts_of(Alone& alone, std::int64_t count) {
  std::vector<Attempt> attempts;
  while (true) {
    const std::int64_t before = alone.driver.statistics().attempts;
    alone.driver.poll(alone.now += 5ms, alone.samples);
    if (alone.driver.statistics().attempts > before) {
      if (before == count) return attempts;
      const int rate = alone.watch.rates.empty() ? 0 : alone.watch.rates.back();
      attempts.push_back({rate, "", Time{}});
      alone.watch.said.erase(0, before == 0 ? 0 : attempts[attempts.size() - 2].said.size());
    }
    attempts.back().said = alone.watch.said;
    attempts.back().lasted += 5ms;
  }
}

TEST(FastrakDriverLineTest, AttemptsStopTheUnitEndALineAndStartItAgainOncePerRound) {
  Alone alone;
  const std::vector<Attempt> attempts = attempts_of(alone, 10);
  const std::string stop =
                        "\x11"
                        "cS",
                    end = "\x11\rcS", start = "\r\x19";
  const std::vector<std::string> round = {stop, end, start, end, stop, end, stop, end};
  for (std::size_t i = 0; i < attempts.size(); ++i) {
    EXPECT_EQ(attempts[i].said, round[i % 8]) << i;
    // The silence after a start, or a pause and the wait for an answer.
    const Time least = i == 2 ? 10s : 1150ms;
    EXPECT_GE(attempts[i].lasted, least) << i;
    EXPECT_LT(attempts[i].lasted, least + 100ms) << i;
  }
}

TEST(FastrakDriverLineTest, FromTheSecondRoundOnEachRateIsTriedTwiceDownwards) {
  FastrakOptions options;
  options.baud = 38400;
  options.start_up = 1s;
  Alone alone(options);
  const std::vector<int> others = {19200, 9600, 4800, 2400, 115200, 57600, 38400};
  const std::vector<Attempt> attempts = attempts_of(alone, 24);
  for (std::size_t i = 0; i < attempts.size(); ++i) {
    EXPECT_EQ(attempts[i].rate, i < 10 ? 38400 : others[(i - 10) / 2]) << i;
    // At a rate that is not its own, a unit that hears is not started again.
    EXPECT_THAT(attempts[i].said, StartsWith(i == 2 ? "\r" : "\x11")) << i;
  }
}

TEST(FastrakDriverLineTest, NoOtherRateIsTriedWhereNoneIsWantedOrTheLineHasNone) {
  for (const bool wanted : {true, false}) {
    FastrakOptions options;
    options.baud = 38400;
    options.start_up = 1s;
    options.search_baud = wanted;
    Alone alone(options);
    alone.watch.has_baud = !wanted;
    for (const Attempt& attempt : attempts_of(alone, 20)) EXPECT_EQ(attempt.rate, 38400);
  }
}

TEST(FastrakDriverLineTest, AUnitAtAnotherRateIsFoundAndSetToTheLines) {
  Watch watch;
  FastrakEmulatorOptions options = unit("noise=0");
  options.baud = 57600;
  Bench bench(options, {}, watched(watch));
  watch.unit_rate = [&] { return bench.emulator.baud(); };
  ASSERT_TRUE(bench.run_until_streaming());
  EXPECT_EQ(bench.driver.statistics().attempts, 11);  // the first one at the unit's rate
  EXPECT_EQ(bench.emulator.baud(), 115200);
  EXPECT_EQ(watch.rates.back(), 115200);
  bench.run(1s);
  EXPECT_GT(bench.samples.size(), 100u);
}

// --- A line that does not take what is said ------------------------------------------------------

TEST(FastrakDriverLineTest, ALineThatComesBackIsSpokenToAtOnceAndOnce) {
  Alone alone;
  alone.run(5ms);
  EXPECT_EQ(alone.watch.said,
            "\x11"
            "c");
  alone.watch.trouble = "it is gone";
  alone.run(5ms);
  EXPECT_EQ(alone.driver.activity(), "it is gone");
  EXPECT_EQ(alone.driver.statistics().attempts, 1);
  alone.watch.trouble = "";
  EXPECT_EQ(alone.driver.activity(), "about to start it again");
  alone.run(1ms);
  EXPECT_EQ(alone.watch.said,
            "\x11"
            "c\x11"
            "c");
  alone.run(5ms);
  EXPECT_EQ(alone.driver.statistics().attempts, 2);
}

TEST(FastrakDriverLineTest, AnAttemptForgetsWhatTheOneBeforeCouldNotSay) {
  Alone alone;
  alone.run(5ms);
  alone.watch.takes = false;
  while (alone.driver.statistics().attempts == 1) alone.run(1ms);
  alone.watch.said.clear();
  alone.watch.takes = true;
  alone.run(100ms);
  EXPECT_EQ(alone.watch.said, "\x11\rc");  // no S before it
}

TEST(FastrakDriverLineTest, AQuestionThatCouldNotBeAskedIsNotAskedLater) {
  Watch watch;
  Bench bench(unit("noise=0"), {}, watched(watch));
  while (!watch.said.ends_with("O1\r") && bench.now < 10s) bench.run(1ms);
  watch.takes = false;
  watch.said.clear();
  bench.run(2500ms);  // more than two waits for an answer
  watch.takes = true;
  bench.run(100ms);
  EXPECT_THAT(watch.said, StartsWith("Q1\r"));
  ASSERT_TRUE(bench.run_until_streaming());
  EXPECT_THAT(bench.driver.unconfirmed(), ElementsAre("I1: no answer", "V1: no answer"));
}

// --- Answers -------------------------------------------------------------------------------------

TEST(FastrakDriverLineTest, AStatusCountsOnlyOnceItWasAskedFor) {
  Alone alone;
  alone.run(50ms);
  alone.watch.comes = encode_status({});
  while (alone.driver.statistics().attempts < 3) alone.run(1ms);
  EXPECT_FALSE(alone.driver.unit());
  EXPECT_THAT(alone.watch.said, Not(HasSubstr("o,N,8,0")));

  Alone asked;
  while (asked.driver.activity().find("asking for its status") == std::string::npos) asked.run(1ms);
  asked.run(500ms);
  EXPECT_THAT(asked.watch.said, Not(HasSubstr("o,N,8,0")));
  asked.watch.comes = encode_status({});
  asked.run(50ms);
  EXPECT_TRUE(asked.driver.unit());
  EXPECT_THAT(asked.watch.said, HasSubstr("o,N,8,0"));
}

TEST(FastrakDriverLineTest, StationsCountOnlyOnceTheyWereAskedFor) {
  Watch watch;
  watch.echo = {"y0\r", "21l1000\r\n"};
  Bench bench(unit("noise=0"), {}, watched(watch));
  ASSERT_TRUE(bench.run_until_streaming());
  EXPECT_THAT(bench.driver.active(), ElementsAre(true, true, false, false));
}

TEST(FastrakDriverLineTest, AnAnswerThatWaitedForALatePollIsTaken) {
  for (const char* phase : {"asking for its status", "checking its set-up"}) {
    Bench bench(unit("noise=0"), {});
    while (bench.driver.activity().find(phase) == std::string::npos) bench.run(1ms);
    for (int ms = 0; ms < 2000; ++ms) serve(bench.emulator, *bench.line, bench.now += 1ms);
    ASSERT_TRUE(bench.run_until_streaming());
    EXPECT_EQ(bench.driver.statistics().attempts, 1) << phase;
    EXPECT_THAT(bench.driver.unconfirmed(), IsEmpty()) << phase;
  }
}

TEST(FastrakDriverLineTest, WhatIsUnconfirmedIsOfTheLastStart) {
  Watch watch;
  watch.forgotten = "V1,";
  Bench bench(unit("noise=0"), {}, watched(watch));
  ASSERT_TRUE(bench.run_until_streaming());
  EXPECT_THAT(bench.driver.unconfirmed(), ElementsAre("V1: set, and reads otherwise"));
  let_it_restart(bench);
  EXPECT_THAT(bench.driver.unconfirmed(), IsEmpty());
}

// --- Records -------------------------------------------------------------------------------------

/// Each station's samples are numbered on, whatever came between.
void expect_numbered_on(const std::vector<Sample>& samples) {
  std::array<std::optional<std::int64_t>, kFastrakStations> last;
  for (const Sample& sample : samples) {
    const TrackerSample& s = tracker(sample);
    auto& before = last[static_cast<std::size_t>(s.station - 1)];
    if (before) {
      EXPECT_THAT(s.sequence - *before, testing::AnyOf(1, 2));  // a stream may end in mid-turn
    }
    before = s.sequence;
  }
  EXPECT_GT(last[0].value_or(0), 200);
}

TEST(FastrakDriverLineTest, ARestartGoesOnCountingWhereItWas) {
  Bench bench(unit("noise=0"), {});
  ASSERT_TRUE(bench.run_until_streaming());
  bench.run(3s);
  let_it_restart(bench);
  bench.run(1s);
  expect_numbered_on(bench.samples);
}

// The records of the stream before were counted by the number of stations of the next one.
TEST(FastrakDriverLineTest, SoItDoesWithAReceiverMoreOrLess) {
  for (const char* faults : {"noise=0,unplug=2@0-5", "noise=0,unplug=2@5"}) {
    SCOPED_TRACE(faults);
    Bench bench(unit(faults), {});
    ASSERT_TRUE(bench.run_until_streaming());
    const auto stations = std::ranges::count(bench.driver.active(), true);
    bench.run(6s - bench.now);
    bench.emulator.power_cycle(bench.now);
    bench.run(3s);
    ASSERT_TRUE(bench.run_until_streaming());
    EXPECT_NE(std::ranges::count(bench.driver.active(), true), stations);
    bench.run(1s);
    expect_numbered_on(bench.samples);
  }
}

TEST(FastrakDriverLineTest, TheFirstRecordNeedsNoOtherBehindIt) {
  Bench bench(unit("noise=0", 1), {});
  ASSERT_TRUE(bench.run_until_streaming());
  while (bench.sent.empty() && bench.now < 60s) bench.run(1ms);
  bench.emulator.power_cycle(bench.now);
  bench.run(400ms);
  EXPECT_EQ(bench.sent.size(), 1u);
  EXPECT_EQ(bench.samples.size(), 1u);
}

TEST(FastrakDriverLineTest, SamplesWithAnErrorLetterAreCounted) {
  Bench bench(unit("noise=0"), {}, test::memory(), [](int station, Time time) {
    FastrakTruth truth = still_motion(station, time);
    if (station == 2 && time % 1s < 300ms) truth.error = 'k';
    return truth;
  });
  ASSERT_TRUE(bench.run_until_streaming());
  bench.run(5s);
  const auto bad =
      std::ranges::count_if(bench.samples, [](const Sample& s) { return !tracker(s).good(); });
  EXPECT_GT(bad, 50);
  EXPECT_EQ(bench.driver.statistics().flagged, bad);
}

// The noise is the begin of a record with an error letter, whose end the record behind it makes up.
TEST(FastrakDriverLineTest, OutOfStepARecordWithAnotherBehindItGoesBeforeOneThatOnlyLooksLikeIt) {
  const FastrakOptions options;
  Bench bench(unit("noise=0", 1), options);
  ASSERT_TRUE(bench.run_until_streaming());
  bench.run(500ms);
  bench.emulator.receive(line_bytes("c"), bench.now);
  bench.run(400ms);
  bench.samples.clear();
  const std::int64_t skipped = bench.driver.statistics().skipped_bytes;

  FastrakRecord record;
  record.position.x() = std::bit_cast<float>(0x0A0D3020u);  // " 0\r\n", as a list ends
  std::vector<std::uint8_t> records;
  for (int i = 0; i < 2; ++i) {
    encode_record(record, {options.items, options.binary, options.centimetres}, records);
  }
  const std::string noise = "01k" + std::string(25, '\0');
  bench.line->write(line_bytes("?"));
  bench.run(2ms);
  bench.line->write(line_bytes(std::string_view(noise).substr(0, 10)));
  bench.run(2ms);
  bench.line->write(line_bytes(std::string_view(noise).substr(10)));
  bench.line->write(records);
  bench.run(400ms);
  ASSERT_EQ(bench.samples.size(), 2u);
  for (const Sample& sample : bench.samples) EXPECT_TRUE(tracker(sample).good());
  EXPECT_EQ(bench.driver.statistics().skipped_bytes - skipped, 29);
}

// A line that hung up in the first quarter of a second: the records of then began the count of the next
// stream, in which all until its first record were missed.
TEST(FastrakDriverLineTest, RecordsThatWaitedForTheirTimeAreNotOfTheNextStream) {
  Watch watch;
  Bench bench(unit("noise=0"), {}, watched(watch));
  ASSERT_TRUE(bench.run_until_streaming());
  bench.run(150ms);
  ASSERT_GT(bench.sent.size(), 10u);
  ASSERT_THAT(bench.samples, IsEmpty());
  watch.trouble = "it is gone";
  bench.run(5ms);
  watch.trouble = "";
  bench.run(1ms);
  ASSERT_FALSE(bench.driver.streaming());
  const Time back = bench.now;
  ASSERT_TRUE(bench.run_until_streaming());
  bench.run(1s);
  ASSERT_GT(bench.samples.size(), 60u);
  EXPECT_GT(tracker(bench.samples.front()).host_time, back);
  EXPECT_EQ(bench.driver.statistics().missed, 0);
}

TEST(FastrakDriverLineTest, APollTakesSixtyFourKilobytesOfAnEndlessLine) {
  Alone alone;
  alone.watch.comes.assign(100'000, '?');
  alone.driver.poll(alone.now, alone.samples);
  EXPECT_EQ(alone.watch.comes.size(), 100'000u - 65'536u);
}

}  // namespace
}  // namespace headpin::devices
