#include "scene/score.h"

#include "scene/events.h"

namespace headpin::scene {

void Score::add(const devices::Event& event) {
  touches += event.kind == kind::touch || event.kind == kind::first_contact;
  skittles_down += event.kind == kind::skittle_down;
  if (event.kind == kind::release && !release_speed) release_speed = event.value;
  if (event.kind == kind::first_contact && !impact_speed) impact_speed = event.value;
}

Score score(std::span<const devices::Event> events) {
  Score score;
  for (const devices::Event& event : events) score.add(event);
  return score;
}

}  // namespace headpin::scene
