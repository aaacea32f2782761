#pragma once

#include <atomic>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "devices/byte_stream.h"

namespace headpin::devices {

/// A stream that is read as soon as something arrives, each piece stamped right behind the read,
/// however late its user comes for it.
///
/// The clock is asked after a read, so a stamp may be late but never early. Everything else goes
/// through to the stream below.
class StampedStream : public ByteStream {
 public:
  /// Time on the session's clock; called from the thread too.
  using Clock = std::function<Time()>;

  StampedStream(std::unique_ptr<ByteStream> stream, Clock clock);
  ~StampedStream() override;
  StampedStream(const StampedStream&) = delete;
  StampedStream& operator=(const StampedStream&) = delete;

  /// Reads from now on in a thread of its own.
  void start();
  /// Takes in what is there. The thread does nothing else; without it, whoever has the clock must.
  void listen();

  std::size_t read(std::span<std::uint8_t> out) override;
  /// When all that had arrived by then was last taken in: what is missing, this one may still owe.
  Time time(Time now) const override;
  Time arrived(Time) const override { return stamp_; }
  std::size_t write(Bytes bytes) override;
  bool closed() const override;
  std::string trouble() const override;
  void set_baud(int baud) override;

 private:
  struct Piece {
    Time time;
    std::vector<std::uint8_t> bytes;
  };
  void work();

  Clock clock_;
  mutable std::mutex line_;  ///< of the stream below
  std::unique_ptr<ByteStream> stream_;
  mutable std::mutex pile_;  ///< of what was read
  std::deque<Piece> pieces_;
  std::size_t waiting_ = 0;  ///< bytes in them
  Time stamp_{};             ///< of what was handed out last
  Time heard_out_{};         ///< nothing was left on the line then
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace headpin::devices
