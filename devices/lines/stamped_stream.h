#pragma once

#include <atomic>
#include <deque>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "devices/lines/byte_stream.h"

namespace headpin::devices {

/// A stream that a thread reads as soon as bytes arrive. Each piece gets the time just after the
/// read, however late it is used.
///
/// The clock is read after the data, so a stamp may be late but never early. Only the thread uses
/// the stream below, for writes too: a terminal's read can block for a second when the kernel's
/// worker thread gets no processor time, and the user of this stream must not wait for it.
class StampedStream : public ByteStream {
 public:
  /// Time on the session's clock; called from the thread too.
  using Clock = std::function<Time()>;

  StampedStream(std::unique_ptr<ByteStream> stream, Clock clock);
  ~StampedStream() override;
  StampedStream(const StampedStream&) = delete;
  StampedStream& operator=(const StampedStream&) = delete;

  /// Starts the thread that reads and writes.
  void start();
  /// Writes pending bytes and reads available ones. The thread calls this; without the thread, the
  /// owner of the clock does.
  void listen();

  /// @throws  what the stream below threw
  std::size_t read(std::span<std::uint8_t> out) override { return read_at({}, out).size; }
  /// The same with the time of arrival. @param now  not used
  Piece read_at(Time now, std::span<std::uint8_t> out) override;
  std::size_t write(Bytes bytes) override;
  bool closed() const override;
  std::string trouble() const override;
  void set_baud(int baud) override;
  bool has_baud() const override { return has_baud_; }

 private:
  struct Waiting {
    Time arrived;
    std::vector<std::uint8_t> bytes;
  };
  /// Something to be written, or a rate.
  struct Order {
    std::vector<std::uint8_t> bytes;
    int baud = 0;
  };
  void work();
  bool is_full() const;
  void carry_out_orders();
  void take_in();

  Clock clock_;
  std::unique_ptr<ByteStream> stream_;  ///< used only by the thread that listens
  const bool has_baud_;
  mutable std::mutex pile_;  ///< for the bytes that were read, and all members below
  std::deque<Waiting> pieces_;
  std::size_t waiting_ = 0;  ///< bytes in them
  std::deque<Order> orders_;
  std::size_t unwritten_ = 0;  ///< bytes in them
  std::string trouble_;
  bool closed_ = false;
  std::exception_ptr failure_;
  Time heard_out_{};  ///< time at which the line was empty
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace headpin::devices
