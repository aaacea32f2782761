// How the driver brings a unit up, and what it does when the unit or its line goes away.

#include <array>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/fastrak/driver.h"
#include "devices/fastrak/serving.h"
#include "devices/lines/lasting_line.h"
#include "devices/lines/tcp.h"
#include "tests/devices/fastrak_bench.h"
#include "tests/support/folder.h"

namespace headpin::devices {
namespace {

using namespace std::chrono_literals;
using test::Bench;
using test::tracker;
using test::unit;

/// Every good sample has the true pose at the time of its record.
void expect_true_poses(const Bench& bench) {
  for (std::size_t i = 0; i < bench.samples.size(); ++i) {
    const TrackerSample& s = tracker(bench.samples[i]);
    const Pose truth = circling_motion(s.station, bench.sent[i].measured).X_TS;
    EXPECT_LT((s.X_TS.p - truth.p).norm(), 1e-6);
    EXPECT_LT(s.X_TS.q.angularDistance(truth.q), 1e-6);
    EXPECT_TRUE(s.good());
  }
}

TEST(FastrakDriverTest, TakesOverAUnitInWhateverStateItWasLeft) {
  const std::vector<std::string> states = {
      "",
      "C",                                  // streaming in ASCII
      "fuC",                                // in binary, centimetres
      "O1,2,4\rO2,16\rfC",                  // records without an end
      "C\x13",                              // streaming, suspended
      "O1,2,11",                            // a half-typed line
      "XC",                                 // a half-typed line that swallows what follows
      "A1,10,0,0,10,10,0,0,0,0\rB1\rB2\r",  // other frames
      "r1,90,0,0\rI1,50\rI2,50\rC",         // still receivers held back
      "V1,1,1,1\rV2,1,1,1\rQ1,1,1,1\rC",    // envelopes that mark every record
      "l1,0\rl2,0\r",                       // all stations off
      "H1,-1,0,0\rH2,-1,0,0\rx5\rv5\r",     // wrong hemisphere, heavy filters
      "N1,2.5,0,0\rN2,0,3,0\r",             // tip offsets
      "e1,1\ry1\rXa unit\rD",
      "o,N,7,0\rfuC",  // at seven bits, in binary
      "o,E,7,0\rU",    // with parity, in inches
      "fC\x0b"};       // saving a streaming set-up
  for (const std::string& state : states) {
    SCOPED_TRACE(testing::PrintToString(state));
    FastrakOptions options;
    Bench bench(unit("noise=0"), options);
    bench.emulator.receive(Bytes(reinterpret_cast<const std::uint8_t*>(state.data()), state.size()),
                           bench.now);
    for (int ms = 0; ms < 300; ++ms) serve(bench.emulator, *bench.line, bench.now += 1ms);
    ASSERT_TRUE(bench.run_until_streaming());
    bench.sent.clear();
    bench.run(1s);
    ASSERT_GT(bench.samples.size(), 100u);
    expect_true_poses(bench);
  }
}

/// A line on which the driver's commands with a certain beginning are lost, so many times.
class Forgetful : public ByteStream {
 public:
  Forgetful(std::unique_ptr<ByteStream> line, std::string command, int times)
      : line_(std::move(line)), command_(std::move(command)), times_(times) {}
  std::size_t read(std::span<std::uint8_t> out) override { return line_->read(out); }
  std::size_t write(Bytes bytes) override {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (!text.starts_with(command_) || times_ == 0) return line_->write(bytes);
    --times_;
    return bytes.size();
  }
  bool closed() const override { return line_->closed(); }

 private:
  std::unique_ptr<ByteStream> line_;
  std::string command_;
  int times_;
};

// What makes good-looking wrong samples is not believed before it is read back.
TEST(FastrakDriverTest, ASettingThatWasLostIsSetAgain) {
  for (const std::string command : {"u", "H2,", "R1", "N1,", "r1,", "O1,"}) {
    SCOPED_TRACE(command);
    auto [line, host] = memory_streams();
    Bench bench(unit("noise=0"), {},
                {std::move(line), std::make_unique<Forgetful>(std::move(host), command, 1)});
    const std::string left = "H2,-1,0,0\rA1,10,0,0,10,10,0,0,0,0\rN1,2.5,0,0\rr1,90,0,0\r";
    bench.emulator.receive(Bytes(reinterpret_cast<const std::uint8_t*>(left.data()), left.size()),
                           bench.now);
    ASSERT_TRUE(bench.run_until_streaming());
    EXPECT_GT(bench.driver.statistics().attempts, 1);
    bench.sent.clear();
    bench.run(1s);
    ASSERT_GT(bench.samples.size(), 60u);
    expect_true_poses(bench);
  }
}

// A unit that will not widen an envelope flags what is beyond it, so its samples can be used.
TEST(FastrakDriverTest, ASettingThatRecordsShowThemselvesIsOnlyMentioned) {
  auto [line, host] = memory_streams();
  Bench bench(unit("noise=0"), {},
              {std::move(line), std::make_unique<Forgetful>(std::move(host), "V1,", 100)});
  ASSERT_TRUE(bench.run_until_streaming());
  EXPECT_EQ(bench.driver.statistics().attempts, 1);
  EXPECT_THAT(bench.driver.unconfirmed(), testing::ElementsAre("V1: set, and reads otherwise"));
}

TEST(FastrakDriverTest, AUnitThatIsJustStartingUpIsWaitedFor) {
  Bench bench(unit(), {});
  bench.emulator.power_cycle(bench.now);
  EXPECT_TRUE(bench.run_until_streaming(30s));
  EXPECT_GT(bench.now, 10s);
}

TEST(FastrakDriverTest, SilenceIsNoticedAndOvercome) {
  Bench bench(unit("silence=4@10"), {});
  bench.run(30s);
  const auto& s = bench.driver.statistics();
  EXPECT_GE(s.restarts, 1);
  EXPECT_TRUE(bench.driver.streaming());
  // In order, and none twice.
  std::array<std::int64_t, 2> last = {-1, -1};
  for (const Sample& sample : bench.samples) {
    const TrackerSample& t = tracker(sample);
    std::int64_t& previous = last[static_cast<std::size_t>(t.station - 1)];
    EXPECT_GT(t.sequence, previous);
    previous = t.sequence;
  }
  EXPECT_GT(device_time(bench.samples.back()), 29s);
}

TEST(FastrakDriverTest, APowerCycleIsOvercome) {
  Bench bench(unit(), {});
  ASSERT_TRUE(bench.run_until_streaming());
  bench.run(2s);
  bench.emulator.power_cycle(bench.now);
  bench.run(40s);
  EXPECT_TRUE(bench.driver.streaming());
  EXPECT_EQ(bench.driver.statistics().restarts, 1);
  EXPECT_GT(device_time(bench.samples.back()), bench.now - 100ms);
}

TEST(FastrakDriverTest, OnlyWantedStationsStream) {
  FastrakOptions options;
  options.stations = {false, true, false, false};
  Bench bench(unit(), options);
  ASSERT_TRUE(bench.run_until_streaming());
  bench.run(500ms);
  bench.samples.clear();
  bench.run(1s);
  EXPECT_NEAR(static_cast<double>(bench.samples.size()), 120.0, 1.0);  // the rate of one
  for (const Sample& sample : bench.samples) EXPECT_EQ(tracker(sample).station, 2);
}

/// A unit that can be pulled out and put back under the same name.
class Adapter {
 public:
  virtual ~Adapter() = default;
  virtual std::string name() const = 0;
  virtual std::unique_ptr<ByteStream> plug_in() = 0;
};

class Tty : public Adapter {
 public:
  std::string name() const override { return path_; }
  std::unique_ptr<ByteStream> plug_in() override { return std::make_unique<PseudoTerminal>(path_); }

 private:
  std::string path_ = (fresh_folder("unit") / "tty").string();
};

class Ethernet : public Adapter {
 public:
  std::string name() const override { return "tcp:127.0.0.1:" + std::to_string(port_); }
  std::unique_ptr<ByteStream> plug_in() override {
    auto server = std::make_unique<TcpServer>(port_);
    port_ = server->port();
    return server;
  }

 private:
  int port_ = 0;
};

// The unit is switched off and on, or its adapter pulled out and put back: it goes on by itself.
void a_line_that_hangs_up_and_comes_back_goes_on(Adapter& adapter) {
  std::unique_ptr<ByteStream> line = adapter.plug_in();
  auto emulator = std::make_unique<FastrakEmulator>(unit("noise=0"), circling_motion);
  Clocks clocks;
  FastrakDriver driver(open_line(adapter.name(), 115200), clocks);
  Time now{};
  std::vector<Sample> samples;
  const auto run_until = [&](auto reached) {
    const Time end = now + 60s;
    for (; now < end && !reached(); now += 1ms) {
      if (line) serve(*emulator, *line, now);
      driver.poll(now, samples);
      std::this_thread::sleep_for(100us);  // the line takes its own time
    }
    EXPECT_TRUE(reached()) << driver.activity();
  };
  run_until([&] { return samples.size() >= 100; });
  const std::size_t before = samples.size();
  line.reset();
  run_until([&] { return !driver.streaming() || !driver.trouble().empty(); });
  EXPECT_THAT(driver.activity(), testing::HasSubstr(adapter.name() + " hung up; waiting"));
  EXPECT_FALSE(driver.exhausted());
  emulator = std::make_unique<FastrakEmulator>(unit("noise=0"), circling_motion);  // as new
  now += 5s;
  line = adapter.plug_in();
  run_until([&] { return samples.size() >= before + 100; });
  for (std::size_t i = 1; i < samples.size(); ++i) {
    EXPECT_GT(device_time(samples[i]), device_time(samples[i - 1]));
    EXPECT_GE(tracker(samples[i]).sequence, tracker(samples[i - 1]).sequence);
  }
}

TEST(FastrakDriverTest, ASerialLineThatHangsUpAndComesBackGoesOn) {
  Tty tty;
  a_line_that_hangs_up_and_comes_back_goes_on(tty);
}

TEST(FastrakDriverTest, SoDoesOneBehindAnEthernetAdapter) {
  Ethernet ethernet;
  a_line_that_hangs_up_and_comes_back_goes_on(ethernet);
}

// Of a TCP line it told the rate that it was searching, as if that line had one.
TEST(FastrakDriverTest, OnlyALineWithARateIsSearchedForIt) {
  const TcpServer silent(0);
  auto [unit_end, host_end] = memory_streams();
  for (const bool tcp : {true, false}) {
    Clocks clocks;
    FastrakDriver driver(tcp ? open_line(silent.name(), 115200) : std::move(host_end), clocks);
    std::vector<Sample> none;
    for (Time now{}; driver.statistics().attempts < 20; now += 10ms) driver.poll(now, none);
    EXPECT_THAT(driver.activity(), testing::HasSubstr("(attempt 20"));
    EXPECT_EQ(driver.activity().find("baud") == std::string::npos, tcp) << driver.activity();
  }
}

TEST(FastrakDriverTest, ALineThatCannotBeOpenedIsNamed) {
  for (const char* name :
       {"", "tcp:", "tcp:localhost", "tcp:localhost:0", "tcp:localhost:x", "tcp::1"}) {
    EXPECT_THROW(open_line(name, 115200), std::invalid_argument) << name;
  }
  EXPECT_THROW(open_line("/nowhere/tty", 115200), std::runtime_error);
  EXPECT_THROW(open_line("tcp:127.0.0.1:1", 115200), std::runtime_error);
}

}  // namespace
}  // namespace headpin::devices
