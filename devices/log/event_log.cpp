#include "devices/log/event_log.h"

#include <algorithm>
#include <array>

#include "devices/base/bytes.h"

namespace headpin::devices {
namespace {

constexpr std::array<std::uint8_t, 4> kMagic = {0xED, 0xA1, 0xDA, 0x01};
constexpr std::size_t kHeaderSize = 28;
/// Stamps beyond this [us] are impossible and are replaced by it, so that any two can be
/// subtracted.
constexpr std::int64_t kFarthest = 4'000'000'000'000'000;
constexpr std::size_t kLongestChannel = 999;  // liblcm's own bound; its publishers keep to 63

}  // namespace

std::span<const std::uint8_t> LogReader::bytes(std::size_t at, std::size_t size) const {
  if (file_) return file_->read(at, size);
  return bytes_.subspan(at, std::min(size, size_ - at));
}

std::size_t LogReader::find_magic(std::size_t from) const {
  constexpr std::size_t kPiece = 1 << 16;
  for (std::size_t at = from; at + kMagic.size() <= size_; at += kPiece - kMagic.size() + 1) {
    const std::span<const std::uint8_t> piece = bytes(at, kPiece);
    const auto found = std::search(piece.begin(), piece.end(), kMagic.begin(), kMagic.end());
    if (found != piece.end()) return at + static_cast<std::size_t>(found - piece.begin());
  }
  return size_;
}

bool LogReader::magic_at(std::size_t at) const {
  return std::ranges::equal(bytes(at, kMagic.size()), kMagic);
}

std::optional<LogEvent> LogReader::next() {
  for (;;) {
    const std::size_t start = find_magic(at_);
    if (start == size_) {
      const std::size_t rest = size_ - at_;
      (rest < kMagic.size() ? cut_bytes_ : skipped_bytes_) += static_cast<std::int64_t>(rest);
      at_ = start;
      return std::nullopt;
    }
    skipped_bytes_ += static_cast<std::int64_t>(start - at_);
    at_ = start;
    const std::size_t left = size_ - start;

    const bool whole_header = left >= kHeaderSize;
    bool sane = false, fits = false;
    std::size_t channel_size = 0, data_size = 0;
    const std::span<const std::uint8_t> header = bytes(start, kHeaderSize);
    if (whole_header && header.size() == kHeaderSize) {
      channel_size = big_endian(header.subspan(20, 4));
      data_size = big_endian(header.subspan(24, 4));
      sane = channel_size >= 1 && channel_size <= kLongestChannel && data_size <= 0x7fffffff;
      fits = sane && kHeaderSize + channel_size + data_size <= left;
    }
    const std::size_t end = fits ? start + kHeaderSize + channel_size + data_size : 0;
    const bool ends_well = fits && (end == size_ || magic_at(end));
    if (!ends_well) {
      const std::size_t next_magic = find_magic(start + kMagic.size());
      if (!fits && (sane || !whole_header) && next_magic == size_) {
        cut_bytes_ += static_cast<std::int64_t>(left);
        at_ = size_;
        return std::nullopt;
      }
      if (!fits || next_magic < end) {
        skipped_bytes_ += static_cast<std::int64_t>(next_magic - start);
        at_ = next_magic;
        continue;
      }
    }
    at_ = end;
    const std::span<const std::uint8_t> event = bytes(start, end - start);
    if (event.size() < end - start) {  // the file was cut since
      at_ = size_;
      return std::nullopt;
    }
    const auto number = static_cast<std::int64_t>(big_endian(event.subspan(4, 8)));
    const auto time = static_cast<std::int64_t>(big_endian(event.subspan(12, 8)));
    const auto* text = reinterpret_cast<const char*>(event.data() + kHeaderSize);
    return LogEvent{number, Time{std::clamp(time, -kFarthest, kFarthest)},
                    std::string_view(text, channel_size),
                    event.subspan(kHeaderSize + channel_size)};
  }
}

std::span<const std::uint8_t> FileWindow::read(std::size_t at, std::size_t size) {
  size = at < this->size() ? std::min(size, this->size() - at) : 0;
  if (at < begin_ || at + size > begin_ + piece_.size()) {
    constexpr std::size_t kPiece = 1 << 20;
    piece_.resize(std::min(std::max(size, kPiece), this->size() - std::min(at, this->size())));
    begin_ = at;
    piece_.resize(file_.read(at, piece_));
  }
  const std::size_t from = std::min(at - begin_, piece_.size());
  return std::span(piece_).subspan(from, std::min(size, piece_.size() - from));
}

void append(const LogEvent& event, std::vector<std::uint8_t>& out) {
  const auto big_endian = [&out](auto number) {
    for (int shift = 8 * static_cast<int>(sizeof number) - 8; shift >= 0; shift -= 8) {
      out.push_back(static_cast<std::uint8_t>(number >> shift));
    }
  };
  out.insert(out.end(), kMagic.begin(), kMagic.end());
  big_endian(event.number);
  big_endian(std::int64_t{event.time.count()});
  big_endian(static_cast<std::int32_t>(event.channel.size()));
  big_endian(static_cast<std::int32_t>(event.data.size()));
  out.insert(out.end(), event.channel.begin(), event.channel.end());
  out.insert(out.end(), event.data.begin(), event.data.end());
}

}  // namespace headpin::devices
