#include "scene/watch/notes.h"

#include "scene/record/events.h"

namespace headpin::scene {

void Notes::finish(const Session& session) {
  copy(session, Time::max());
  if (missing_.empty()) return;
  Event event;
  event.time = session.now();
  event.kind = kind::incomplete;
  event.detail = missing_;
  writer_.write(event);
}

void Notes::copy(const Session& session, Time until) {
  while (const Event* event = told_.next(until)) {
    if (event->kind == kind::drawn_by || event->kind == kind::drawing_failed) continue;
    Event copy = *event;
    if (copy.tick >= 0) copy.tick = session.tick;
    writer_.write(copy);
  }
}

}  // namespace headpin::scene
