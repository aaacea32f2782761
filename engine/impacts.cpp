#include <algorithm>
#include <functional>
#include <utility>

#include "engine/next_impact.h"
#include "engine/rules.h"
#include "engine/stages.h"

namespace headpin::engine::detail {
namespace {

/// Moves a body along its path to time `t` of the step.
void advance(World& world, Flight& flight, BodyId i, double t) {
  Flyer& flyer = flight.bodies[i];
  if (flyer.impacts == 0) {
    flyer.place_struck = static_cast<std::uint32_t>(flight.struck.size());
    flight.struck.emplace_back(i, world.states[i]);
  }
  world.states[i] = state_at(world, flight, i, t);
  flyer.clock = t;
  flight.mobility[i].inv_inertia_W = inverse_inertia(world.inertias[i], world.states[i].X_WB.q);
}

/// Applies an impulse to a body that is at the time of its impact. From then on it falls freely.
void apply_impulse(World& world, Flight& flight, BodyId i, const Vec3& F, const Vec3& r) {
  world.states[i].v_WB += flight.mobility[i].inv_mass * F;
  world.states[i].w_WB += flight.mobility[i].inv_inertia_W * r.cross(F);
  flight.bodies[i].falls = true;
  ++flight.bodies[i].impacts;
  note_speed(world, flight, i);
}

void book(const World& world, Workspace& w, const Touch& touch, const Encounter& e, const Vec3& F,
          const Vec3& p_W, const Vec3& rb) {
  w.by_impacts.energy += F.dot(e.u_W) + 0.5 * F.dot(e.K_W * F);
  if (touch.b_moves) return;
  const bool driven = touch.b_driven;
  Balance& outside = driven ? w.by_driven : w.by_impacts;
  if (driven) outside.energy += F.dot(velocity_at(world.states[touch.b], rb));
  outside.momentum += F;
  outside.angular_momentum += p_W.cross(F);
}

/// Whether a body approaches a driven body again that struck or carried it just before, and that
/// moves towards it. The body is then squeezed between the driven body and something else.
bool is_squeezed(const World& world, const Touch& touch, bool struck, const ContactPoint& point,
                 const Vec3& rb) {
  return (struck || touch.pressed) && bounds_squeezes(world.parameters) && touch.b_driven &&
         velocity_at(world.states[touch.b], rb).dot(point.n_AB_W) < 0.0;
}

/// Impulse on a body that a driven body squeezes. With restitution it would gain speed without end,
/// so the impulse is inelastic. If the body would still gain more speed than a throw gives, or more
/// energy than a hoop that rolls at that speed, the driven body counts as standing still. Then this
/// touch has no more impacts in this step.
Vec3 squeezing_impulse(const World& world, const Mobility& m, const Touch& touch, Encounter e,
                       const Vec3& ra, const Vec3& rb, bool& insists) {
  State a = world.states[touch.a];
  const Vec3 driven_W = velocity_at(world.states[touch.b], rb);
  const double thrown = (1.0 + touch.pair.elasticity) * driven_W.norm();
  const double most = std::max(a.v_WB.norm(), thrown);
  const double most_energy = std::max(energy_per_mass(world, touch.a, a), hoop_energy(thrown));
  const Vec3 F = impulse_inelastic_smooth(e);
  a.v_WB += m.inv_mass * F;
  a.w_WB += m.inv_inertia_W * ra.cross(F);
  if (a.v_WB.norm() <= most && energy_per_mass(world, touch.a, a) <= most_energy) return F;
  insists = true;
  e.u_W += driven_W;
  return e.u_W.dot(e.n_AB_W) > 0.0 ? impulse_inelastic_smooth(e) : Vec3::Zero();
}

/// Moves the two bodies to the time of impact and applies their impulse.
void strike(World& world, Workspace& w, const Touch& touch, QueuedTouch& kept,
            const Meeting& meeting) {
  Flight& flight = w.flight;
  const ContactPoint& point = meeting.point;
  advance(world, flight, touch.a, meeting.time);
  if (touch.b_moves) advance(world, flight, touch.b, meeting.time);
  const Vec3 ra = point.p_W - world.states[touch.a].X_WB.p;
  const Vec3 rb = point.p_W - position_at(world, flight, touch.b, meeting.time);
  const Mobility &ma = flight.mobility[touch.a], &mb = flight.mobility[touch.b];
  Encounter e{point.n_AB_W,
              velocity_at(world.states[touch.a], ra) - velocity_at(world.states[touch.b], rb),
              inverse_mass_at(ma.inv_mass, ma.inv_inertia_W, ra)};
  if (touch.b_moves) e.K_W += inverse_mass_at(mb.inv_mass, mb.inv_inertia_W, rb);
  const double approach = e.u_W.dot(e.n_AB_W);
  Vec3 F = Vec3::Zero();
  if (approach > 0.0) {
    if (is_squeezed(world, touch, kept.struck, point, rb)) {
      F = squeezing_impulse(world, ma, touch, e, ra, rb, kept.insists);
    } else {
      F = meeting.approach > flight.lasting_speed ? world.response->impulse(e, touch.pair)
                                                  : impulse_inelastic_smooth(e);
    }
    kept.struck = true;
    if (F.dot(e.n_AB_W) > 0.0) {  // it would pull the bodies together
      F = impulse_inelastic_smooth(e);
      ++world.statistics.pulls;
    }
  }
  apply_impulse(world, flight, touch.a, F, ra);
  if (touch.b_moves) apply_impulse(world, flight, touch.b, -F, rb);
  if (approach <= 0.0) return;
  if (world.parameters.keep_ledger) book(world, w, touch, e, F, point.p_W, rb);
  world.events.push_back({touch.a, touch.b, point.p_W, point.n_AB_W, F, meeting.approach, false});
  ++world.statistics.impacts;
}

/// Returns to the start of the step: restores the bodies, and clears the records of the impacts.
void start_over(World& world, Workspace& w) {
  for (const auto& [i, state] : w.flight.struck) world.states[i] = state;
  world.events.clear();
  w.by_impacts = w.by_driven = {};
  world.statistics.impacts = world.statistics.unfinished_impacts = world.statistics.pulls = 0;
}

/// The impacts of a step, in order of time.
class Queue {
 public:
  Queue(World& world, Touches& touches, Workspace& w)
      : world_(world),
        touches_(touches),
        flight_(w.flight),
        w_(w),
        limit_(world.parameters.impacts) {
    w.coming.clear();
    w.halted.clear();
    w.strays.clear();
    flight_.touches.assign(touches.all.size(), {});
    for (std::uint32_t k = 0; k < touches.all.size(); ++k) set_due(k, touches.due[k]);
  }

  /// Schedules the next possible impact of a touch, from its present contact points.
  void note(std::uint32_t k) {
    Touch& touch = touches_.all[k];
    if (flight_.touches[k].insists) return set_due(k, kNever);
    set_due(k, next_impact(world_, flight_, touches_, touch));
  }

  bool empty() const { return w_.coming.empty(); }

  /// @return  whether a sleeping body was hit; it is then awake and the step back at its start
  bool work_off() {
    list_touches_of_bodies();
    while (!w_.coming.empty()) {
      const auto [due, k] = w_.coming.front();
      std::pop_heap(w_.coming.begin(), w_.coming.end(), std::greater<>());
      w_.coming.pop_back();
      if (flight_.touches[k].due == due && handle(k)) return true;
    }
    for (const BodyId i : w_.halted) flight_.bodies[i].clock = step_seconds(world_);
    return false;
  }

 private:
  void set_due(std::uint32_t k, double due) {
    flight_.touches[k].due = due;
    if (due == kNever) return;
    w_.coming.emplace_back(due, k);
    std::push_heap(w_.coming.begin(), w_.coming.end(), std::greater<>());
  }

  /// Follows the touch that seems next, and strikes if it is next. @return whether it woke a body
  bool handle(std::uint32_t k) {
    Touch& touch = touches_.all[k];
    QueuedTouch& queued = flight_.touches[k];
    if (std::max(flight_.bodies[touch.a].impacts, flight_.bodies[touch.b].impacts) >= limit_) {
      queued.due = kNever;
      world_.statistics.unfinished_impacts = 1;
      halt(touch.a);
      halt(touch.b);
      return false;
    }
    const Touch before = touch;
    const std::optional<Meeting> meeting = find_meeting(
        world_, flight_, touches_, touch, threshold_of(world_, flight_, touches_, touch));
    if (!meeting) {
      queued.due = kNever;
      pass(touch, before);
      return false;
    }
    if (!w_.coming.empty() && meeting->time > w_.coming.front().first) {
      if (meeting->time > queued.due) {
        set_due(k, meeting->time);  // others come first
        return false;
      }
    }
    if (world_.asleep[touch.b]) {
      wake(world_, touch.b);
      start_over(world_, w_);
      return true;
    }
    strike(world_, w_, touch, queued, *meeting);
    const BodyId a = touch.a, b = touch.b;
    const bool b_moves = touch.b_moves;
    turned(a, k);
    if (b_moves) turned(b, k);
    note(k);
    return false;
  }

  /// The two do not meet as an impact: what lasts is left of the touch as it was before.
  void pass(Touch& touch, const Touch& before) {
    touch.points = 0;
    if (!leaves_out_what_lasts(world_.parameters)) return;
    touch = before;
    leave_out_fast(world_, flight_, touches_, touch,
                   threshold_of(world_, flight_, touches_, touch));
    leave_what_lasts(world_, flight_, touches_, touch);
  }

  /// A body that has reached the limit of impacts stays at its last impact until the end of the
  /// step. It loses time, but does not pass through anything.
  void halt(BodyId i) {
    if (is_mover(world_, i) && flight_.bodies[i].impacts >= limit_) w_.halted.push_back(i);
  }

  /// Called when a body has a new path: finds the contact points and impacts of its touches again.
  void turned(BodyId i, std::uint32_t cause) {
    each_touch_of(i, [&](std::uint32_t k) {
      if (k == cause) return;
      look_again(world_, flight_, touches_.all[k], flight_.bodies[i].clock, touches_);
      note(k);
    });
    seek(i);
  }

  /// Searches for more bodies that a body may meet on its new path: those that it did not approach before have
  /// no touch. Older rules search only if it is faster than the search for pairs assumed.
  void seek(BodyId i) {
    Flyer& flyer = flight_.bodies[i];
    const bool was_sought = moved(i) + way_left(i) <= flyer.sought;
    const bool seeks_all = seeks_after_each_turn(world_.parameters);
    if (was_sought && !seeks_all && !looks_ahead(world_.parameters)) return;
    const Roll& roll = world_.roll;
    const Capsule bounds_W = bounds_left(i);
    for (std::size_t n = 0; n < roll.unbounded.size(); ++n) {
      const BodyId wall = roll.unbounded[n];
      if (seeks_all && is_above(bounds_W, roll.planes_W[n])) continue;
      meet_late(key_of(false, i, wall), i, wall);
    }
    w_.broad_phase.find_near(bounds_W, w_.near);
    for (const std::uint32_t n : w_.near) {
      if (distance(bounds_W, roll.bounds_W[n]) <= 0.0) meet_late(i, roll.bounded[n]);
    }
    if (!seeks_all) return;
    for (const BodyId j : w_.strays) {
      if (distance(bounds_W, bounds_left(j)) <= 0.0) meet_late(i, j);
    }
    if (was_sought || flyer.strays) return;
    flyer.strays = true;
    w_.strays.push_back(i);
  }

  /// How far a body has moved at most within the step. Older rules take its centre alone [m].
  double moved(BodyId i) const {
    const Pose& now = world_.states[i].X_WB;
    const Pose& then = flight_.struck[flight_.bodies[i].place_struck].second.X_WB;
    if (!seeks_after_each_turn(world_.parameters)) return (now.p - then.p).norm();
    const Capsule& bounds = world_.bodies[i].shape->bounds;
    return std::max((now * bounds.a - then * bounds.a).norm(),
                    (now * bounds.b - then * bounds.b).norm());
  }

  /// How far a body can still go within the step on its present path, without gravity [m].
  double way_left(BodyId i) const {
    const Flyer& flyer = flight_.bodies[i];
    return (step_seconds(world_) - flyer.clock) * flyer.top_speed;
  }

  /// Bounds of a body on the rest of its path.
  Capsule bounds_left(BodyId i) const {
    Capsule bounds_W = world_.states[i].X_WB * world_.bodies[i].shape->bounds;
    bounds_W.radius += way_left(i) + flight_.fall;
    return bounds_W;
  }

  void meet_late(BodyId i, BodyId j) {
    const auto [a, b] = std::minmax(i, j);
    if (a != b) meet_late(key_of(true, a, b), a, b);
  }

  /// Adds the touch of a pair that had none at the start of the step, if the pair may meet now; or the
  /// touches of the parts of a fixed body that had none.
  void meet_late(std::uint64_t key, BodyId a, BodyId b) {
    std::vector<std::uint32_t>& known = w_.known;
    known.clear();
    const auto add = [&](std::uint32_t k) {
      if (touches_.all[k].key == key) known.push_back(k);
    };
    each_touch_of(a, add);
    each_touch_of(b, add);
    if (!known.empty() && !has_touch_for_each_part(world_, {.a = a, .b = b})) return;
    const std::uint32_t candidate =
        known.empty() ? candidate_of(key, a, b) : touches_.all[known[0]].candidate;
    const double t = std::max(flight_.bodies[a].clock, flight_.bodies[b].clock);
    const std::size_t had = touches_.all.size();
    add_touches(world_, flight_, candidate, t, touches_);
    look_ahead(world_, flight_, candidate, t, had, touches_);
    const auto is_known = [&](const Touch& touch) {
      return std::ranges::any_of(
          known, [&](std::uint32_t k) { return touches_.all[k].part == touch.part; });
    };
    const auto first = touches_.all.begin() + static_cast<std::ptrdiff_t>(had);
    touches_.all.erase(std::remove_if(first, touches_.all.end(), is_known), touches_.all.end());
    if (known.empty() && touches_.all.size() == had) drop_if_new(candidate);
    for (std::size_t k = had; k < touches_.all.size(); ++k) {
      flight_.touches.emplace_back();
      touches_.all[k].sliding = sliding_of(world_, touches_.all[k].pair.friction);
      list(static_cast<std::uint32_t>(k));
    }
    for (std::size_t k = had; k < flight_.touches.size(); ++k) note(static_cast<std::uint32_t>(k));
  }

  std::uint32_t candidate_of(std::uint64_t key, BodyId a, BodyId b) {
    const auto first = touches_.pairs->candidates.begin();
    const auto early = first + static_cast<std::ptrdiff_t>(touches_.pairs->early);
    const auto place = std::lower_bound(
        first, early, key, [](const Candidate& c, std::uint64_t value) { return c.key < value; });
    if (place != early && place->key == key) {
      return static_cast<std::uint32_t>(place - first);
    }
    const std::uint32_t added = add_candidate(world_, key, a, b, *touches_.pairs);
    touches_.pairs->normals.resize(end_of_normals(*touches_.pairs));  // without a warm start
    return added;
  }

  /// Removes the last candidate, which has no touch, if it was not there at the start of the step.
  void drop_if_new(std::uint32_t candidate) {
    Pairs& pairs = *touches_.pairs;
    if (candidate < pairs.early || !seeks_after_each_turn(world_.parameters)) return;
    pairs.candidates.pop_back();
    pairs.normals.resize(end_of_normals(pairs));
  }

  // Each body's touches: a list from the newest to the oldest.

  void list_touches_of_bodies() {
    for (const BodyId i : world_.roll.movers) flight_.bodies[i].first_touch = kNone;
    for (std::uint32_t k = 0; k < touches_.all.size(); ++k) list(k);
  }

  void list(std::uint32_t k) {
    const Touch& touch = touches_.all[k];
    std::array<std::uint32_t, 2>& next = flight_.touches[k].next;
    next[0] = std::exchange(flight_.bodies[touch.a].first_touch, k);
    if (touch.b_moves) next[1] = std::exchange(flight_.bodies[touch.b].first_touch, k);
  }

  template <typename F>
  void each_touch_of(BodyId i, F&& f) {
    if (!is_mover(world_, i)) return;
    for (std::uint32_t k = flight_.bodies[i].first_touch; k != kNone;) {
      const std::uint32_t next = flight_.touches[k].next[touches_.all[k].a == i ? 0 : 1];
      f(k);
      k = next;
    }
  }

  World& world_;
  Touches& touches_;
  Flight& flight_;
  Workspace& w_;
  int limit_;
};

}  // namespace

const Flight* resolve_impacts(World& world, Touches& touches, Workspace& w) {
  Queue queue(world, touches, w);
  const bool woke = !queue.empty() && queue.work_off();
  return woke ? nullptr : &w.flight;
}

}  // namespace headpin::engine::detail
