#include <algorithm>
#include <functional>
#include <limits>
#include <utility>

#include "engine/stages.h"

namespace headpin::engine::detail {
namespace {

constexpr double kMeets = 1e-6;     // gap at which two surfaces count as met [m]
constexpr double kRounded = 1e-12;  // gap of which rounding may make none [m]
constexpr int kQueries = 32;        // most queries on the way there; a few do unless they graze
constexpr int kTurns = 64;          // at most so often within a step
constexpr int kGentle = 8;  // impacts of a body in a step after which slow ones are left out
constexpr int kBack = 12;   // most queries on the way back from where they overlap
constexpr std::uint32_t kNone = ~std::uint32_t{0};
constexpr double kNever = std::numeric_limits<double>::infinity();

/// Where a body's centre of mass is when a touch looks at it, and how fast it and its turn are.
struct Going {
  Vec3 p_WB, v_WB, w_WB;
};

Going going(const World& world, BodyId i, double t, const Vec3& w_WB) {
  const State& s = world.states[i];
  const double passed = t - world.scratch.clock[i];
  if (passed == 0.0) return {s.X_WB.p, s.v_WB, s.w_WB};
  return {position_at(world, i, t), s.v_WB + passed * pull_on(world, i), w_WB};
}

/// Soonest among the touch's points that is fast enough.
std::optional<Meeting> soonest(const World& world, const Touch& touch, double threshold) {
  std::optional<Meeting> best;
  const Going a = going(world, touch.a, touch.time, touch.w_WA);
  const bool b_moves = world.bodies[touch.b].kind != Kind::fixed;
  const Going b = b_moves ? going(world, touch.b, touch.time, touch.w_WB) : Going{};
  for (std::uint32_t k = 0; k < touch.points; ++k) {
    const ContactPoint& p = world.scratch.points[touch.first_point + k];
    Vec3 u = a.v_WB + a.w_WB.cross(p.p_W - a.p_WB);
    if (b_moves) u = u - b.v_WB - b.w_WB.cross(p.p_W - b.p_WB);
    const double speed = u.dot(p.n_AB_W);
    if (speed <= threshold) continue;
    const double gap = -p.depth;
    double t = gap / speed;
    if (world.scratch.falls[touch.a] != world.scratch.falls[touch.b]) {
      const Vec3 g = pull_on(world, touch.a) - pull_on(world, touch.b);
      const double fall = 0.5 * g.dot(p.n_AB_W);
      for (int i = 0; i < 3; ++i) t = gap / std::max(speed + fall * t, 0.5 * speed);
    }
    const double time =
        std::max({touch.time + t, world.scratch.clock[touch.a], world.scratch.clock[touch.b]});
    if (time > step_seconds(world)) continue;
    // Of several at once the fastest, whatever their order: a mirrored body has another.
    const bool sooner =
        !best || time < best->time || (time == best->time && speed > best->approach);
    if (sooner) best = {p, time, speed};
  }
  return best;
}

/// Whether two surfaces that are apart at the end of the step meet after it, as an impact.
bool lands_later(const World& world, const Touch& touch, const ContactPoint& p) {
  const Going a = going(world, touch.a, touch.time, touch.w_WA);
  const Going b = going(world, touch.b, touch.time, touch.w_WB);
  const Vec3 u = a.v_WB + a.w_WB.cross(p.p_W - a.p_WB) - b.v_WB - b.w_WB.cross(p.p_W - b.p_WB);
  const double pull = (pull_on(world, touch.a) - pull_on(world, touch.b)).dot(p.n_AB_W);
  const double left = step_seconds(world) - touch.time, speed = u.dot(p.n_AB_W);
  const double gap = -p.depth - left * speed - 0.5 * left * left * pull;
  const double at_end = speed + left * pull, threshold = world.scratch.lasting_speed;
  if (at_end <= 0.0 || gap < -kRounded) return false;
  return at_end * at_end + 2.0 * pull * std::max(0.0, gap) > threshold * threshold;
}

/// The touch's points at time `t` of the step, on the paths the two bodies now have.
void look_again(World& world, Touch& touch, double t) {
  Scratch& s = world.scratch;
  const Candidate c = s.candidates[touch.candidate];
  const bool swapped = c.a != touch.a;
  const State a = state_at(world, touch.a, t), b = state_at(world, touch.b, t);
  touch.time = t;
  touch.w_WA = a.w_WB;
  touch.w_WB = b.w_WB;
  touch.first_point = static_cast<std::uint32_t>(s.points.size());
  contacts_of(world, c, swapped ? b.X_WB : a.X_WB, swapped ? a.X_WB : b.X_WB,
              reach(world, touch.a, touch.b));
  touch.points = static_cast<std::uint32_t>(s.points.size()) - touch.first_point;
  if (swapped) turn_normals(s, touch);
}

double deepest(const Scratch& s, const Touch& touch) {
  double depth = -kNever;
  for (std::uint32_t k = 0; k < touch.points; ++k) {
    depth = std::max(depth, s.points[touch.first_point + k].depth);
  }
  return depth;
}

/// A time of the step at which two bodies were apart.
struct Apart {
  double time = 0.0, gap = 0.0;
};

/// Two that were apart and overlap as the touch now sees them: back to where they meet.
void go_back(World& world, Touch& touch, Apart before) {
  Scratch& s = world.scratch;
  for (int k = 0; k < kBack; ++k) {
    const double depth = deepest(s, touch);
    if (depth <= world.parameters.slop) return;
    const double part = std::clamp(before.gap / (before.gap + depth), 0.1, 0.9);
    const double t = before.time + part * (touch.time - before.time);
    Touch probe = touch;
    look_again(world, probe, t);
    const double gap = -deepest(s, probe);
    if (gap > kMeets) {
      s.points.resize(probe.first_point);
      before = {t, gap};
    } else {
      touch = probe;
    }
  }
}

/// For how long the points of a touch tell what the bodies will meet with: until these have turned.
double trusted_for(const World& world, const Touch& touch) {
  const double spin = world.states[touch.a].w_WB.norm() + world.states[touch.b].w_WB.norm();
  const double step = step_seconds(world);
  return spin * step <= kFarTurn ? kNever : std::max(kFarTurn / spin, step / kTurns);
}

/// Brings a body along its path to time `t` of the step.
void advance(World& world, BodyId i, double t) {
  Scratch& s = world.scratch;
  if (s.impacts_of[i] == 0) {
    s.place_struck[i] = static_cast<std::uint32_t>(s.struck.size());
    s.struck.emplace_back(i, world.states[i]);
  }
  world.states[i] = state_at(world, i, t);
  s.clock[i] = t;
  s.mobility[i].inv_inertia_W = inverse_inertia(world.inertias[i], world.states[i].X_WB.q);
}

/// Gives an impulse to a body that is at its point's time; from then on it falls freely.
void push(World& world, BodyId i, const Vec3& F, const Vec3& r) {
  Scratch& s = world.scratch;
  world.states[i].v_WB += s.mobility[i].inv_mass * F;
  world.states[i].w_WB += s.mobility[i].inv_inertia_W * r.cross(F);
  s.falls[i] = 1;
  ++s.impacts_of[i];
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

/// Whether a body comes back to a driven one that threw or carried it just before and still comes on:
/// it is held between that and something else.
bool is_squeezed(const World& world, const Touch& touch, const ContactPoint& point,
                 const Vec3& rb) {
  return (touch.struck || touch.pressed) && world.parameters.rules > 1 &&
         world.bodies[touch.b].kind == Kind::driven &&
         velocity_at(world.states[touch.b], rb).dot(point.n_AB_W) < 0.0;
}

/// Impulse on a body that a driven one squeezes: thrown again and again it would gain speed without
/// end. It is stopped, but gets no faster than what is driven throws, and gains no more energy than
/// that of a hoop which rolls so fast: else what is driven counts as standing still, and insists no
/// more in this step.
Vec3 squeezing_impulse(const World& world, Touch& touch, Encounter e, const Vec3& ra,
                       const Vec3& rb) {
  const Mobility& m = world.scratch.mobility[touch.a];
  State a = world.states[touch.a];
  const Vec3 driven_W = velocity_at(world.states[touch.b], rb);
  const double thrown = (1.0 + touch.pair.elasticity) * driven_W.norm();
  const double most = std::max(a.v_WB.norm(), thrown);
  const double most_energy = std::max(energy_per_mass(world, touch.a, a), hoop_energy(thrown));
  const Vec3 F = impulse_inelastic_smooth(e);
  a.v_WB += m.inv_mass * F;
  a.w_WB += m.inv_inertia_W * ra.cross(F);
  if (a.v_WB.norm() <= most && energy_per_mass(world, touch.a, a) <= most_energy) return F;
  touch.insists = true;
  e.u_W += driven_W;
  return e.u_W.dot(e.n_AB_W) > 0.0 ? impulse_inelastic_smooth(e) : Vec3::Zero();
}

/// Brings the two bodies to where they meet and gives them their impulse.
void strike(World& world, Touch& touch, const Meeting& meeting) {
  Scratch& s = world.scratch;
  const ContactPoint& point = meeting.point;
  advance(world, touch.a, meeting.time);
  if (touch.b_moves) advance(world, touch.b, meeting.time);
  const Vec3 ra = point.p_W - world.states[touch.a].X_WB.p;
  const Vec3 rb = point.p_W - position_at(world, touch.b, meeting.time);
  const Mobility &ma = s.mobility[touch.a], &mb = s.mobility[touch.b];
  Encounter e{point.n_AB_W,
              velocity_at(world.states[touch.a], ra) - velocity_at(world.states[touch.b], rb),
              inverse_mass_at(ma.inv_mass, ma.inv_inertia_W, ra)};
  if (touch.b_moves) e.K_W += inverse_mass_at(mb.inv_mass, mb.inv_inertia_W, rb);
  const double approach = e.u_W.dot(e.n_AB_W);
  Vec3 F = Vec3::Zero();
  if (approach > 0.0) {
    if (is_squeezed(world, touch, point, rb)) {
      F = squeezing_impulse(world, touch, e, ra, rb);
    } else {
      F = meeting.approach > s.lasting_speed ? world.response->impulse(e, touch.pair)
                                             : impulse_inelastic_smooth(e);
    }
    touch.struck = true;
    if (F.dot(e.n_AB_W) > 0.0) {  // it would pull the bodies together
      F = impulse_inelastic_smooth(e);
      ++world.statistics.pulls;
    }
  }
  push(world, touch.a, F, ra);
  if (touch.b_moves) push(world, touch.b, -F, rb);
  if (approach <= 0.0) return;
  if (world.parameters.keep_ledger) book(world, touch, e, F, point.p_W, rb);
  world.events.push_back({touch.a, touch.b, point.p_W, point.n_AB_W, F, meeting.approach, false});
  ++world.statistics.impacts;
}

/// Takes the step back to its start, its bodies as they were.
void start_over(World& world) {
  for (const auto& [i, state] : world.scratch.struck) world.states[i] = state;
  world.events.clear();
  world.struck = world.pushed = {};
  world.statistics.impacts = world.statistics.unfinished_impacts = world.statistics.pulls = 0;
}

/// The impacts of a step, soonest first.
class Queue {
 public:
  explicit Queue(World& world)
      : world_(world), s_(world.scratch), limit_(world.parameters.impacts) {}

  /// When the touch may bring an impact, as its points look now.
  void note(std::uint32_t k) {
    Touch& touch = s_.touches[k];
    if (touch.insists) return set_due(k, kNever);
    const std::optional<Meeting> m = seen_early(touch);
    set_due(k, m ? m->time : kNever);
    if (m) return;
    leave_out_what_passes(touch);
    leave_what_lands_later(touch);
  }

  /// Leaves what will land just behind the end of the step to the next one, where it is an impact.
  /// As a lasting contact it would be held back now, so as to be there at the end and no sooner.
  void leave_what_lands_later(Touch& touch) {
    if (touch.points == 0 || world_.parameters.rules < 2 || was_loaded(s_, touch)) return;
    const auto first = s_.points.begin() + touch.first_point;
    const auto end = std::remove_if(first, first + touch.points, [&](const ContactPoint& p) {
      return lands_later(world_, touch, p);
    });
    touch.points = static_cast<std::uint32_t>(end - first);
  }

  bool empty() const { return s_.coming.empty(); }

  /// @return  whether a sleeping body was hit: the step is back at its start, that body awake
  bool work_off() {
    list_touches_of_bodies();
    while (!s_.coming.empty()) {
      const auto [due, k] = s_.coming.front();
      std::pop_heap(s_.coming.begin(), s_.coming.end(), std::greater<>());
      s_.coming.pop_back();
      if (s_.touches[k].due == due && handle(k)) return true;
    }
    for (const BodyId i : halted_) s_.clock[i] = step_seconds(world_);
    return false;
  }

 private:
  /// A body that turns fast meets with one point after the other: gentle meetings must not use up
  /// the impacts it may have.
  double threshold(const Touch& touch) const {
    const int had = std::max(s_.impacts_of[touch.a], s_.impacts_of[touch.b]);
    return had < kGentle ? followed_speed(world_, touch.a, touch.b) : s_.lasting_speed;
  }

  void set_due(std::uint32_t k, double due) {
    s_.touches[k].due = due;
    if (due == kNever) return;
    s_.coming.emplace_back(due, k);
    std::push_heap(s_.coming.begin(), s_.coming.end(), std::greater<>());
  }

  /// What turns far meets with points that are not yet seen: it is followed at once.
  std::optional<Meeting> seen_early(Touch& touch) {
    if (touch.time + trusted_for(world_, touch) >= step_seconds(world_)) {
      return soonest(world_, touch, threshold(touch));
    }
    const std::size_t count = s_.points.size();
    Touch probe = touch;
    const std::optional<Meeting> m = find_meeting(world_, probe, threshold(touch));
    if (m) {
      touch = probe;
    } else {
      s_.points.resize(count);
    }
    return m;
  }

  /// Follows the touch that seems next; strikes if it is. @return whether it woke a body
  bool handle(std::uint32_t k) {
    Touch& touch = s_.touches[k];
    if (std::max(s_.impacts_of[touch.a], s_.impacts_of[touch.b]) >= limit_) {
      touch.due = kNever;
      world_.statistics.unfinished_impacts = 1;
      halt(touch.a);
      halt(touch.b);
      return false;
    }
    const std::optional<Meeting> meeting = find_meeting(world_, touch, threshold(touch));
    if (!meeting) {
      touch.points = 0;  // they pass each other
      touch.due = kNever;
      return false;
    }
    if (!s_.coming.empty() && meeting->time > s_.coming.front().first) {
      if (meeting->time > touch.due) {
        set_due(k, meeting->time);  // others come first
        return false;
      }
    }
    if (world_.asleep[touch.b]) {
      wake(world_, touch.b);
      start_over(world_);
      return true;
    }
    strike(world_, touch, *meeting);
    const BodyId a = touch.a, b = touch.b;
    const bool b_moves = touch.b_moves;
    turned(a, k);
    if (b_moves) turned(b, k);
    note(k);
    return false;
  }

  /// A body that has had as many impacts as it may stays where the last one left it, to the end of
  /// the step: it loses time, and goes through nothing.
  void halt(BodyId i) {
    if (is_mover(world_, i) && s_.impacts_of[i] >= limit_) halted_.push_back(i);
  }

  /// Leaves out the points of surfaces that seem about to touch gently and pass each other instead.
  void leave_out_what_passes(Touch& touch) {
    if (touch.points == 0 || was_loaded(s_, touch) || !soonest(world_, touch, 0.0)) return;
    const std::size_t count = s_.points.size();
    Touch probe = touch;
    const bool meet = find_meeting(world_, probe, 0.0).has_value();
    s_.points.resize(count);
    if (meet) return;
    const auto first = s_.points.begin() + touch.first_point;
    const auto end = std::remove_if(first, first + touch.points,
                                    [](const ContactPoint& p) { return p.depth <= -kMeets; });
    touch.points = static_cast<std::uint32_t>(end - first);
  }

  /// The body has a new path: what it meets is looked at again.
  void turned(BodyId i, std::uint32_t cause) {
    each_touch_of(i, [&](std::uint32_t k) {
      if (k == cause) return;
      look_again(world_, s_.touches[k], s_.clock[i]);
      note(k);
    });
    seek(i);
  }

  /// One that an impact made faster than it was sought for may meet others within the step.
  void seek(BodyId i) {
    const State& state = world_.states[i];
    const Vec3 moved = state.X_WB.p - s_.struck[s_.place_struck[i]].second.X_WB.p;
    const double far = (step_seconds(world_) - s_.clock[i]) * s_.top_speed[i];
    if (moved.norm() + far <= s_.sought[i]) return;
    for (const BodyId wall : s_.unbounded) meet_late(key_of(false, i, wall), i, wall);
    Capsule bounds_W = state.X_WB * world_.bodies[i].shape->bounds;
    bounds_W.radius += far + s_.fall;
    s_.broad_phase.find_near(bounds_W, s_.near);
    for (const std::uint32_t n : s_.near) {
      const BodyId j = s_.bounded[n];
      if (j == i || distance(bounds_W, s_.bounds_W[n]) > 0.0) continue;
      meet_late(key_of(true, std::min(i, j), std::max(i, j)), std::min(i, j), std::max(i, j));
    }
  }

  /// Adds the touch of a pair that had none at the start of the step, if it may meet now.
  void meet_late(std::uint64_t key, BodyId a, BodyId b) {
    bool known = false;
    const auto is_it = [&](std::uint32_t k) { known = known || s_.touches[k].key == key; };
    each_touch_of(a, is_it);
    each_touch_of(b, is_it);
    if (known) return;
    const std::uint32_t candidate = candidate_of(key, a, b);
    if (!add_touch(world_, candidate, std::max(s_.clock[a], s_.clock[b]))) return;
    Touch& touch = s_.touches.back();
    touch.sliding = world_.response->sliding(touch.pair.friction, step_seconds(world_),
                                             world_.parameters.friction_tau);
    const auto k = static_cast<std::uint32_t>(s_.touches.size() - 1);
    list(k);
    note(k);
  }

  std::uint32_t candidate_of(std::uint64_t key, BodyId a, BodyId b) {
    const auto early = s_.candidates.begin() + static_cast<std::ptrdiff_t>(s_.early_candidates);
    const auto place =
        std::lower_bound(s_.candidates.begin(), early, key,
                         [](const Candidate& c, std::uint64_t value) { return c.key < value; });
    if (place != early && place->key == key) {
      return static_cast<std::uint32_t>(place - s_.candidates.begin());
    }
    const std::size_t count = cache_size(*world_.bodies[a].shape, *world_.bodies[b].shape);
    s_.candidates.push_back({key, a, b, static_cast<std::uint32_t>(s_.normals.size()),
                             static_cast<std::uint32_t>(count)});
    s_.normals.resize(s_.normals.size() + count, Vec3::Zero());
    return static_cast<std::uint32_t>(s_.candidates.size() - 1);
  }

  // Each body's touches: a list from the newest to the oldest.

  void list_touches_of_bodies() {
    for (const BodyId i : s_.movers) s_.first_touch[i] = kNone;
    for (std::uint32_t k = 0; k < s_.touches.size(); ++k) list(k);
  }

  void list(std::uint32_t k) {
    Touch& touch = s_.touches[k];
    touch.next[0] = std::exchange(s_.first_touch[touch.a], k);
    if (touch.b_moves) touch.next[1] = std::exchange(s_.first_touch[touch.b], k);
  }

  template <typename F>
  void each_touch_of(BodyId i, F&& f) {
    if (!is_mover(world_, i)) return;
    for (std::uint32_t k = s_.first_touch[i]; k != kNone;) {
      const Touch& touch = s_.touches[k];
      const std::uint32_t next = touch.next[touch.a == i ? 0 : 1];
      f(k);
      k = next;
    }
  }

  World& world_;
  std::vector<BodyId> halted_;
  Scratch& s_;
  int limit_;
};

}  // namespace

State state_at(const World& world, BodyId i, double t) {
  State s = world.states[i];
  const double passed = t - world.scratch.clock[i];
  const bool moves = is_mover(world, i) || world.bodies[i].kind == Kind::driven;
  if (passed == 0.0 || !moves) return s;
  s.X_WB.p = position_at(world, i, t);
  s.v_WB += passed * pull_on(world, i);
  if (world.bodies[i].kind == Kind::free) {
    turn_freely(s.X_WB.q, s.w_WB, world.inertias[i], passed);
  } else {
    s.X_WB.q = (rotation(passed * s.w_WB) * s.X_WB.q).normalized();
  }
  return s;
}

std::optional<Meeting> find_meeting(World& world, Touch& touch, double threshold) {
  Scratch& s = world.scratch;
  const double trusted = trusted_for(world, touch), step = step_seconds(world);
  const int most = trusted < kNever ? kQueries + 2 * kTurns : kQueries;
  const double least = trusted < kNever ? step / most : 0.0;  // so that it comes to the end
  std::optional<Meeting> m = soonest(world, touch, threshold);
  for (int k = 0; k < most; ++k) {
    if (m && (m->time <= touch.time || -m->point.depth <= kMeets)) {
      m->time = touch.time;
      return m;
    }
    const double seen = std::min(m ? m->time : kNever, touch.time + trusted);
    const double next = std::max(seen, touch.time + least);
    if (next > step) break;
    const Apart before{touch.time, std::max(0.0, -deepest(s, touch))};
    const bool apart = deepest(s, touch) <= world.parameters.slop;
    if (k > 0) s.points.resize(touch.first_point);
    look_again(world, touch, next);
    if (trusted < kNever && apart) go_back(world, touch, before);
    m = soonest(world, touch, threshold);
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
  Scratch& s = world.scratch;
  s.coming.clear();
  Queue queue(world);
  const double slow = s.lasting_speed - 2.0 * s.fall * world.parameters.rate_hz;
  for (std::uint32_t k = 0; k < s.touches.size(); ++k) {
    const Touch& touch = s.touches[k];
    const double fastest = s.top_speed[touch.a] + s.top_speed[touch.b];
    if (fastest > followed_speed(world, touch.a, touch.b)) {
      queue.note(k);
    } else if (fastest > slow) {
      queue.leave_what_lands_later(s.touches[k]);
    }
  }
  return !queue.empty() && queue.work_off();
}

}  // namespace headpin::engine::detail
