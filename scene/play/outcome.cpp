#include "scene/play/outcome.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "scene/play/score.h"
#include "scene/record/details.h"
#include "scene/record/events.h"
#include "scene/stage/stage.h"

namespace headpin::scene {

namespace {

const Event* first_of(std::span<const Event> events, std::string_view kind) {
  const auto found = std::ranges::find(events, kind, &Event::kind);
  return found == events.end() ? nullptr : &*found;
}

const Event* first_of_ball(std::span<const Event> events, std::string_view kind) {
  const auto found =
      std::ranges::find_if(events, [&](const Event& e) { return e.kind == kind && is_of_ball(e); });
  return found == events.end() ? nullptr : &*found;
}

/// The reason why the hand never had the ball.
std::string why_not_taken(std::span<const Event> events) {
  const Event* other = first_of(events, kind::grab);
  if (other && !other->bodies.empty()) {
    return fmt::format("the hand took {}, not the ball", other->bodies.front());
  }
  const Event* missed = first_of(events, kind::missed_grab);
  if (!missed) {
    return "the trigger was never pressed while the hand was tracked, so the ball stayed where it was";
  }
  return fmt::format(
      "the trigger was pressed at {:.3f} s with the hand {:.2f} m from the {}, too far to take it",
      seconds(missed->time), missed->value,
      missed->bodies.empty() ? "ball" : missed->bodies.front());
}

/// The body that the ball met.
std::string met_by_ball(const Event& event) {
  for (const std::string& body : event.bodies) {
    if (role_named(body) != Role::ball) return body;
  }
  return "another ball";
}

}  // namespace

bool says_that_some_fell(const Event& event) {
  if (event.kind == kind::delivery) return !event.bodies.empty() || skittles_in(event) > 0;
  return event.kind == kind::skittle_down && event.detail.value_or(By::nobody) != By::hand;
}

std::string why_nothing_fell(std::span<const Event> events) {
  if (std::ranges::any_of(events, says_that_some_fell)) return "";
  if (!first_of_ball(events, kind::grab)) return why_not_taken(events);
  const Event* release = first_of_ball(events, kind::release);
  if (!release) return "the ball was taken and never let go";
  if (const Event* struck = first_of(events, kind::first_contact)) {
    return fmt::format("the ball met {} at {:.2f} m/s, which did not fell it", met_by_ball(*struck),
                       struck->value);
  }
  std::vector<std::string> met;
  for (const Event& event : events) {
    if (event.kind == kind::ball_touch) met.push_back(met_by_ball(event));
  }
  const std::string thrown = fmt::format("the ball was released at {:.2f} m/s", release->value);
  if (met.empty()) return thrown + " and touched nothing until the end";
  return fmt::format("{} and touched {}, but no skittle", thrown, fmt::join(met, ", "));
}

}  // namespace headpin::scene
