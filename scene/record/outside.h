#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "scene/record/trial.h"

/// The events of a trial that no simulation makes: a replay does not make them again.
namespace headpin::scene {

/// Whether an event is from outside the simulation: by its tick, or by its kind. What a live session tells of
/// its pictures, its sources and its browser has the tick at which it was told.
bool is_outside(std::int64_t tick, std::string_view kind);

/// The events from outside, one after the other, for whoever simulates a trial again.
class OutsideEvents {
 public:
  /// @param events  all of the trial
  explicit OutsideEvents(const std::vector<Event>& events);

  /// The next one that is not later than `now`; null if there is none.
  const Event* next(Time now);

 private:
  std::vector<Event> events_;  // by time
  std::size_t next_ = 0;
};

}  // namespace headpin::scene
