#include "devices/lines/stamped_stream.h"

#include <algorithm>
#include <array>
#include <chrono>

#include <poll.h>

namespace headpin::devices {
namespace {

constexpr std::size_t kLimit = 1 << 16;  // bytes; a user who leaves more does not read any more
constexpr int kNap_ms = 4;               // between checks of a silent line

}  // namespace

StampedStream::StampedStream(std::unique_ptr<ByteStream> stream, Clock clock)
    : clock_(std::move(clock)), stream_(std::move(stream)), has_baud_(stream_->has_baud()) {}

StampedStream::~StampedStream() {
  stopping_ = true;
  if (thread_.joinable()) thread_.join();
}

void StampedStream::start() {
  thread_ = std::thread([this] { work(); });
}

void StampedStream::work() {
  try {
    while (!stopping_) {
      pollfd line{stream_->descriptor(), POLLIN, 0};
      // A line without a descriptor, or one that hung up, would not let poll wait.
      const int ready = ::poll(&line, 1, line.fd >= 0 ? kNap_ms : 1);
      const bool hung_up = ready > 0 && !(line.revents & POLLIN);
      listen();
      if (hung_up || is_full()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  } catch (...) {
    const std::lock_guard lock(pile_);
    failure_ = std::current_exception();
  }
}

bool StampedStream::is_full() const {
  const std::lock_guard lock(pile_);
  return waiting_ >= kLimit;
}

void StampedStream::listen() {
  carry_out_orders();
  take_in();
  std::string trouble = stream_->trouble();
  const bool closed = stream_->closed();
  const std::lock_guard lock(pile_);
  trouble_ = std::move(trouble);
  closed_ = closed;
}

void StampedStream::carry_out_orders() {
  for (;;) {
    Order order;
    {
      const std::lock_guard lock(pile_);
      if (orders_.empty()) return;
      order = std::move(orders_.front());
      orders_.pop_front();
    }
    if (order.baud != 0) stream_->set_baud(order.baud);
    const std::size_t taken = order.bytes.empty() ? 0 : stream_->write(order.bytes);
    const std::lock_guard lock(pile_);
    unwritten_ -= taken;
    if (taken == order.bytes.size()) continue;
    order.bytes.erase(order.bytes.begin(),
                      order.bytes.begin() + static_cast<std::ptrdiff_t>(taken));
    orders_.push_front({std::move(order.bytes), 0});
    return;
  }
}

void StampedStream::take_in() {
  std::array<std::uint8_t, 4096> bytes{};
  for (;;) {
    if (is_full()) return;
    const Time before = clock_();
    const std::size_t n = stream_->read(bytes);
    const Time now = clock_();
    const std::lock_guard lock(pile_);
    heard_out_ = n == 0 ? before : now;
    if (n == 0) return;
    pieces_.push_back({now, {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(n)}});
    waiting_ += n;
  }
}

/// Reads from one piece at a time, because all bytes of one call have one time stamp.
ByteStream::Piece StampedStream::read_at(Time, std::span<std::uint8_t> out) {
  const std::lock_guard lock(pile_);
  if (failure_) std::rethrow_exception(failure_);
  if (pieces_.empty()) return {0, heard_out_};
  Waiting& piece = pieces_.front();
  const std::size_t n = std::min(out.size(), piece.bytes.size());
  const auto end = piece.bytes.begin() + static_cast<std::ptrdiff_t>(n);
  std::copy(piece.bytes.begin(), end, out.begin());
  piece.bytes.erase(piece.bytes.begin(), end);
  const Time arrived = piece.arrived;
  if (piece.bytes.empty()) pieces_.pop_front();
  waiting_ -= n;
  return {n, arrived};
}

std::size_t StampedStream::write(Bytes bytes) {
  const std::lock_guard lock(pile_);
  const std::size_t n = std::min(bytes.size(), kLimit - std::min(kLimit, unwritten_));
  if (n == 0) return 0;
  const Bytes taken = bytes.first(n);
  orders_.push_back({{taken.begin(), taken.end()}, 0});
  unwritten_ += n;
  return n;
}

bool StampedStream::closed() const {
  const std::lock_guard lock(pile_);
  return pieces_.empty() && closed_;
}

std::string StampedStream::trouble() const {
  const std::lock_guard lock(pile_);
  return trouble_;
}

void StampedStream::set_baud(int baud) {
  const std::lock_guard lock(pile_);
  orders_.push_back({{}, baud});
}

}  // namespace headpin::devices
