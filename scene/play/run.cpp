#include "scene/play/run.h"

#include <cmath>
#include <thread>

namespace headpin::scene {

void RealTime::begin(std::int64_t rate_hz) {
  tick_ = tick_time(1, rate_hz);
  clocks_.follow_first(rate_hz);
  start_ = Clock::now();
}

Time RealTime::now() const {
  return std::chrono::duration_cast<Time>(Clock::now() - start_) - Time{behind_us_};
}

RealTime::Clock::time_point RealTime::at(Time time) const {
  return start_ + time + Time{behind_us_};
}

void RealTime::wait_for(Time tick) {
  stretched_us_ += clocks_.stretch_us(tick_);
  behind_us_ = std::llround(stretched_us_);
  const Clock::time_point due = at(tick);
  std::this_thread::sleep_until(due);
  if (Clock::now() - due > tick_) ++overruns_;
}

void run(Session& session, devices::Source& in, Pace& pace, std::span<Observer* const> seen_by,
         const std::function<bool(const Session&)>& until) {
  for (Observer* observer : seen_by) observer->start(session);
  while (!until(session)) {
    pace.wait_for(session.next_tick());
    advance(session, in);
    for (Observer* observer : seen_by) observer->tick(session);
  }
}

}  // namespace headpin::scene
