#include "scene/record/outside.h"

#include <algorithm>
#include <array>

#include "scene/record/events.h"

namespace headpin::scene {
namespace {

/// Of live sessions, of browsers, and of imported recordings.
constexpr auto kOutsideKinds = std::to_array<std::string_view>(
    {kind::drawn_by, kind::drawing_failed, kind::kept_pace, kind::played_with, kind::recentred,
     kind::paused, kind::not_stored, kind::source_amiss, kind::imported, kind::import_note,
     kind::session_end, kind::grab_found, kind::release_found, kind::not_measured,
     kind::incomplete});

}  // namespace

bool is_outside(std::int64_t tick, std::string_view kind) {
  return tick < 0 || std::ranges::find(kOutsideKinds, kind) != kOutsideKinds.end();
}

OutsideEvents::OutsideEvents(const std::vector<Event>& events) {
  for (const Event& event : events) {
    if (is_outside(event.tick, event.kind)) events_.push_back(event);
  }
  std::ranges::stable_sort(events_, {}, &Event::time);
}

const Event* OutsideEvents::next(Time now) {
  if (next_ == events_.size() || events_[next_].time > now) return nullptr;
  return &events_[next_++];
}

}  // namespace headpin::scene
