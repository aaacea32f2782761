#include <algorithm>

#include "engine/at_end.h"
#include "engine/rules.h"
#include "engine/stages.h"

namespace headpin::engine::detail {
namespace {

/// The part of n across gravity.
Vec3 level(const Vec3& n, const Vec3& gravity) {
  const double g2 = gravity.squaredNorm();
  return g2 > 0.0 ? Vec3(n - n.dot(gravity) / g2 * gravity) : n;
}

/// Whether an overlap is so deep that its direction is unreliable: five times a deep one.
bool is_far_in(const World& world, const Touch& touch, double depth) {
  return touch.points > 0 && depth > 5.0 * deep_for(world, touch.a, touch.b);
}

/// Lists the bodies that overlap a driven body and are pressed far into it or into another body.
void find_pinned(const World& world, const Touches& touches, const Solved& solved,
                 std::vector<BodyId>& pinned) {
  pinned.clear();
  if (world.roll.driven.empty() || !bounds_squeezes(world.parameters)) return;
  for (std::size_t k = 0; k < touches.all.size(); ++k) {
    const Touch& touch = touches.all[k];
    if (touch.points == 0 || !touch.b_driven) continue;
    if (solved.touches[k].depth > world.parameters.slop) pinned.push_back(touch.a);
  }
  std::erase_if(pinned, [&](BodyId i) {
    for (std::size_t k = 0; k < touches.all.size(); ++k) {
      const Touch& touch = touches.all[k];
      if (touch.a != i && touch.b != i) continue;
      if (is_far_in(world, touch, solved.touches[k].depth)) return false;
    }
    return true;
  });
}

bool is_pinned(const std::vector<BodyId>& pinned, const Touch& touch) {
  return std::any_of(pinned.begin(), pinned.end(),
                     [&](BodyId i) { return i == touch.a || i == touch.b; });
}

/// Moves a touch's bodies out of an overlap, by the part that earlier nudges have not corrected.
void nudge(const World& world, const Flight& flight, const Touch& touch, const ContactPoint& point,
           const NormalRow& row, double part, Workspace& w) {
  const Mobility &ma = flight.mobility[touch.a], &mb = flight.mobility[touch.b];
  Nudge &a = w.nudges[touch.a], &b = w.nudges[touch.b];
  const auto note = [&](BodyId i) {
    if (w.nudges[i].p.isZero(0.0) && w.nudges[i].w.isZero(0.0)) w.nudged.push_back(i);
  };
  double apart = -row.n.dot(a.p) - row.ra_n.dot(a.w);
  if (touch.b_moves) apart += row.n.dot(b.p) + row.rb_n.dot(b.w);
  const double more = row.mass * (part * (point.depth - world.parameters.slop) - apart);
  if (more <= 0.0) return;
  // An estimated depth moves bodies across gravity only and turns nothing, so that it adds no
  // energy. A pinned body is not turned, and does not rise out of a driven body: it would fall from
  // there.
  const bool pinned = is_pinned(w.pinned, touch);
  const bool flat = point.guessed || (pinned && touch.b_driven);
  const Vec3 n = flat ? level(row.n, world.parameters.gravity_W) : row.n;
  const double turn = point.guessed || pinned ? 0.0 : more;
  note(touch.a);
  a.p -= more * ma.inv_mass * n;
  a.w -= turn * row.ia;
  if (!touch.b_moves) return;
  note(touch.b);
  b.p += more * mb.inv_mass * n;
  b.w += turn * row.ib;
}

}  // namespace

void push_apart(World& world, const Touches& touches, const Flight& flight, const Solved& solved,
                Workspace& w) {
  const Parameters& p = world.parameters;
  double part = 0.0;  // part of an overlap to correct: the same per unit of time at every rate
  w.nudged.clear();
  w.nudges.resize(world.bodies.size());
  find_pinned(world, touches, solved, w.pinned);
  const auto take_back = [&](const Touch& touch, const ContactPoint& point, const NormalRow& row) {
    if (point.depth <= p.slop) return;
    if (part == 0.0) part = 1.0 - power(1.0 - p.push, 240.0 / p.rate_hz);
    nudge(world, flight, touch, point, row, part, w);
  };
  for (std::size_t n = 0; n < touches.all.size(); ++n) {
    const Touch& touch = touches.all[n];
    const SolvedTouch& s = solved.touches[n];
    if (s.insists) continue;  // pushing would lift a body that cannot give way
    if (!s.swings) {
      for (std::uint32_t k = 0; k < s.deep; ++k) {
        const DeepRow& deep = solved.deep_rows[s.first_deep + k];
        take_back(touch, touches.points[deep.point], deep.row);
      }
      continue;
    }
    const Pose &X_WA = world.states[touch.a].X_WB, &X_WB = world.states[touch.b].X_WB;
    for (const ContactPoint& point :
         points_at_end(world, touches, touch, X_WA, X_WB, w.each_thread[0].at_end)) {
      take_back(touch, point, row_at(flight, touch, point, X_WA.p, X_WB.p));
    }
  }
  for (const BodyId i : w.nudged) {
    Pose& X_WB = world.states[i].X_WB;
    X_WB.p += w.nudges[i].p;
    X_WB.q = (rotation(w.nudges[i].w) * X_WB.q).normalized();
    w.nudges[i] = {};
  }
}

}  // namespace headpin::engine::detail
