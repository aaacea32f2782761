#pragma once

#include <algorithm>

#include "engine/paths.h"
#include "engine/rules.h"

/// The contact points of two bodies within a step. Private to the engine.
namespace headpin::engine::detail {

/// Gap at which resting bodies still have contact points [m].
inline constexpr double kMargin = 1e-3;

/// Bound on the speed at which points of two bodies approach each other at the present velocities [m/s].
inline double fastest_approach(const World& world, const Flight& flight, BodyId a, BodyId b) {
  const double drift = (world.states[a].v_WB - world.states[b].v_WB).norm();
  return drift + flight.bodies[a].spin_speed + flight.bodies[b].spin_speed;
}

/// Largest gap at which two bodies can still meet within the step at their present velocities [m].
/// Where an impact turns one of them, more bodies are searched for.
inline double reach(const World& world, const Flight& flight, BodyId a, BodyId b) {
  return kMargin + fastest_approach(world, flight, a, b) * step_seconds(world) + flight.fall;
}

/// Sign of the impulses on A of a touch among those that are stored for the next step (`PastTouch`).
inline double side_of(const Parameters& p, const Touch& touch) {
  return keeps_sides(p) && touch.a != first_of(touch.key) ? -1.0 : 1.0;
}

/// Whether a body cannot meet a half-space within the step, with some room for rounding.
inline bool is_above(const Capsule& bounds_W, const Plane& plane) {
  const double low = std::min(plane.up.dot(bounds_W.a), plane.up.dot(bounds_W.b));
  return low - plane.height > bounds_W.radius + 2.0 * kMargin;
}

/// Appends the contact points of the candidate's bodies at these poses, with their kept normals.
void contacts_of(const World& world, const Candidate& c, std::span<KeptNormal> normals,
                 const Pose& X_WA, const Pose& X_WB, double margin, QueryCounts& counts,
                 std::vector<ContactPoint>& out);

/// Whether the parts of a candidate's fixed body are touched each on its own.
bool has_touch_for_each_part(const World& world, const Candidate& c);

/// Number of parts of the candidate's fixed body that are touched each on its own; 1 if they are not.
std::uint32_t parts_touched(const World& world, const Candidate& c);

/// Leaves out the contact points, from `first` on, that are not those of a touch: of other parts.
void keep_points_of(const World& world, const Candidate& c, const Touch& touch, std::size_t first,
                    std::vector<ContactPoint>& points);

/// Whether two bodies have no contact points while they are apart, so that an impact has to be looked for.
bool shows_only_overlap(const World& world, BodyId a, BodyId b);

/// A touch of a candidate's bodies, without points yet.
Touch touch_of(const World& world, std::uint32_t candidate, const Touches& touches);

/// Looks for contact points of a candidate at time `t` of the step; appends its touches, if there are
/// any points.
///
/// @return  how many: at most one, unless parts of a fixed body are touched each on its own
std::size_t add_touches(const World& world, const Flight& flight, std::uint32_t candidate, double t,
                        Touches& touches);

/// Finds the touch's points again, at time `t` of the step on the present paths of both bodies, and
/// appends them.
void look_again(const World& world, const Flight& flight, Touch& touch, double t, Touches& touches);

/// How a touch of this friction continues to slide under the world's law of response.
Sliding sliding_of(const World& world, double friction);

/// Whether the touch carried anything in the last step.
bool was_loaded(const Memory& memory, const Touch& touch);

/// Number of normals that the candidates need.
inline std::uint32_t end_of_normals(const Pairs& pairs) {
  if (pairs.candidates.empty()) return 0;
  return pairs.candidates.back().first_normal + pairs.candidates.back().normals;
}

/// Appends a candidate; its normals have a place, but are not there yet.
std::uint32_t add_candidate(const World& world, std::uint64_t key, BodyId a, BodyId b,
                            Pairs& pairs);

inline std::span<KeptNormal> normals_of(Pairs& pairs, const Candidate& c) {
  return std::span(pairs.normals).subspan(c.first_normal, c.normals);
}

/// The points of a touch.
inline std::span<const ContactPoint> points_of(const Touches& touches, const Touch& touch) {
  return std::span(touches.points).subspan(touch.first_point, touch.points);
}

}  // namespace headpin::engine::detail
