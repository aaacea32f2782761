#pragma once

#include <charconv>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <lcm/lcm.h>

#include "devices/lcm/link.h"
#include "devices/trial/event_log.h"
#include "devices/trial/log.h"
#include "devices/trial/sources.h"

/// The inside of an LcmLink, for link.cpp and source.cpp.
namespace headpin::devices {

struct LcmLink::Lcm {
  lcm_t* handle = nullptr;
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

/// A log that is played: file://PATH, with liblcm's options speed=N (1; 0: all at once) and
/// start_timestamp=N. Our own reader reads damaged logs safely.
class LcmLink::LogPlayer {
 public:
  explicit LogPlayer(const std::string& url)
      : file_(path_of(url)), reader_(file_), next_(reader_.next()) {
    if (!next_) throw std::runtime_error(path_of(url) + ": not an LCM event log: no whole event");
    for (std::string_view rest = options_of(url); !rest.empty();) {
      const std::string_view option = rest.substr(0, rest.find('&'));
      rest.remove_prefix(std::min(rest.size(), option.size() + 1));
      take_option(url, option);
    }
    while (next_ && next_->time < begin_) next_ = reader_.next();
    if (next_) last_ = next_->time;
  }

  /// For a log that is only read, unlike file://PATH?mode=w.
  static bool reads(const std::string& url) {
    return url.starts_with(kScheme) && options_of(url).find("mode=w") == std::string_view::npos &&
           options_of(url).find("mode=a") == std::string_view::npos;
  }

  /// The file of a URL that writes one; empty for other URLs.
  static std::string written_by(const std::string& url) {
    return url.starts_with(kScheme) && !reads(url) ? path_of(url) : "";
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
  static constexpr std::string_view kScheme = "file://";
  static std::string path_of(const std::string& url) {
    return url.substr(kScheme.size(), url.find('?') - kScheme.size());
  }
  static std::string_view options_of(std::string_view url) {
    const std::size_t mark = url.find('?');
    return mark == std::string_view::npos ? std::string_view() : url.substr(mark + 1);
  }
  void take_option(const std::string& url, std::string_view option) {
    const std::size_t sign = option.find('=');
    const std::string_view name = option.substr(0, sign);
    const std::string_view value =
        option.substr(sign == std::string_view::npos ? option.size() : sign + 1);
    const auto number = [&](auto& into) {
      const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), into);
      return error == std::errc{} && end == value.data() + value.size();
    };
    std::int64_t begin = 0;
    if (name == "mode" && value == "r") return;
    if (name == "speed" && number(speed_) && speed_ >= 0.0 && std::isfinite(speed_)) return;
    if (name == "start_timestamp" && number(begin)) {
      begin_ = Time{begin};
      return;
    }
    throw std::runtime_error(
        fmt::format("{}: option '{}': expected speed=N (0: as fast as possible), "
                    "start_timestamp=MICROSECONDS or mode=r",
                    url, option));
  }

  FileWindow file_;  ///< not mapped, so that a log that is truncated meanwhile just ends
  LogReader reader_;
  std::optional<LogEvent> next_;
  std::string channel_;             ///< of the event played last
  std::vector<std::uint8_t> data_;  ///< likewise
  double speed_ = 1.0;
  Time begin_ = Time::min();
  std::optional<Time> start_;  ///< on the session's clock
  Time last_{};                ///< of the last event played, in the log
  Time played_{};              ///< the same, since the first event
};

}  // namespace headpin::devices
