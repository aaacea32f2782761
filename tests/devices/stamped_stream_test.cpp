#include "devices/lines/stamped_stream.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <poll.h>
#include <unistd.h>

#include "tests/devices/line_ends.h"

namespace headpin::devices {
namespace {

/// A line that always has `ready` bytes to read, and counts how often it is asked about its trouble.
class AskedLine : public ByteStream {
 public:
  explicit AskedLine(std::size_t ready = 0) : ready_(ready) {}

  std::size_t read(std::span<std::uint8_t> out) override { return std::min(out.size(), ready_); }
  std::size_t write(Bytes bytes) override { return bytes.size(); }
  bool closed() const override { return false; }
  std::string trouble() const override {
    ++asked;
    return "unplugged";
  }
  int descriptor() const override { return fd; }

  int fd = -1;
  mutable std::atomic<int> asked{0};

 private:
  std::size_t ready_;
};

TEST(StampedStreamTest, APieceHasArrivedAfterItsReadAndNothingBeforeAnEmptyOne) {
  Time now{};
  const auto clock = [&now] { return now += Time{1}; };
  auto [unit, host] = memory_streams();
  StampedStream stamped(std::move(host), clock);
  say(*unit, "record");
  stamped.listen();  // reads from 1 us to 2 us, and finds nothing from 3 us to 4 us
  std::array<std::uint8_t, 16> bytes{};
  const ByteStream::Piece piece = stamped.read_at({}, bytes);
  EXPECT_EQ(piece.size, 6u);
  EXPECT_EQ(piece.arrived, Time{2});
  const ByteStream::Piece none = stamped.read_at({}, bytes);
  EXPECT_EQ(none.size, 0u);
  EXPECT_EQ(none.arrived, Time{3});
}

TEST(StampedStreamTest, TellsTheTroubleOfTheLine) {
  StampedStream stamped(std::make_unique<AskedLine>(), [] { return Time{}; });
  EXPECT_EQ(stamped.trouble(), "");
  stamped.listen();
  EXPECT_EQ(stamped.trouble(), "unplugged");
}

TEST(StampedStreamTest, Holds65536BytesInEachDirection) {
  StampedStream stamped(std::make_unique<AskedLine>(4096), [] { return Time{}; });
  EXPECT_EQ(say(stamped, std::string(70'000, 'x')), 65'536u);
  EXPECT_EQ(say(stamped, "x"), 0u);
  stamped.listen();
  EXPECT_EQ(say(stamped, "x"), 1u);

  std::array<std::uint8_t, 5000> bytes{};
  std::size_t heard = 0;
  while (const std::size_t n = stamped.read(bytes)) heard += n;
  EXPECT_EQ(heard, 65'536u);
}

/// How often the thread has looked at a line that cannot let it wait, each ms, when it has done so
/// 50 times.
double looks_each_ms(std::unique_ptr<AskedLine> owned) {
  const AskedLine& line = *owned;
  const auto start = std::chrono::steady_clock::now();
  StampedStream stamped(std::move(owned), [] { return Time{}; });
  stamped.start();
  while (line.asked < 50) std::this_thread::yield();
  const int looks = line.asked;
  const std::chrono::duration<double, std::milli> taken = std::chrono::steady_clock::now() - start;
  return looks / taken.count();
}

// Else it would take a processor for itself. A pause is 1 ms or longer.
TEST(StampedStreamTest, PausesAtALineThatHungUpAndWhereNobodyTakesWhatItRead) {
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe(ends.data()), 0);
  ASSERT_EQ(::write(ends[1], "x", 1), 1);
  auto full = std::make_unique<AskedLine>(4096);
  full->fd = ends[0];
  EXPECT_LE(looks_each_ms(std::move(full)), 1.1);

  char taken = 0;
  ASSERT_EQ(::read(ends[0], &taken, 1), 1);
  ::close(ends[1]);
  auto hung_up = std::make_unique<AskedLine>();
  hung_up->fd = ends[0];
  EXPECT_LE(looks_each_ms(std::move(hung_up)), 1.1);
  ::close(ends[0]);
}

}  // namespace
}  // namespace headpin::devices
