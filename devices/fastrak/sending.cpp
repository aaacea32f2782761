#include "devices/fastrak/sending.h"

#include <algorithm>
#include <utility>

namespace headpin::devices {
namespace {

constexpr std::size_t kOutboxLimit = 1024;  // bytes that a reader may leave
constexpr std::size_t kQueueLimit = 8192;   // bytes of answers waiting for the line

}  // namespace

bool FastrakSending::add(FastrakMessage message) {
  if (message.bytes.empty()) return true;
  std::size_t waiting = message.bytes.size();
  for (const FastrakMessage& other : queue_) waiting += other.bytes.size() - other.sent;
  if (waiting > kQueueLimit) return false;
  queue_.push_back(std::move(message));
  return true;
}

void FastrakSending::drop_unsent(bool only_stream) {
  std::erase_if(queue_, [&](const FastrakMessage& message) {
    return message.sent == 0 && (message.stream || !only_stream);
  });
}

bool FastrakSending::is_free() const {
  if (suspended_ || outbox_.size() >= kOutboxLimit) return false;
  // The last byte needs no more waiting; the next record may be written after it.
  return queue_.empty() ||
         (queue_.size() == 1 && queue_.front().sent + 1 >= queue_.front().bytes.size());
}

void FastrakSending::resume(Time now) {
  if (suspended_) line_free_ns_ = std::max<std::int64_t>(line_free_ns_, now.count() * 1000);
  suspended_ = false;
}

void FastrakSending::pump(Time now, const Line& line) {
  const std::int64_t now_ns = now.count() * 1000;
  const FastrakPort& port = line.port;
  const int bits = 1 + port.bits + (port.parity ? 1 : 0) + 1;  // start, data, parity, stop
  const std::int64_t byte_ns = bits * 1'000'000'000LL / port.baud;
  while (!queue_.empty() && !suspended_ && outbox_.size() < kOutboxLimit) {
    FastrakMessage& message = queue_.front();
    const std::int64_t start_ns = std::max(line_free_ns_, message.due.count() * 1000);
    if (message.sent == 0) {
      if (start_ns > now_ns) return;
      if (line.silent(Time{start_ns / 1000})) {
        queue_.pop_front();
        continue;
      }
    }
    if (start_ns + byte_ns > now_ns) return;
    const std::uint8_t byte = message.bytes[message.sent++];
    if (!message.lost) outbox_.push_back(port.bits == 7 ? byte & 0x7F : byte);
    line_free_ns_ = start_ns + byte_ns;
    if (message.sent < message.bytes.size()) continue;
    line.on_end(message);
    queue_.pop_front();
  }
}

void FastrakSending::taken(std::size_t count) {
  outbox_.erase(outbox_.begin(),
                outbox_.begin() + static_cast<std::ptrdiff_t>(std::min(count, outbox_.size())));
}

}  // namespace headpin::devices
