#include "engine/meeting.h"

#include <algorithm>

#include "engine/rules.h"

namespace headpin::engine::detail {
namespace {

constexpr double kRounded = 1e-12;  // rounding error of a gap [m]
constexpr int kQueries = 32;        // most queries until they meet; a few suffice unless they graze
constexpr int kTurns = 64;          // most parts of a step for bodies that turn fast
constexpr int kBack = 12;           // most queries to go back from an overlap

/// Position and velocities of a body at the time of a touch.
struct Going {
  Vec3 p_WB, v_WB, w_WB;
};

Going going(const World& world, const Flight& flight, BodyId i, double t, const Vec3& w_WB) {
  const State& s = world.states[i];
  const double passed = t - flight.bodies[i].clock;
  if (passed == 0.0) return {s.X_WB.p, s.v_WB, s.w_WB};
  return {position_at(world, flight, i, t), s.v_WB + passed * pull_on(world, flight, i), w_WB};
}

}  // namespace

std::optional<Meeting> soonest(const World& world, const Flight& flight, const Touches& touches,
                               const Touch& touch, double threshold) {
  std::optional<Meeting> best;
  const Going a = going(world, flight, touch.a, touch.time, touch.w_WA);
  const bool b_moves = world.bodies[touch.b].kind != Kind::fixed;
  const Going b = b_moves ? going(world, flight, touch.b, touch.time, touch.w_WB) : Going{};
  for (const ContactPoint& p : points_of(touches, touch)) {
    Vec3 u = a.v_WB + a.w_WB.cross(p.p_W - a.p_WB);
    if (b_moves) u = u - b.v_WB - b.w_WB.cross(p.p_W - b.p_WB);
    const double speed = u.dot(p.n_AB_W);
    if (speed <= threshold) continue;
    const double gap = -p.depth;
    double t = gap / speed;
    if (flight.bodies[touch.a].falls != flight.bodies[touch.b].falls) {
      const Vec3 g = pull_on(world, flight, touch.a) - pull_on(world, flight, touch.b);
      const double fall = 0.5 * g.dot(p.n_AB_W);
      for (int i = 0; i < 3; ++i) t = gap / std::max(speed + fall * t, 0.5 * speed);
    }
    const double time =
        std::max({touch.time + t, flight.bodies[touch.a].clock, flight.bodies[touch.b].clock});
    if (time > step_seconds(world)) continue;
    // Of several at the same time, take the fastest: their order differs for a mirrored body.
    const bool sooner =
        !best || time < best->time || (time == best->time && speed > best->approach);
    if (sooner) best = {p, time, speed};
  }
  return best;
}

bool lands_later(const World& world, const Flight& flight, const Touch& touch,
                 const ContactPoint& p) {
  const Going a = going(world, flight, touch.a, touch.time, touch.w_WA);
  const Going b = going(world, flight, touch.b, touch.time, touch.w_WB);
  const Vec3 u = a.v_WB + a.w_WB.cross(p.p_W - a.p_WB) - b.v_WB - b.w_WB.cross(p.p_W - b.p_WB);
  const double pull =
      (pull_on(world, flight, touch.a) - pull_on(world, flight, touch.b)).dot(p.n_AB_W);
  const double left = step_seconds(world) - touch.time, speed = u.dot(p.n_AB_W);
  const double gap = -p.depth - left * speed - 0.5 * left * left * pull;
  const double at_end = speed + left * pull, threshold = flight.lasting_speed;
  if (at_end <= 0.0 || gap < -kRounded) return false;
  return at_end * at_end + 2.0 * pull * std::max(0.0, gap) > threshold * threshold;
}

namespace {

double deepest(const Touches& touches, const Touch& touch) {
  double depth = -kNever;
  for (const ContactPoint& p : points_of(touches, touch)) depth = std::max(depth, p.depth);
  return depth;
}

/// A time of the step at which two bodies were apart.
struct Apart {
  double time = 0.0, gap = 0.0;
};

/// Two bodies were apart `before` and now overlap: moves the touch back to the time when they meet.
void go_back(World& world, const Flight& flight, Touches& touches, Touch& touch, Apart before) {
  for (int k = 0; k < kBack; ++k) {
    const double depth = deepest(touches, touch);
    if (depth <= world.parameters.slop) return;
    // Without a point the gap is not known, and large.
    const double share = before.gap < kNever ? before.gap / (before.gap + depth) : 1.0;
    const double part = std::clamp(share, 0.1, 0.9);
    const double t = before.time + part * (touch.time - before.time);
    Touch probe = touch;
    look_again(world, flight, probe, t, touches);
    const double gap = -deepest(touches, probe);
    if (gap > kMeets) {
      touches.points.resize(probe.first_point);
      before = {t, gap};
    } else {
      touch = probe;
    }
  }
}

}  // namespace

double trusted_for(const World& world, const Touch& touch) {
  const double spin = world.states[touch.a].w_WB.norm() + world.states[touch.b].w_WB.norm();
  const double step = step_seconds(world);
  return spin * step <= kFarTurn ? kNever : std::max(kFarTurn / spin, step / kTurns);
}

std::optional<Meeting> find_meeting(World& world, const Flight& flight, Touches& touches,
                                    Touch& touch, double threshold) {
  const double trusted = trusted_for(world, touch), step = step_seconds(world);
  const int most = trusted < kNever ? kQueries + 2 * kTurns : kQueries;
  const double least = trusted < kNever ? step / most : 0.0;  // so that it reaches the end
  const bool turns_far = trusted < kNever, follows = follows_far_turns(world.parameters);
  const bool to_the_end = turns_far && follows, goes_back = turns_far || follows;
  std::optional<Meeting> m = soonest(world, flight, touches, touch, threshold);
  for (int k = 0; k < most; ++k) {
    if (m && (m->time <= touch.time || -m->point.depth <= kMeets)) {
      m->time = touch.time;
      return m;
    }
    const double seen = std::min(m ? m->time : kNever, touch.time + trusted);
    double next = std::max(seen, touch.time + least);
    if (next > step) {
      if (!to_the_end || touch.time >= step) break;
      next = step;  // what turns may have come round by then
    }
    const Apart before{touch.time, std::max(0.0, -deepest(touches, touch))};
    const bool apart = deepest(touches, touch) <= world.parameters.slop;
    if (k > 0) touches.points.resize(touch.first_point);
    look_again(world, flight, touch, next, touches);
    if (apart && goes_back) go_back(world, flight, touches, touch, before);
    m = soonest(world, flight, touches, touch, threshold);
  }
  return std::nullopt;
}

}  // namespace headpin::engine::detail
