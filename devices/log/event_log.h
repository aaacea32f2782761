#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/input_file.h"
#include "base/math.h"

/// Reads and writes LCM's event logs; damaged logs are read safely.
///
/// The reader stays our own: liblcm's allocates the size that a header claims, and stops at the
/// first gap. This one checks every size and continues at the next event. On undamaged logs both
/// read the same (tested).
namespace headpin::devices {

/// A longer gap between samples means damage, unless the caller accepts it.
constexpr Time kLongestGap{60'000'000};

/// One event of a log; channel and data point into the bytes it was read from.
struct LogEvent {
  std::int64_t number = 0;
  Time time{};  ///< its time stamp; an impossible one becomes the nearest possible one
  std::string_view channel;
  std::span<const std::uint8_t> data;
};

/// A file that is read in pieces, so that memory does not depend on its length.
class FileWindow {
 public:
  /// @throws std::runtime_error  when the file cannot be opened or is not a regular file
  explicit FileWindow(const std::string& path) : file_(path) {}

  std::size_t size() const { return file_.size(); }

  /// The bytes from `at`, valid until the next call; fewer at the end of the file.
  /// @throws std::runtime_error  when they cannot be read
  std::span<const std::uint8_t> read(std::size_t at, std::size_t size);

 private:
  base::InputFile file_;
  std::size_t begin_ = 0;
  std::vector<std::uint8_t> piece_;  // from begin_ on
};

/// Reads the events of a log in order.
///
/// Each is a header of 28 bytes, big-endian (uint32 0xEDA1DA01, int64 number, int64 microseconds,
/// int32 length of the channel, int32 length of the data), the channel, the data. An event is valid
/// if it fits into the file and is followed by another event, by the end, or by bytes, without a
/// magic word inside it; else reading continues at the next magic word.
class LogReader {
 public:
  explicit LogReader(std::span<const std::uint8_t> bytes) : bytes_(bytes), size_(bytes.size()) {}
  /// Channel and data of an event are valid until the next call of next().
  explicit LogReader(FileWindow& file) : file_(&file), size_(file.size()) {}

  /// The next whole event, or nothing at the end.
  std::optional<LogEvent> next();

  /// Number of skipped bytes between complete events.
  std::int64_t skipped_bytes() const { return skipped_bytes_; }
  /// Number of bytes of an incomplete last event.
  std::int64_t cut_bytes() const { return cut_bytes_; }

 private:
  std::span<const std::uint8_t> bytes(std::size_t at, std::size_t size) const;
  std::size_t find_magic(std::size_t from) const;
  bool magic_at(std::size_t at) const;

  std::span<const std::uint8_t> bytes_;
  FileWindow* file_ = nullptr;  // used instead of them
  std::size_t size_;
  std::size_t at_ = 0;
  std::int64_t skipped_bytes_ = 0;
  std::int64_t cut_bytes_ = 0;
};

/// Appends an event to the bytes of a log.
void append(const LogEvent& event, std::vector<std::uint8_t>& out);

}  // namespace headpin::devices
