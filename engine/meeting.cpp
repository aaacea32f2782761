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

/// The two bodies of a touch, at its time.
struct Two {
  Two(const World& world, const Flight& flight, const Touch& touch)
      : a(going(world, flight, touch.a, touch.time, touch.w_WA)),
        b_moves(world.bodies[touch.b].kind != Kind::fixed),
        b(b_moves ? going(world, flight, touch.b, touch.time, touch.w_WB) : Going{}) {}

  /// Speed at which they approach each other at a point [m/s].
  double approach(const ContactPoint& p) const {
    Vec3 u = a.v_WB + a.w_WB.cross(p.p_W - a.p_WB);
    if (b_moves) u = u - b.v_WB - b.w_WB.cross(p.p_W - b.p_WB);
    return u.dot(p.n_AB_W);
  }

  Going a;
  bool b_moves;
  Going b;
};

}  // namespace

std::optional<Meeting> soonest(const World& world, const Flight& flight, const Touches& touches,
                               const Touch& touch, double threshold) {
  std::optional<Meeting> best;
  const Two two(world, flight, touch);
  for (const ContactPoint& p : points_of(touches, touch)) {
    const double speed = two.approach(p);
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

/// Points that are lasting contacts, which do not show when and where two bodies meet: those that are slow,
/// and not deeper than that speed has brought them from a start of the search.
struct Lasting {
  Lasting(const World& world, const Flight& flight, const Touches& touches, const Touch& touch,
          double threshold)
      : start(touch.time), depth(world.parameters.slop), speed(threshold) {
    if (!leaves_out_what_lasts(world.parameters)) speed = -1.0;  // none are left out
    const Two two(world, flight, touch);
    for (const ContactPoint& p : points_of(touches, touch)) {
      if (std::abs(two.approach(p)) <= speed) depth = std::max(depth, p.depth);
    }
  }

  double start, depth, speed;
};

/// Depth of the deepest point that is no lasting contact; -kNever without any [m].
double deepest(const World& world, const Flight& flight, const Touches& touches, const Touch& touch,
               const Lasting& lasting) {
  double depth = -kNever;
  const double still = lasting.depth + lasting.speed * (touch.time - lasting.start);
  const Two two(world, flight, touch);
  for (const ContactPoint& p : points_of(touches, touch)) {
    if (p.depth <= still && std::abs(two.approach(p)) <= lasting.speed) continue;
    depth = std::max(depth, p.depth);
  }
  return depth;
}

/// A time of the step at which two bodies were apart.
struct Apart {
  double time = 0.0, gap = 0.0;
};

/// Two bodies were apart `before` and now overlap: moves the touch back to the time when they meet.
void go_back(const World& world, const Flight& flight, Touches& touches, Touch& touch,
             const Lasting& lasting, Apart before) {
  // Without a point the gap is not known; it is large, unless bodies that are apart have no points.
  const double unknown = shows_only_overlap(world, touch.a, touch.b) ? 0.5 : 1.0;
  for (int k = 0; k < kBack; ++k) {
    const double depth = deepest(world, flight, touches, touch, lasting);
    if (depth <= world.parameters.slop) return;
    const double share = before.gap < kNever ? before.gap / (before.gap + depth) : unknown;
    const double part = std::clamp(share, 0.1, 0.9);
    const double t = before.time + part * (touch.time - before.time);
    Touch probe = touch;
    look_again(world, flight, probe, t, touches);
    const double gap = -deepest(world, flight, touches, probe, lasting);
    if (gap > kMeets) {
      touches.points.resize(probe.first_point);
      before = {t, gap};
    } else {
      touch = probe;
    }
  }
}

/// How far two bodies may move against each other between two looks of the paper's detection: what overlaps in
/// between alone does so by less than 0.1 mm where they are about as round as a ball or a skittle [m].
double unseen_way(const World& world, BodyId a, BodyId b) {
  double least = kNever;
  for (const BodyId i : {a, b}) {
    for (const double radius : world.bodies[i].shape->part_radius) least = std::min(least, radius);
  }
  return 0.08 * least;
}

}  // namespace

double trusted_for(const World& world, const Flight& flight, const Touch& touch) {
  const double spin = world.states[touch.a].w_WB.norm() + world.states[touch.b].w_WB.norm();
  const double step = step_seconds(world);
  double trusted = spin * step <= kFarTurn ? kNever : kFarTurn / spin;
  if (looks_often(world.parameters) && shows_only_overlap(world, touch.a, touch.b)) {
    const double way = unseen_way(world, touch.a, touch.b);
    const double speed = fastest_approach(world, flight, touch.a, touch.b);
    if (speed * step > way) trusted = std::min(trusted, way / speed);
  }
  return trusted < kNever ? std::max(trusted, step / kTurns) : kNever;
}

std::optional<Meeting> find_meeting(const World& world, const Flight& flight, Touches& touches,
                                    Touch& touch, double threshold) {
  const double trusted = trusted_for(world, flight, touch), step = step_seconds(world);
  const int most = trusted < kNever ? kQueries + 2 * kTurns : kQueries;
  const double least = trusted < kNever ? step / most : 0.0;  // so that it reaches the end
  const bool turns_far = trusted < kNever, follows = follows_far_turns(world.parameters);
  const bool to_the_end = (turns_far && follows) || shows_only_overlap(world, touch.a, touch.b);
  bool goes_back = turns_far || follows;
  double went_back_to = -step;
  const Lasting lasting(world, flight, touches, touch, threshold);
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
    const double depth = deepest(world, flight, touches, touch, lasting);
    const Apart before{touch.time, std::max(0.0, -depth)};
    const bool apart = depth <= world.parameters.slop;
    if (k > 0) touches.points.resize(touch.first_point);
    look_again(world, flight, touch, next, touches);
    if (apart && goes_back) go_back(world, flight, touches, touch, lasting, before);
    m = soonest(world, flight, touches, touch, threshold);
    if (!m && touch.time < next && leaves_out_what_lasts(world.parameters)) {
      // They meet there without approaching: not much later it will be the same.
      goes_back = touch.time > went_back_to + step / 16.0;
      went_back_to = touch.time;
    }
  }
  return std::nullopt;
}

void leave_out_fast(const World& world, const Flight& flight, Touches& touches, Touch& touch,
                    double threshold) {
  const Two two(world, flight, touch);
  const auto first = touches.points.begin() + touch.first_point;
  const auto end = std::remove_if(first, first + touch.points, [&](const ContactPoint& p) {
    return p.depth <= -kMeets && two.approach(p) > threshold;
  });
  touch.points = static_cast<std::uint32_t>(end - first);
}

std::size_t look_ahead(const World& world, const Flight& flight, std::uint32_t candidate, double t,
                       std::size_t had, Touches& touches) {
  const Candidate& c = touches.pairs->candidates[candidate];
  if (!shows_only_overlap(world, c.a, c.b)) return 0;
  const double threshold = followed_speed(world, flight, c.a, c.b);
  const double gravity = flight.fall / step_seconds(world);
  if (flight.bodies[c.a].top_speed + flight.bodies[c.b].top_speed + gravity <= threshold) return 0;
  const std::size_t known = touches.all.size();
  const auto is_known = [&](std::uint32_t part) {
    return std::any_of(touches.all.begin() + static_cast<std::ptrdiff_t>(had),
                       touches.all.begin() + static_cast<std::ptrdiff_t>(known),
                       [&](const Touch& touch) { return touch.part == part; });
  };
  for (std::uint32_t part = 0; part < parts_touched(world, c); ++part) {
    if (is_known(part)) continue;
    Touch touch = touch_of(world, candidate, touches);
    touch.part = part;
    touch.time = t;
    touch.first_point = static_cast<std::uint32_t>(touches.points.size());
    if (find_meeting(world, flight, touches, touch, threshold)) {
      touches.all.push_back(touch);
    } else {
      touches.points.resize(touch.first_point);
    }
  }
  std::sort(touches.all.begin() + static_cast<std::ptrdiff_t>(had), touches.all.end(),
            [](const Touch& p, const Touch& q) { return p.part < q.part; });
  return touches.all.size() - known;
}

}  // namespace headpin::engine::detail
