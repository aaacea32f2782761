#include "scene/watch/drawn_by.h"

#include <algorithm>

#include "scene/record/events.h"

namespace headpin::scene {

Event drawn_by_event(const render::Fingerprint& fingerprint) {
  Event event;
  event.tick = 0;
  event.kind = kind::drawn_by;
  event.detail = fingerprint;
  return event;
}

std::optional<render::Fingerprint> drawn_by(const std::vector<Event>& events) {
  const auto found = std::ranges::find(events, kind::drawn_by, &Event::kind);
  const auto* who = found == events.end() ? nullptr : found->detail.get_if<render::Fingerprint>();
  return who ? std::optional(*who) : std::nullopt;
}

}  // namespace headpin::scene
