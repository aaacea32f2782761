#pragma once

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <lcm/lcm.h>
#include <sys/socket.h>

#include "devices/lcm/link.h"
#include "devices/trial/event_log.h"
#include "devices/trial/log.h"
#include "devices/trial/sources.h"

/// The inside of an LcmLink, for link.cpp and source.cpp.
namespace headpin::devices {

struct LcmLink::Lcm {
  lcm_t* handle = nullptr;
  bool has_server = false;

  /// Whether the server of tcpq has closed the connection. liblcm would then connect again, which may
  /// block, and it aborts when it waits for messages without a socket.
  bool lost() const {
    if (!has_server) return false;
    const int fd = lcm_get_fileno(handle);
    if (fd < 0) return true;
    char next = 0;
    const ssize_t n = recv(fd, &next, 1, MSG_PEEK | MSG_DONTWAIT);
    return n == 0 || (n < 0 && errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR);
  }
  /// @throws std::runtime_error  when the connection is lost
  void require_server(const LcmUrl& url) const {
    if (lost()) throw std::runtime_error(url.name() + ": the LCM server has closed the connection");
  }

  ~Lcm() {
    if (handle) lcm_destroy(handle);
  }
};

/// A log that is written. It stays our own code, because liblcm truncates any existing file of that
/// name and does not report write errors.
class LcmLink::LogWriter {
 public:
  LogWriter(const std::string& path, files::OutputFile::Options options)
      : file_(path, std::move(options)) {}

  void write(const std::string& channel, std::span<const std::uint8_t> bytes) {
    const auto now = std::chrono::system_clock::now().time_since_epoch();  // like liblcm's stamps
    bytes_.clear();
    append({number_++, std::chrono::duration_cast<Time>(now), channel, bytes}, bytes_);
    file_.write(bytes_.data(), bytes_.size());
  }

 private:
  files::OutputFile file_;
  std::int64_t number_ = 0;
  std::vector<std::uint8_t> bytes_;
};

/// A log that is played. Our own reader reads damaged logs safely.
class LcmLink::LogPlayer {
 public:
  explicit LogPlayer(const UrlOfLog& log)
      : file_(log.path), reader_(file_), next_(reader_.next()), speed_(log.speed) {
    if (!next_) throw std::runtime_error(log.path + ": not an LCM event log: no whole event");
    while (next_ && next_->time < log.begin) next_ = reader_.next();
    if (next_) last_ = next_->time;
  }

  /// The next event that is due by `now`, counted from the first call; valid until the next call.
  std::optional<LogEvent> due(Time now) {
    if (!start_) start_ = now;
    if (!next_) return std::nullopt;
    // Does not wait for implausibly large gaps between the times of a log.
    const Time gap = next_->time > last_ ? next_->time - last_ : Time{};
    const Time at = played_ + (gap > kLongestGap ? Time{} : gap);
    const double ahead = seconds(now - *start_) * speed_ - seconds(at);
    if (speed_ > 0.0 && ahead < 0.0) return std::nullopt;
    played_ = at;
    last_ = next_->time;
    // The bytes of an event are valid only until the next one is read.
    channel_ = next_->channel;
    data_.assign(next_->data.begin(), next_->data.end());
    const LogEvent event{next_->number, next_->time, channel_, data_};
    next_ = reader_.next();
    return event;
  }
  bool ended() const { return !next_; }

 private:
  FileWindow file_;  ///< not mapped, so that a log that is truncated meanwhile just ends
  LogReader reader_;
  std::optional<LogEvent> next_;
  std::string channel_;             ///< of the event played last
  std::vector<std::uint8_t> data_;  ///< likewise
  double speed_;
  std::optional<Time> start_;  ///< on the session's clock
  Time last_{};                ///< of the last event played, in the log
  Time played_{};              ///< the same, since the first event
};

}  // namespace headpin::devices
