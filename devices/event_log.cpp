#include "devices/event_log.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace headpin::devices {
namespace {

constexpr std::array<std::uint8_t, 4> kMagic = {0xED, 0xA1, 0xDA, 0x01};
constexpr std::size_t kHeaderSize = 28;
constexpr std::size_t kLongestChannel = 999;  // liblcm's own bound; its publishers keep to 63

std::uint64_t big_endian(std::span<const std::uint8_t> bytes) {
  std::uint64_t value = 0;
  for (const std::uint8_t byte : bytes) value = value << 8 | byte;
  return value;
}

}  // namespace

std::size_t LogReader::find_magic(std::size_t from) const {
  const auto found = std::search(bytes_.begin() + static_cast<std::ptrdiff_t>(from), bytes_.end(),
                                 kMagic.begin(), kMagic.end());
  return static_cast<std::size_t>(found - bytes_.begin());
}

bool LogReader::magic_at(std::size_t at) const {
  return bytes_.size() - at >= kMagic.size() &&
         std::equal(kMagic.begin(), kMagic.end(), bytes_.begin() + static_cast<std::ptrdiff_t>(at));
}

std::optional<LogEvent> LogReader::next() {
  for (;;) {
    const std::size_t start = find_magic(at_);
    if (start == bytes_.size()) {
      const std::size_t rest = bytes_.size() - at_;
      (rest < kMagic.size() ? cut_bytes_ : skipped_bytes_) += static_cast<std::int64_t>(rest);
      at_ = start;
      return std::nullopt;
    }
    skipped_bytes_ += static_cast<std::int64_t>(start - at_);
    at_ = start;
    const std::size_t left = bytes_.size() - start;

    const bool whole_header = left >= kHeaderSize;
    bool sane = false, fits = false;
    std::size_t channel_size = 0, data_size = 0;
    if (whole_header) {
      channel_size = big_endian(bytes_.subspan(start + 20, 4));
      data_size = big_endian(bytes_.subspan(start + 24, 4));
      sane = channel_size >= 1 && channel_size <= kLongestChannel && data_size <= 0x7fffffff;
      fits = sane && kHeaderSize + channel_size + data_size <= left;
    }
    const std::size_t end = fits ? start + kHeaderSize + channel_size + data_size : 0;
    const bool ends_well = fits && (end == bytes_.size() || magic_at(end));
    if (!ends_well) {
      const std::size_t next_magic = find_magic(start + kMagic.size());
      if (!fits && (sane || !whole_header) && next_magic == bytes_.size()) {
        cut_bytes_ += static_cast<std::int64_t>(left);
        at_ = bytes_.size();
        return std::nullopt;
      }
      if (!fits || next_magic < end) {
        skipped_bytes_ += static_cast<std::int64_t>(next_magic - start);
        at_ = next_magic;
        continue;
      }
    }
    at_ = end;
    const auto number = static_cast<std::int64_t>(big_endian(bytes_.subspan(start + 4, 8)));
    const auto time = static_cast<std::int64_t>(big_endian(bytes_.subspan(start + 12, 8)));
    const auto* text = reinterpret_cast<const char*>(bytes_.data() + start + kHeaderSize);
    return LogEvent{number, Time{time}, std::string_view(text, channel_size),
                    bytes_.subspan(start + kHeaderSize + channel_size, data_size)};
  }
}

MappedFile::MappedFile(const std::string& path) {
  const auto fail = [&](const char* doing) {
    throw std::runtime_error(path + ": " + doing + ": " + std::strerror(errno));
  };
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) fail("cannot open");
  struct stat status {};
  const bool regular = fstat(file, &status) == 0 && S_ISREG(status.st_mode);
  void* memory = nullptr;
  if (regular && status.st_size > 0) {
    memory =
        mmap(nullptr, static_cast<std::size_t>(status.st_size), PROT_READ, MAP_PRIVATE, file, 0);
  }
  close(file);
  if (!regular) throw std::runtime_error(path + ": expected a file, found something else");
  if (memory == MAP_FAILED) fail("cannot map");
  bytes_ = {static_cast<const std::uint8_t*>(memory), static_cast<std::size_t>(status.st_size)};
}

MappedFile::~MappedFile() {
  if (!bytes_.empty()) munmap(const_cast<std::uint8_t*>(bytes_.data()), bytes_.size());
}

}  // namespace headpin::devices
