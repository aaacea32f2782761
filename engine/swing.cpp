#include <algorithm>

#include "engine/sustained_rows.h"

namespace headpin::engine::detail {
namespace {

constexpr int kRounds = 16;  // most points that are stopped in a touch

double time_left(const World& world, const Touch& touch) {
  const Scratch& s = world.scratch;
  return step_seconds(world) - std::max(s.clock[touch.a], s.clock[touch.b]);
}

/// Whether the points a touch now has say little about the end of the step.
bool swings(const World& world, const Touch& touch) {
  const Vec3 spin = world.states[touch.a].w_WB - world.states[touch.b].w_WB;
  if (spin.norm() * time_left(world, touch) > kFarTurn) return true;
  return touch.depth > deep_for(world, touch.a, touch.b);
}

/// Takes so much of the approach at a point of the end that it is not deep there; no more than there
/// is, so that energy is only taken. What is driven counts as standing still: pushed here step after
/// step, a body that cannot give way would get ever faster. @return whether there was any
bool stop_at(World& world, const Touch& touch, const ContactPoint& point, const NormalRow& row) {
  const State &sa = world.states[touch.a], &sb = world.states[touch.b];
  const bool b_stands = !touch.b_moves && world.parameters.rules > 1;
  const double b_nears = b_stands ? 0.0 : row.n.dot(sb.v_WB) + row.rb_n.dot(sb.w_WB);
  const double approach = row.n.dot(sa.v_WB) + row.ra_n.dot(sa.w_WB) - b_nears;
  if (approach <= 0.0) return false;
  const double j = row.mass * std::min(approach, point.depth / time_left(world, touch));
  if (touch.b_moves) {
    push_by<Other::moving>(world, touch, row, j);
    return true;
  }
  push_by<Other::still>(world, touch, row, j);
  if (world.bodies[touch.b].kind != Kind::driven) return true;
  world.pushed.energy -= j * b_nears;
  world.pushed.momentum -= j * row.n;
  world.pushed.angular_momentum -= j * point.p_W.cross(row.n);
  return true;
}

}  // namespace

std::span<const ContactPoint> points_at_end(World& world, const Touch& touch, const Pose& X_WA,
                                            const Pose& X_WB) {
  Scratch& s = world.scratch;
  const Candidate c = s.candidates[touch.candidate];
  const auto kept = s.normals.begin() + c.first_normal;
  s.kept_normals.assign(kept, kept + c.normals);
  s.points.swap(s.end_points);
  s.points.clear();
  const bool swapped = c.a != touch.a;
  contacts_of(world, c, swapped ? X_WB : X_WA, swapped ? X_WA : X_WB, 0.0);
  for (ContactPoint& p : s.points) {
    if (swapped) p.n_AB_W = -p.n_AB_W;
  }
  s.points.swap(s.end_points);
  std::copy(s.kept_normals.begin(), s.kept_normals.end(), kept);  // the next step starts from now
  return s.end_points;
}

NormalRow row_at(const World& world, const Touch& touch, const ContactPoint& point,
                 const Vec3& p_WA, const Vec3& p_WB) {
  const Mobility& ma = world.scratch.mobility[touch.a];
  NormalRow row;
  row.n = point.n_AB_W;
  row.ra_n = (point.p_W - p_WA).cross(row.n);
  row.rb_n = (point.p_W - p_WB).cross(row.n);
  row.ia = ma.inv_inertia_W * row.ra_n;
  row.ib = Vec3::Zero();
  double k_nn = ma.inv_mass + row.ra_n.dot(row.ia);
  if (touch.b_moves) {
    const Mobility& mb = world.scratch.mobility[touch.b];
    row.ib = mb.inv_inertia_W * row.rb_n;
    k_nn += mb.inv_mass + row.rb_n.dot(row.ib);
  }
  row.mass = 1.0 / k_nn;
  return row;
}

void stop_swings(World& world) {
  Scratch& s = world.scratch;
  for (Touch& touch : s.touches) {
    if (touch.points == 0) continue;
    touch.swings = swings(world, touch);
    for (int round = 0; touch.swings && round < kRounds; ++round) {
      const Pose X_WA = pose_at_end(world, touch.a), X_WB = pose_at_end(world, touch.b);
      const ContactPoint* worst = nullptr;
      for (const ContactPoint& p : points_at_end(world, touch, X_WA, X_WB)) {
        const double least = worst ? worst->depth : touch.depth + world.parameters.slop;
        if (!p.guessed && p.depth > least) worst = &p;
      }
      if (!worst) break;
      if (!stop_at(world, touch, *worst, row_at(world, touch, *worst, X_WA.p, X_WB.p))) break;
    }
  }
}

}  // namespace headpin::engine::detail
