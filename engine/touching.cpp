#include "engine/touching.h"

#include <algorithm>
#include <cmath>

#include "engine/inlining.h"
#include "engine/rules.h"
#include "engine/seams.h"

namespace headpin::engine::detail {
namespace {

/// Reverses the normals, if A of the touch is B of the candidate.
void turn_normals(std::span<ContactPoint> points) {
  for (ContactPoint& p : points) p.n_AB_W = -p.n_AB_W;
}

bool has_places(const Body& body) {
  return !body.areas.empty() || body.table != nullptr;
}

/// The friction that a body has at a place in its x and y.
double friction_at(const Body& body, const Vec2& p, double elsewhere) {
  if (body.table) {
    if (const std::optional<double> friction = friction_at(*body.table, p)) return *friction;
  }
  for (const FrictionArea& area : body.areas) {
    const bool inside = p.x() >= area.low.x() && p.x() < area.high.x() && p.y() >= area.low.y() &&
                        p.y() < area.high.y();
    if (inside) return area.friction;
  }
  return elsewhere;
}

/// The mean friction on the way of a touch's deepest point over B, until the end of the step.
HEADPIN_OUT_OF_LINE double friction_on_the_way(const World& world, const Touches& touches,
                                               const Touch& touch, double elsewhere) {
  constexpr int kPlaces = 4;
  const std::span<const ContactPoint> points = points_of(touches, touch);
  const auto deepest = std::max_element(
      points.begin(), points.end(),
      [](const ContactPoint& p, const ContactPoint& q) { return p.depth < q.depth; });
  const Pose X_BW = world.states[touch.b].X_WB.inverse();
  const double left = step_seconds(world) - touch.time;
  const Vec2 from = (X_BW * deepest->p_W).head<2>();
  const Vec2 way = left * (X_BW.q * world.states[touch.a].v_WB).head<2>();
  double sum = 0.0;
  for (int k = 0; k < kPlaces; ++k) {
    const Vec2 p = from + (k + 0.5) / kPlaces * way;
    sum += friction_at(world.bodies[touch.b], p, elsewhere);
  }
  return sum / kPlaces;
}

/// Elasticity and friction of a touch: the products of both materials (paper 2.2 b), or the friction
/// that B has at this place.
inline Coefficients coefficients_of(const World& world, const Touches& touches,
                                    const Touch& touch) {
  const Body& a = world.bodies[touch.a];
  const Body& b = world.bodies[touch.b];
  const Coefficients pair{a.material.elasticity * b.material.elasticity,
                          a.material.friction * b.material.friction};
  if (!has_places(b) || touch.points == 0) return pair;
  return {pair.elasticity, friction_on_the_way(world, touches, touch, pair.friction)};
}

}  // namespace

void contacts_of(const World& world, const Candidate& c, std::span<KeptNormal> normals,
                 const Pose& X_WA, const Pose& X_WB, double margin, QueryCounts& counts,
                 std::vector<ContactPoint>& out) {
  const Body &a = world.bodies[c.a], &b = world.bodies[c.b];
  Query query = world.parameters.query;
  if ((a.exact || b.exact) && keeps_rooms_exact(world.parameters)) query.mode = Query::converged;
  const std::size_t first = out.size();
  find_contacts(*a.shape, X_WA, *b.shape, X_WB, margin, normals, query, counts, out);
  if (!world.seams.all.empty() && query.mode == Query::converged) {
    mend_at_seams(world, {c.a, X_WA}, {c.b, X_WB}, first, out);
  }
}

std::uint32_t add_candidate(const World& world, std::uint64_t key, BodyId a, BodyId b,
                            Pairs& pairs) {
  const std::size_t count = kept_normals(*world.bodies[a].shape, *world.bodies[b].shape);
  pairs.candidates.push_back({key, a, b, end_of_normals(pairs), static_cast<std::uint32_t>(count)});
  return static_cast<std::uint32_t>(pairs.candidates.size() - 1);
}

Sliding sliding_of(const World& world, double friction) {
  return world.response->sliding(friction, step_seconds(world), world.parameters.friction_tau);
}

bool was_loaded(const Memory& memory, const Touch& touch) {
  if (touch.fresh) return false;
  const PastTouch& last = memory.touches[touch.last];
  for (std::uint32_t n = 0; n < last.loads; ++n) {
    if (memory.loads[last.first_load + n].impulse > 0.0) return true;
  }
  return false;
}

bool has_touch_for_each_part(const World& world, const Candidate& c) {
  constexpr std::size_t kMostPairs = 1u << 16;  // of parts: as many numbers as a feature holds
  if (!touches_each_part(world.parameters)) return false;
  const Body &a = world.bodies[c.a], &b = world.bodies[c.b];
  const Body* fixed = a.kind == Kind::fixed ? &a : b.kind == Kind::fixed ? &b : nullptr;
  return fixed != nullptr && fixed->shape->parts.size() > 1 &&
         a.shape->parts.size() * b.shape->parts.size() <= kMostPairs;
}

std::uint32_t parts_touched(const World& world, const Candidate& c) {
  if (!has_touch_for_each_part(world, c)) return 1;
  const Body& fixed = world.bodies[world.bodies[c.a].kind == Kind::fixed ? c.a : c.b];
  return static_cast<std::uint32_t>(fixed.shape->parts.size());
}

namespace {

/// The part of the candidate's fixed body that a point is of.
std::uint32_t part_of(const World& world, const Candidate& c, const ContactPoint& p) {
  const auto of_b = static_cast<std::uint32_t>(world.bodies[c.b].shape->parts.size());
  const std::uint32_t pair = p.feature >> 16;
  return world.bodies[c.a].kind == Kind::fixed ? pair / of_b : pair % of_b;
}

}  // namespace

void keep_points_of(const World& world, const Candidate& c, const Touch& touch, std::size_t first,
                    std::vector<ContactPoint>& points) {
  if (!has_touch_for_each_part(world, c)) return;
  const auto begin = points.begin() + static_cast<std::ptrdiff_t>(first);
  const auto is_other = [&](const ContactPoint& p) { return part_of(world, c, p) != touch.part; };
  points.erase(std::remove_if(begin, points.end(), is_other), points.end());
}

bool shows_only_overlap(const World& world, BodyId a, BodyId b) {
  if (!looks_ahead(world.parameters)) return false;
  const auto converges = [&](const Body& body) {  // or has a closed form, with a half-space
    return body.exact || !std::isfinite(body.shape->bounding_radius);
  };
  return !converges(world.bodies[a]) && !converges(world.bodies[b]);
}

Touch touch_of(const World& world, std::uint32_t candidate, const Touches& touches) {
  const Candidate& c = touches.pairs->candidates[candidate];
  const bool a_moves = is_mover(world, c.a), b_moves = is_mover(world, c.b);
  const bool swapped = world.bodies[c.a].kind == Kind::fixed || (!a_moves && b_moves);
  Touch touch;
  touch.key = c.key;
  touch.a = swapped ? c.b : c.a;
  touch.b = swapped ? c.a : c.b;
  touch.b_moves = a_moves && b_moves;
  touch.b_driven = world.bodies[touch.b].kind == Kind::driven;
  touch.candidate = candidate;
  touch.fresh = true;
  touch.pair = coefficients_of(world, touches, touch);
  return touch;
}

std::size_t add_touches(const World& world, const Flight& flight, std::uint32_t candidate, double t,
                        Touches& touches) {
  const Candidate& c = touches.pairs->candidates[candidate];
  const std::size_t first = touches.points.size();
  const double margin = reach(world, flight, c.a, c.b);
  const std::span<KeptNormal> normals = normals_of(*touches.pairs, c);
  Vec3 w_WA = world.states[c.a].w_WB, w_WB = world.states[c.b].w_WB;
  if (t == 0.0) {
    contacts_of(world, c, normals, world.states[c.a].X_WB, world.states[c.b].X_WB, margin,
                touches.queries, touches.points);
  } else {
    const State a = state_at(world, flight, c.a, t), b = state_at(world, flight, c.b, t);
    contacts_of(world, c, normals, a.X_WB, b.X_WB, margin, touches.queries, touches.points);
    w_WA = a.w_WB;
    w_WB = b.w_WB;
  }
  const std::size_t end = touches.points.size();
  if (end == first) return 0;
  const Touch made = touch_of(world, candidate, touches);
  const bool swapped = made.a != c.a;
  const std::span<ContactPoint> points = std::span(touches.points).subspan(first);
  if (swapped) turn_normals(points);
  const bool each_part = has_touch_for_each_part(world, c);
  const auto part = [&](const ContactPoint& p) { return each_part ? part_of(world, c, p) : 0; };
  if (each_part) std::ranges::stable_sort(points, {}, part);
  const std::size_t had = touches.all.size();
  for (std::size_t k = first; k < end;) {
    Touch& touch = touches.all.emplace_back(made);
    touch.part = part(touches.points[k]);
    touch.first_point = static_cast<std::uint32_t>(k);
    while (k < end && part(touches.points[k]) == touch.part) ++k;
    touch.points = static_cast<std::uint32_t>(k - touch.first_point);
    touch.time = t;
    touch.w_WA = swapped ? w_WB : w_WA;
    touch.w_WB = swapped ? w_WA : w_WB;
    touch.pair = coefficients_of(world, touches, touch);
  }
  return touches.all.size() - had;
}

void look_again(const World& world, const Flight& flight, Touch& touch, double t,
                Touches& touches) {
  const Candidate& c = touches.pairs->candidates[touch.candidate];
  const bool swapped = c.a != touch.a;
  const State a = state_at(world, flight, touch.a, t), b = state_at(world, flight, touch.b, t);
  touch.time = t;
  touch.w_WA = a.w_WB;
  touch.w_WB = b.w_WB;
  touch.first_point = static_cast<std::uint32_t>(touches.points.size());
  contacts_of(world, c, normals_of(*touches.pairs, c), swapped ? b.X_WB : a.X_WB,
              swapped ? a.X_WB : b.X_WB, reach(world, flight, touch.a, touch.b), touches.queries,
              touches.points);
  keep_points_of(world, c, touch, touch.first_point, touches.points);
  touch.points = static_cast<std::uint32_t>(touches.points.size()) - touch.first_point;
  if (swapped) turn_normals(std::span(touches.points).subspan(touch.first_point));
  if (!has_places(world.bodies[touch.b])) return;
  const Coefficients pair = coefficients_of(world, touches, touch);
  if (pair.friction == touch.pair.friction) return;
  touch.pair = pair;
  touch.sliding = sliding_of(world, touch.pair.friction);
}

}  // namespace headpin::engine::detail
