#include <algorithm>

#include "engine/stages.h"

namespace headpin::engine::detail {
namespace {

constexpr double kMeets = 1e-6;  // gap at which two surfaces count as met [m]
constexpr int kQueries = 8;      // most queries on the way there

/// Velocity of A's point against B's at time `t` of the step, without this step's gravity of what
/// does not fall. The point is given from the centres of mass.
Vec3 relative_velocity(const World& world, const Touch& touch, const Vec3& ra, const Vec3& rb,
                       double t) {
  Vec3 u = velocity_at(world.states[touch.a], ra) - velocity_at(world.states[touch.b], rb);
  if (!touch.b_moves) u += world.parameters.gravity_W * t;  // both fall: nothing to add
  return u;
}

/// When the point's gap closes at that speed, from what is known at touch.time.
Meeting closing(const World& world, const Touch& touch, const ContactPoint& p, const Vec3& ra,
                const Vec3& rb, double speed) {
  const Scratch& s = world.scratch;
  const Kink &ka = s.kinks[touch.a], &kb = s.kinks[touch.b];
  double gap = -p.depth;
  if (touch.time == 0.0) {  // impacts with others have bent the paths since
    gap += p.n_AB_W.dot(ka.lag_v + ka.lag_w.cross(ra) - kb.lag_v - kb.lag_w.cross(rb));
  }
  const double fall = touch.b_moves ? 0.0 : 0.5 * world.parameters.gravity_W.dot(p.n_AB_W);
  double t = gap / speed;
  for (int k = 0; k < 3; ++k) t = gap / std::max(speed + fall * t, 0.5 * speed);
  return {p, std::max({touch.time + t, ka.time, kb.time}), speed};
}

/// Soonest among the touch's points that is fast enough.
std::optional<Meeting> soonest(const World& world, const Touch& touch, double threshold) {
  std::optional<Meeting> best;
  const Vec3 p_WA = position_at(world, touch.a, touch.time);
  const Vec3 p_WB = position_at(world, touch.b, touch.time);
  for (std::uint32_t k = 0; k < touch.points; ++k) {
    const ContactPoint& p = world.scratch.points[touch.first_point + k];
    const Vec3 ra = p.p_W - p_WA, rb = p.p_W - p_WB;
    const double speed = relative_velocity(world, touch, ra, rb, touch.time).dot(p.n_AB_W);
    if (speed <= threshold) continue;
    const Meeting m = closing(world, touch, p, ra, rb, speed);
    if (m.time > step_seconds(world)) continue;
    if (!best || m.time < best->time) best = m;
  }
  return best;
}

void bend(World& world, BodyId i, const Vec3& F, const Vec3& r, double t) {
  Scratch& s = world.scratch;
  const Mobility& m = s.mobility[i];
  const Vec3 dv = m.inv_mass * F, dw = m.inv_inertia_W * r.cross(F);
  world.states[i].v_WB += dv;
  world.states[i].w_WB += dw;
  s.kinks[i].lag_v += t * dv;
  s.kinks[i].lag_w += t * dw;
  s.kinks[i].time = t;
  note_speed(world, i);
}

void book(World& world, const Touch& touch, const Encounter& e, const Vec3& F, const Vec3& p_W,
          const Vec3& rb) {
  world.struck.energy += F.dot(e.u_W) + 0.5 * F.dot(e.K_W * F);
  if (touch.b_moves) return;
  const bool driven = world.bodies[touch.b].kind == Kind::driven;
  Balance& outside = driven ? world.pushed : world.struck;
  if (driven) outside.energy += F.dot(velocity_at(world.states[touch.b], rb));
  outside.momentum += F;
  outside.angular_momentum += p_W.cross(F);
}

enum class Outcome { none, struck, woke };

/// Gives one impulse, if the pair has one coming.
Outcome strike(World& world, Touch& touch, double threshold) {
  Scratch& s = world.scratch;
  if (!soonest(world, touch, threshold)) return Outcome::none;
  const std::optional<Meeting> meeting = find_meeting(world, touch, threshold);
  if (!meeting) {
    touch.points = 0;  // they pass each other
    return Outcome::none;
  }
  if (world.asleep[touch.b]) {
    wake(world, touch.b);
    return Outcome::woke;
  }
  const ContactPoint& point = meeting->point;
  const double t = meeting->time;
  const Vec3 ra = point.p_W - position_at(world, touch.a, t);
  const Vec3 rb = point.p_W - position_at(world, touch.b, t);
  const Mobility &ma = s.mobility[touch.a], &mb = s.mobility[touch.b];
  Encounter e{point.n_AB_W, relative_velocity(world, touch, ra, rb, t),
              inverse_mass_at(ma.inv_mass, ma.inv_inertia_W, ra)};
  if (touch.b_moves) e.K_W += inverse_mass_at(mb.inv_mass, mb.inv_inertia_W, rb);
  Vec3 F = world.response->impulse(e, touch.pair);
  if (F.dot(e.n_AB_W) > 0.0) {  // it would pull the bodies together
    F = impulse_inelastic_smooth(e);
    ++world.statistics.pulls;
  }
  bend(world, touch.a, F, ra, t);
  if (touch.b_moves) bend(world, touch.b, -F, rb, t);
  if (world.parameters.keep_ledger) book(world, touch, e, F, point.p_W, rb);
  world.events.push_back({touch.a, touch.b, point.p_W, point.n_AB_W, F, meeting->approach, false});
  ++world.statistics.impacts;
  return Outcome::struck;
}

/// Takes the step back to its start, its bodies as they were.
void start_over(World& world) {
  Scratch& s = world.scratch;
  for (const BodyId i : s.movers) {
    world.states[i].v_WB = s.start[i].v;
    world.states[i].w_WB = s.start[i].w;
  }
  world.events.clear();
  world.struck = world.pushed = {};
  world.statistics.impacts = world.statistics.impact_sweeps = world.statistics.pulls = 0;
}

}  // namespace

Vec3 position_later(const World& world, BodyId i, double t) {
  const State& s = world.states[i];
  if (world.bodies[i].kind == Kind::fixed) return s.X_WB.p;
  Vec3 p = s.X_WB.p + s.v_WB * t - world.scratch.kinks[i].lag_v;
  if (is_mover(world, i)) p += 0.5 * t * t * world.parameters.gravity_W;
  return p;
}

Pose pose_at(const World& world, BodyId i, double t) {
  const State& s = world.states[i];
  if (t == 0.0) return s.X_WB;
  return {rotation(s.w_WB * t - world.scratch.kinks[i].lag_w) * s.X_WB.q, position_at(world, i, t)};
}

std::optional<Meeting> find_meeting(World& world, Touch& touch, double threshold) {
  Scratch& s = world.scratch;
  const Candidate c = s.candidates[touch.candidate];
  const double margin = reach(world, touch.a, touch.b);
  std::optional<Meeting> m = soonest(world, touch, threshold);
  for (int k = 0; m && k < kQueries; ++k) {
    touch.time = m->time;
    touch.first_point = static_cast<std::uint32_t>(s.points.size());
    contacts_of(world, c, pose_at(world, c.a, touch.time), pose_at(world, c.b, touch.time), margin);
    touch.points = static_cast<std::uint32_t>(s.points.size()) - touch.first_point;
    if (c.a != touch.a) turn_normals(s, touch);
    m = soonest(world, touch, threshold);
    if (!m) break;
    const bool there = m->time <= touch.time || -m->point.depth <= kMeets || k == kQueries - 1;
    if (there) {
      m->time = touch.time;
      return m;
    }
    s.points.resize(touch.first_point);
  }
  return std::nullopt;
}

void turn_normals(Scratch& s, const Touch& touch) {
  for (std::uint32_t k = 0; k < touch.points; ++k) {
    Vec3& n = s.points[touch.first_point + k].n_AB_W;
    n = -n;
  }
}

bool resolve_impacts(World& world) {
  const Parameters& p = world.parameters;
  Scratch& s = world.scratch;
  const double step_fall = p.gravity_W.norm() * step_seconds(world);
  const double threshold = std::max(p.impact_speed, 2.5 * step_fall);
  for (int sweep = 0;; ++sweep) {
    s.coming.clear();
    for (std::uint32_t k = 0; k < s.touches.size(); ++k) {
      const Touch& touch = s.touches[k];
      if (s.top_speed[touch.a] + s.top_speed[touch.b] <= threshold) continue;
      if (const auto m = soonest(world, touch, threshold)) s.coming.emplace_back(m->time, k);
    }
    if (s.coming.empty()) return false;
    if (sweep == p.impact_sweeps) break;
    std::sort(s.coming.begin(), s.coming.end());  // as they happen; at the same time, by number
    for (const auto& [time, k] : s.coming) {
      Touch& touch = s.touches[k];
      // As many points as there are may need an impulse each.
      Outcome outcome = Outcome::struck;
      for (std::uint32_t n = 0; n <= touch.points && outcome == Outcome::struck; ++n) {
        outcome = strike(world, touch, threshold);
      }
      if (outcome != Outcome::woke) continue;
      start_over(world);
      return true;
    }
    ++world.statistics.impact_sweeps;
  }
  ++world.statistics.unfinished_impacts;
  return false;
}

}  // namespace headpin::engine::detail
