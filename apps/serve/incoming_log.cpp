#include "apps/serve/incoming_log.h"

#include <algorithm>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "base/input_file.h"

namespace headpin::apps {

IncomingLog::IncomingLog(const std::string& path) : file_(path, {.live = true, .regular = true}) {}

std::int64_t IncomingLog::size() {
  if (!closed_) size_ = std::min(size_, file_.length());
  return size_;
}

std::span<const std::uint8_t> IncomingLog::add(std::int64_t at,
                                               std::span<const std::uint8_t> piece) {
  const std::int64_t there = size();
  if (at < 0 || at > there) {
    throw WrongPlace(fmt::format("expected a piece from byte {} on, found one from {}", there, at));
  }
  const std::size_t known = std::min(piece.size(), static_cast<std::size_t>(there - at));
  require_same(at, piece.first(known));
  const std::span<const std::uint8_t> fresh = piece.subspan(known);
  const std::int64_t size = there + static_cast<std::int64_t>(fresh.size());
  try {
    file_.write(fresh.data(), fresh.size());
    sync_each_second(size);
  } catch (const std::runtime_error&) {
    file_.cut_back(there);
    throw;
  }
  size_ = size;
  const auto seen = static_cast<std::size_t>(longest_ - at);
  longest_ = std::max(longest_, size_);
  return piece.subspan(std::min(piece.size(), seen));
}

void IncomingLog::sync_each_second(std::int64_t size) {
  const auto now = std::chrono::steady_clock::now();
  if (now - synced_ < std::chrono::seconds(1)) return;
  file_.require_kept(size);
  file_.sync();
  synced_ = now;
}

void IncomingLog::require_same(std::int64_t at, std::span<const std::uint8_t> piece) const {
  if (piece.empty()) return;
  base::InputFile there(file_.path());
  std::vector<std::uint8_t> bytes(piece.size());
  const std::size_t read = there.read(static_cast<std::size_t>(at), bytes);
  if (read != piece.size() || !std::ranges::equal(bytes, piece)) {
    throw WrongPlace(fmt::format("the bytes from {} on are not those that are there", at));
  }
}

void IncomingLog::close() {
  file_.require_kept(size_);
  file_.commit();
  closed_ = true;
}

}  // namespace headpin::apps
