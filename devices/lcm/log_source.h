#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "devices/base/source.h"
#include "devices/lcm/intake.h"
#include "devices/lcm/url.h"
#include "devices/log/event_log.h"

namespace headpin::devices {

/// Plays the samples of a log as lcm-logplayer does: each message comes at its time in the log,
/// counted from the first poll. Our own reader reads damaged logs safely.
///
/// The clocks of its publishers are its own: the session's clock follows none of them.
class LogSource : public Source {
 public:
  /// @param queue  largest number of waiting samples
  /// @throws std::runtime_error  when there is no such file or no event in it
  explicit LogSource(const UrlOfLog& log, std::size_t queue = 4096);
  LogSource(const LogSource&) = delete;
  LogSource& operator=(const LogSource&) = delete;

  void poll(Time now, std::vector<Sample>& out) override;
  bool exhausted() const override { return ended_ && intake_.empty(); }

  const LcmIntake& intake() const { return intake_; }

 private:
  bool play_next(Time now);

  FileWindow file_;  ///< not mapped, so that a log that is truncated meanwhile just ends
  LogReader reader_;
  std::optional<LogEvent> next_;
  double speed_;
  std::optional<Time> start_;  ///< on the session's clock
  Time last_{};                ///< of the last event played, in the log
  Time played_{};              ///< the same, since the first event
  bool ended_ = false;
  std::size_t queue_;
  Clocks clocks_;
  LcmIntake intake_;
};

}  // namespace headpin::devices
