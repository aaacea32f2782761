#pragma once

#include <chrono>
#include <functional>
#include <span>

#include "scene/session.h"

/// The one loop that every session goes through: live, emulated, imported or replayed. What differs
/// is the source of samples, the pace, and who looks on.
namespace headpin::scene {

/// When ticks are made.
class Pace {
 public:
  virtual ~Pace() = default;
  /// Comes back when the tick of that time is due.
  virtual void wait_for(Time tick) = 0;
};

/// As fast as they can be made: a replay waits for nothing.
class NoPace : public Pace {
 public:
  void wait_for(Time) override {}
};

/// By the wall clock, time 0 being when this was made. Ticks are never skipped: one that is late is
/// made at once.
class RealTime : public Pace {
 public:
  using Clock = std::chrono::steady_clock;

  /// @param tick  from one to the next: a tick that begins later than that is an overrun
  explicit RealTime(Time tick) : tick_(tick) {}

  void wait_for(Time tick) override;

  Clock::time_point start() const { return start_; }
  std::int64_t overruns() const { return overruns_; }

 private:
  Time tick_;
  Clock::time_point start_ = Clock::now();
  std::int64_t overruns_ = 0;
};

/// Whoever looks on: writes, verifies, draws, counts. Sees the session before the first tick and
/// after each.
class Observer {
 public:
  virtual ~Observer() = default;
  virtual void start(const Session&) {}
  virtual void tick(const Session& session) = 0;
};

/// Runs a session until it is over.
///
/// @param seen_by  in this order
/// @throws  whatever source, pace, step or an observer throws; the session stands at that tick then
void run(Session& session, devices::Source& in, Pace& pace, std::span<Observer* const> seen_by,
         const std::function<bool(const Session&)>& until);

}  // namespace headpin::scene
