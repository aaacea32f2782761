#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <span>

#include "devices/base/clocks.h"
#include "scene/play/session.h"

/// The loop of every session: live, emulated, imported or replayed. Sessions differ in the source
/// of samples, the pace and the observers.
namespace headpin::scene {

/// The times at which ticks are made.
class Pace {
 public:
  virtual ~Pace() = default;
  /// Returns when the tick of this time is due.
  virtual void wait_for(Time tick) = 0;
};

/// Makes ticks without waiting, for replays.
class NoPace : public Pace {
 public:
  void wait_for(Time) override {}
};

/// Real time: time 0 is that of begin(). Ticks are never skipped: a late tick is made at once. With
/// a tracker's clock as reference, the length of ticks follows it.
class RealTime : public Pace {
 public:
  using Clock = std::chrono::steady_clock;

  /// @param rate_hz  rate of the ticks; a tick that begins after the next one was due is an overrun
  void begin(std::int64_t rate_hz);

  void wait_for(Time tick) override;

  /// The session's time, and the clock time of a session time; from any thread.
  Time now() const;
  Clock::time_point at(Time time) const;

  /// Those of the session's sources. From begin() on, the first one is the reference.
  devices::Clocks& clocks() { return clocks_; }
  std::int64_t overruns() const { return overruns_; }

 private:
  Clock::time_point start_ = Clock::now();
  Time tick_{};
  devices::Clocks clocks_;
  double stretched_us_ = 0.0;              ///< total correction of the ticks' lengths
  std::atomic<std::int64_t> behind_us_{};  ///< the correction, for other threads
  std::int64_t overruns_ = 0;
};

/// An observer writes, verifies, draws or counts. It is called before the first tick and after each
/// tick.
class Observer {
 public:
  virtual ~Observer() = default;
  virtual void start(const Session&) {}
  virtual void tick(const Session& session) = 0;
};

/// Runs a session until it is over.
///
/// @param seen_by  observers, called in this order
/// @throws  whatever the source, the pace, the step or an observer throws; the session is then at
///          that tick
void run(Session& session, devices::Source& in, Pace& pace, std::span<Observer* const> seen_by,
         const std::function<bool(const Session&)>& until);

}  // namespace headpin::scene
