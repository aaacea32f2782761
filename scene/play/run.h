#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include "devices/base/genlock.h"
#include "scene/play/session.h"

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

/// By the machine's clock, time 0 being when this was begun. Ticks are never skipped: one that is
/// late is made at once. Where a tracker's clock is held to, ticks last as long as that asks for.
class RealTime : public Pace {
 public:
  using Clock = std::chrono::steady_clock;

  /// @param rate_hz  of the ticks: one that begins later than the next was due is an overrun
  void begin(std::int64_t rate_hz);

  void wait_for(Time tick) override;

  /// The session's time, and when that is or was; from any thread.
  Time now() const;
  Clock::time_point at(Time time) const;

  /// For the sources whose clocks it may be held to.
  devices::Genlock* genlock() { return genlock_ ? &*genlock_ : nullptr; }
  std::int64_t overruns() const { return overruns_; }

 private:
  Clock::time_point start_ = Clock::now();
  Time tick_{};
  std::optional<devices::Genlock> genlock_;
  double stretched_us_ = 0.0;              ///< in all
  std::atomic<std::int64_t> behind_us_{};  ///< the same, for other threads
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
