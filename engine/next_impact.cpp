#include "engine/next_impact.h"

#include <algorithm>

#include "engine/rules.h"

namespace headpin::engine::detail {
namespace {

constexpr int kGentle = 8;  // impacts of a body in a step after which slow ones are left out

/// Whether the two touch when the step begins, as they did in the last one.
bool rests(const World& world, const Touches& touches, const Touch& touch) {
  if (touch.time > 0.0 || !was_loaded(world.memory, touch)) return false;
  const auto first = touches.points.begin() + touch.first_point;
  return std::any_of(first, first + touch.points,
                     [](const ContactPoint& p) { return p.depth > -kMeets; });
}

/// The next meeting, if any. The path of a body that turns far is followed at once and to the end
/// of the step, because it may meet with points that are not contact points yet.
std::optional<Meeting> seen_early(const World& world, const Flight& flight, Touches& touches,
                                  Touch& touch) {
  const double trusted = trusted_for(world, flight, touch);
  const double threshold = threshold_of(world, flight, touches, touch);
  const bool to_the_end = (trusted < kNever && follows_far_turns(world.parameters)) ||
                          shows_only_overlap(world, touch.a, touch.b);
  if (!to_the_end && touch.time + trusted >= step_seconds(world)) {
    return soonest(world, flight, touches, touch, threshold);
  }
  const std::size_t count = touches.points.size();
  Touch probe = touch;
  const std::optional<Meeting> m = find_meeting(world, flight, touches, probe, threshold);
  if (m) {
    touch = probe;
  } else {
    touches.points.resize(count);
  }
  return m;
}

/// Removes the points of surfaces that seem to touch slowly but in fact pass each other. Removes
/// also those of surfaces that approach fast now but in fact meet slowly: as lasting contacts
/// they would be braked at once.
void leave_out_what_passes(const World& world, const Flight& flight, Touches& touches,
                           Touch& touch) {
  if (touch.points == 0 || was_loaded(world.memory, touch)) return;
  if (!soonest(world, flight, touches, touch, 0.0)) return;
  const std::size_t count = touches.points.size();
  Touch probe = touch;
  const bool meet = find_meeting(world, flight, touches, probe, 0.0).has_value();
  touches.points.resize(count);
  const bool would_brake =
      follows_far_turns(world.parameters) &&
      soonest(world, flight, touches, touch, threshold_of(world, flight, touches, touch));
  if (meet && !would_brake) return;
  const auto first = touches.points.begin() + touch.first_point;
  const auto end = std::remove_if(first, first + touch.points,
                                  [](const ContactPoint& p) { return p.depth <= -kMeets; });
  touch.points = static_cast<std::uint32_t>(end - first);
}

/// Removes points that will meet just after the end of the step; in the next step they are
/// impacts. As lasting contacts they would be slowed down now, to meet exactly at the end.
void leave_what_lands_later(const World& world, const Flight& flight, Touches& touches,
                            Touch& touch) {
  if (!leaves_late_landings(world.parameters)) return;
  if (touch.points == 0 || was_loaded(world.memory, touch)) return;
  const auto first = touches.points.begin() + touch.first_point;
  const auto end = std::remove_if(first, first + touch.points, [&](const ContactPoint& p) {
    return lands_later(world, flight, touch, p);
  });
  touch.points = static_cast<std::uint32_t>(end - first);
}

}  // namespace

double threshold_of(const World& world, const Flight& flight, const Touches& touches,
                    const Touch& touch) {
  const int had = std::max(flight.bodies[touch.a].impacts, flight.bodies[touch.b].impacts);
  if (had >= kGentle) return flight.lasting_speed;
  const double followed = followed_speed(world, flight, touch.a, touch.b);
  if (!rests_under_gravity(world.parameters) || !rests(world, touches, touch)) return followed;
  const double by_gravity = 1.5 * flight.fall * world.parameters.rate_hz;
  return std::max(followed, std::min(by_gravity, flight.lasting_speed));
}

void leave_what_lasts(const World& world, const Flight& flight, Touches& touches, Touch& touch) {
  leave_out_what_passes(world, flight, touches, touch);
  leave_what_lands_later(world, flight, touches, touch);
}

double next_impact(const World& world, const Flight& flight, Touches& touches, Touch& touch) {
  const std::optional<Meeting> m = seen_early(world, flight, touches, touch);
  if (m) return m->time;
  leave_what_lasts(world, flight, touches, touch);
  return kNever;
}

void note_next_impacts(const World& world, const Flight& flight, Touches& touches) {
  const double slow = flight.lasting_speed - 2.0 * flight.fall * world.parameters.rate_hz;
  touches.due.assign(touches.all.size(), kNever);
  for (std::size_t k = 0; k < touches.all.size(); ++k) {
    Touch& touch = touches.all[k];
    const double fastest = flight.bodies[touch.a].top_speed + flight.bodies[touch.b].top_speed;
    const bool seen_ahead = touch.time > 0.0;
    if (seen_ahead || fastest > followed_speed(world, flight, touch.a, touch.b)) {
      touches.due[k] = next_impact(world, flight, touches, touch);
    } else if (fastest > slow) {
      leave_what_lands_later(world, flight, touches, touch);
    }
  }
}

}  // namespace headpin::engine::detail
