#include "devices/base/clocks.h"

#include <algorithm>
#include <cmath>

namespace headpin::devices {

ClockId Clocks::add(Lead lead) {
  clocks_.push_back({.lead = lead});
  return ClockId{clocks_.size() - 1};
}

Time Clocks::date(const Measured& measured) {
  Clock& clock = at(measured.clock);
  if (genlock_ && !leader_ && clock.lead == Lead::may) leader_ = measured.clock;
  const Clock before = clock;
  const bool later = before.offset.started() && measured.theirs_us > before.theirs_us;
  const double ours_us = clock.offset.carry_over(measured.theirs_us, measured.arrived_us);
  clock.theirs_us = measured.theirs_us;
  clock.estimate_us = later ? std::max(ours_us, before.estimate_us + measured.apart_us) : ours_us;
  clock.ours =
      held(measured.theirs, clock, ours_us - measured.theirs_us, leader_ == measured.clock);
  if (later) clock.ours = std::max(clock.ours, before.ours + Time{1});
  return clock.ours;
}

Time Clocks::date_by_arrival(ClockId clock, Time arrived) {
  Time& ours = at(clock).ours;
  return ours = std::max(arrived, ours + Time{1});
}

Time Clocks::date_like(ClockId like, ClockId clock, Time theirs) {
  Clock& own = at(clock);
  own.offset = at(like).offset;
  own.theirs_us = static_cast<double>(theirs.count());
  own.estimate_us = own.offset.ours(own.theirs_us);
  return own.ours = held(theirs, own, own.estimate_us - own.theirs_us, false);
}

/// The date of the clock's last measurement, from its estimate.
Time Clocks::held(Time theirs, const Clock& clock, double offset_us, bool leads) {
  if (!genlock_) return Time{std::llround(clock.estimate_us)};
  return theirs +
         Time{std::llround(leads ? genlock_->follow(offset_us) : genlock_->same_or_own(offset_us))};
}

}  // namespace headpin::devices
