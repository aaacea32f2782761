#include "scene/run.h"

#include <thread>

namespace headpin::scene {

void RealTime::wait_for(Time tick) {
  const Clock::time_point due = start_ + tick;
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
