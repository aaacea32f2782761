#pragma once

#include <chrono>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>

#include "base/output_file.h"

namespace headpin::apps {

/// A piece that does not follow what is there.
struct WrongPlace : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A log that another program sends in pieces. The file has its name from the start, and is synced
/// to the disk every second.
class IncomingLog {
 public:
  /// @throws as base::OutputFile; an existing file is not replaced
  explicit IncomingLog(const std::string& path);

  const std::string& path() const { return file_.path(); }
  /// Bytes of it that are there. What somebody else has truncated is expected again.
  std::int64_t size();

  /// Adds a piece. What is there already, as of a piece that is sent again, must be the same.
  ///
  /// @param at  where the piece begins [bytes]
  /// @return    the bytes of it that have never come before
  /// @throws WrongPlace          for a piece that leaves a gap, or differs from what is there
  /// @throws std::runtime_error  when it cannot be written; then nothing of it stays
  std::span<const std::uint8_t> add(std::int64_t at, std::span<const std::uint8_t> piece);

  /// Syncs the file to the disk: it is whole.
  void close();

 private:
  void sync_each_second(std::int64_t size);
  void require_same(std::int64_t at, std::span<const std::uint8_t> piece) const;

  base::OutputFile file_;
  std::int64_t size_ = 0;     ///< without what was truncated
  std::int64_t longest_ = 0;  ///< that it ever was
  bool closed_ = false;
  std::chrono::steady_clock::time_point synced_ = std::chrono::steady_clock::now();
};

}  // namespace headpin::apps
