#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/math.h"
#include "files/input_file.h"

/// The container of LCM's event logs, read so that nothing in a damaged one can hurt.
///
/// liblcm's own reader allocates what a header claims and gives up at the first gap; this one takes
/// no size on trust and finds its place again. On whole logs both read the same (tested).
namespace headpin::devices {

/// One event of a log; channel and data point into the bytes it was read from.
struct LogEvent {
  std::int64_t number = 0;
  Time time{};  ///< its stamp; one that no clock shows, the nearest that might be
  std::string_view channel;
  std::span<const std::uint8_t> data;
};

/// A file, read piece by piece, so that its length costs no memory.
class FileWindow {
 public:
  /// @throws std::runtime_error  when the file cannot be opened or is not a regular file
  explicit FileWindow(const std::string& path) : file_(path) {}

  std::size_t size() const { return file_.size(); }

  /// The bytes from `at` on, until the next call; fewer where the file ends, or was cut meanwhile.
  /// @throws std::runtime_error  when they cannot be read
  std::span<const std::uint8_t> read(std::size_t at, std::size_t size);

 private:
  files::InputFile file_;
  std::size_t begin_ = 0;
  std::vector<std::uint8_t> piece_;  // from begin_ on
};

/// Walks the events of a log.
///
/// Each is a header of 28 bytes, big-endian (uint32 0xEDA1DA01, int64 number, int64 microseconds,
/// int32 length of the channel, int32 length of the data), the channel, the data. An event holds
/// together when it fits the file and is followed by another one, by the end, or by bytes without a
/// magic word inside it; else reading goes on at the next magic word.
class LogReader {
 public:
  explicit LogReader(std::span<const std::uint8_t> bytes) : bytes_(bytes), size_(bytes.size()) {}
  /// Channel and data of an event of a file are there until the next one is asked for.
  explicit LogReader(FileWindow& file) : file_(&file), size_(file.size()) {}

  /// The next whole event, or nothing at the end.
  std::optional<LogEvent> next();

  /// Bytes passed over between whole events.
  std::int64_t skipped_bytes() const { return skipped_bytes_; }
  /// Bytes of an event that the file ends in.
  std::int64_t cut_bytes() const { return cut_bytes_; }

 private:
  std::span<const std::uint8_t> bytes(std::size_t at, std::size_t size) const;
  std::size_t find_magic(std::size_t from) const;
  bool magic_at(std::size_t at) const;

  std::span<const std::uint8_t> bytes_;
  FileWindow* file_ = nullptr;  // in place of them
  std::size_t size_;
  std::size_t at_ = 0;
  std::int64_t skipped_bytes_ = 0;
  std::int64_t cut_bytes_ = 0;
};

/// Puts an event behind others, as a log has them.
void append(const LogEvent& event, std::vector<std::uint8_t>& out);

}  // namespace headpin::devices
