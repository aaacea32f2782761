#include "devices/lines/lasting_line.h"

#include <chrono>
#include <memory>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/devices/line_ends.h"
#include "tests/support/folder.h"

namespace headpin::devices {
namespace {

using Steady = std::chrono::steady_clock;

/// A unit that is switched off and on; its line has a descriptor, and no other program may have it.
struct SwitchedUnit {
  class Plugged : public ByteStream {
   public:
    explicit Plugged(SwitchedUnit& unit) : unit_(unit) { ++unit_.lines; }
    ~Plugged() override { --unit_.lines; }
    Plugged(const Plugged&) = delete;
    Plugged& operator=(const Plugged&) = delete;

    std::size_t read(std::span<std::uint8_t> out) override {
      if (closed() || !unit_.speaks || out.empty()) return 0;
      out[0] = '0';
      return 1;
    }
    std::size_t write(Bytes bytes) override {
      hung_up_ |= !unit_.on;
      return closed() ? 0 : bytes.size();
    }
    bool closed() const override { return hung_up_; }
    int descriptor() const override { return 7; }

   private:
    SwitchedUnit& unit_;
    bool hung_up_ = false;
  };

  std::unique_ptr<ByteStream> open() {
    ++tries;
    last_try = Steady::now();
    if (lines > 0) throw std::logic_error("the line is still open");
    if (!on) throw std::runtime_error("is off");
    return std::make_unique<Plugged>(*this);
  }

  bool on = true, speaks = false;
  int lines = 0;  ///< that are open
  int tries = 0;
  Steady::time_point last_try;
};

/// Switches the unit off; the line notices it when it is written to.
void switch_off(SwitchedUnit& unit, LastingLine& line) {
  unit.on = false;
  EXPECT_EQ(say(line, "P"), 0u);
}

void await_return(SwitchedUnit& unit, LastingLine& line) {
  unit.on = true;
  while (say(line, "S") == 0) ::poll(nullptr, 0, 1);  // it looks for the line now and then
}

TEST(LastingLineTest, ALineThatHungUpIsLetGoBeforeItIsOpenedAgain) {
  SwitchedUnit unit;
  LastingLine line("/dev/ttyUSB0", [&] { return unit.open(); });
  EXPECT_EQ(line.descriptor(), 7);
  switch_off(unit, line);
  EXPECT_EQ(say(line, "P"), 0u);
  EXPECT_EQ(line.descriptor(), -1);
  EXPECT_EQ(unit.lines, 0);
  await_return(unit, line);
  EXPECT_EQ(line.descriptor(), 7);
  EXPECT_EQ(line.trouble(), "");
}

TEST(LastingLineTest, IsLookedForNoMoreThanFiveTimesASecond) {
  SwitchedUnit unit;
  LastingLine line("/dev/ttyUSB0", [&] { return unit.open(); });
  switch_off(unit, line);
  Steady::time_point before{};
  while (unit.tries < 2) {
    before = Steady::now();
    std::array<std::uint8_t, 8> bytes{};
    EXPECT_EQ(line.read(bytes), 0u);
    ::poll(nullptr, 0, 1);
  }
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(say(line, "S"), 0u);
  EXPECT_LE(unit.tries - 2, (unit.last_try - before) / std::chrono::milliseconds(200));
  EXPECT_EQ(line.trouble(), "/dev/ttyUSB0 hung up; waiting for it to come back");
}

TEST(LastingLineTest, SaysOfEachTimeItWasOpenWhetherAWordCame) {
  SwitchedUnit unit;
  LastingLine line("tcp:unit:4001", [&] { return unit.open(); });
  unit.speaks = true;
  EXPECT_EQ(hear(line, 1), "0");
  switch_off(unit, line);
  EXPECT_EQ(line.trouble(), "tcp:unit:4001 hung up; waiting for it to come back");
  unit.speaks = false;
  await_return(unit, line);
  switch_off(unit, line);
  EXPECT_EQ(line.trouble(),
            "tcp:unit:4001 hung up without a word, as where another client has it; waiting for it "
            "to come back");
}

TEST(LastingLineTest, APortIsANumberFrom1To65535AndNothingElse) {
  const auto said = [](const std::string& port) {
    return complaint([&] { open_line(fmt::format("tcp:127.0.0.1:{}", port), 115200); });
  };
  for (const char* port : {"0", "65536", "-1", "", "1x", "1 ", "0x10", "99999999999"}) {
    EXPECT_EQ(
        said(port),
        fmt::format("tcp:127.0.0.1:{}: expected tcp:HOST:PORT, a port from 1 to 65535", port));
  }
  for (const char* port : {"1", "65535"}) {
    EXPECT_EQ(said(port),
              fmt::format("tcp:127.0.0.1:{}: nobody answers there: Connection refused", port));
  }
}

}  // namespace
}  // namespace headpin::devices
