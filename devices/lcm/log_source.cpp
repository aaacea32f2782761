#include "devices/lcm/log_source.h"

#include <algorithm>
#include <stdexcept>

#include "devices/log/sample_messages.h"

namespace headpin::devices {

LogSource::LogSource(const UrlOfLog& log, std::size_t queue)
    : file_(log.path),
      reader_(file_),
      next_(reader_.next()),
      speed_(log.speed),
      queue_(queue),
      intake_(clocks_, queue) {
  if (!next_) throw std::runtime_error(log.path + ": not an LCM event log: no whole event");
  while (next_ && next_->time < log.begin) next_ = reader_.next();
  if (next_) last_ = next_->time;
}

void LogSource::poll(Time now, std::vector<Sample>& out) {
  if (!start_) start_ = now;
  // At most as many as the queue can hold, so that a flood cannot block this.
  for (std::size_t i = 0; i < queue_ && play_next(now); ++i) continue;
  ended_ = !next_;
  intake_.hand_out(now, out);
}

/// Plays the next message if it is due. @return  whether it was
bool LogSource::play_next(Time now) {
  if (!next_) return false;
  // Does not wait for implausibly large gaps between the times of a log.
  const Time gap = next_->time > last_ ? next_->time - last_ : Time{};
  const Time at = played_ + (gap > kLongestGap ? Time{} : gap);
  const double ahead = seconds(now - *start_) * speed_ - seconds(at);
  if (speed_ > 0.0 && ahead < 0.0) return false;
  played_ = at;
  // Messages may be out of order by a little; one that is far back begins another recording.
  last_ = next_->time < last_ - kLongestGap ? next_->time : std::max(last_, next_->time);
  if (next_->channel == kTrackerChannel || next_->channel == kMouseChannel) {
    intake_.take({.channel = next_->channel, .data = next_->data, .arrived = now});
  }
  next_ = reader_.next();
  return true;
}

}  // namespace headpin::devices
