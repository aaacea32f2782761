#include "engine/at_end.h"

namespace headpin::engine::detail {
namespace {

// Velocities are those at the end of the step. A falling body moves with the mean of the velocities
// at the start and the end. A carried body moves with the end velocity, for which its contacts were
// solved. A partly carried body moves with a velocity in between, which keeps its energy. A body that
// slides on a level surface moves with the mean of its level velocities.
void move_to_end(const World& world, const Flight& flight, const Solved& solved, BodyId i,
                 State& s) {
  const double left = step_seconds(world) - flight.bodies[i].clock;
  const double falls = 1.0 - solved.carried[i];
  s.X_WB.p += left * s.v_WB;
  if (falls > 0.0) s.X_WB.p -= (0.5 * falls * left * left) * world.parameters.gravity_W;
  s.X_WB.p -= (0.5 * left) * solved.slowed[i];
  turn_freely(s.X_WB.q, s.w_WB, world.inertias[i], left);
}

void drive_to_end(const World& world, State& s) {
  const double dt = step_seconds(world);
  s.X_WB.p += dt * s.v_WB;
  s.X_WB.q = (rotation(dt * s.w_WB) * s.X_WB.q).normalized();
}

}  // namespace

void to_end(const World& world, const Flight& flight, const Solved& solved, BodyId i, State& s) {
  if (is_mover(world, i)) {
    move_to_end(world, flight, solved, i, s);
  } else if (world.bodies[i].kind == Kind::driven) {
    drive_to_end(world, s);
  }
}

Pose pose_at_end(const World& world, const Flight& flight, const Solved& solved, BodyId i) {
  State s = world.states[i];
  to_end(world, flight, solved, i, s);
  return s.X_WB;
}

std::span<const ContactPoint> points_at_end(const World& world, const Touches& touches,
                                            const Touch& touch, const Pose& X_WA, const Pose& X_WB,
                                            AtEnd& end) {
  const Candidate& c = touches.pairs->candidates[touch.candidate];
  const auto kept = touches.pairs->normals.begin() + c.first_normal;
  end.normals.assign(kept, kept + c.normals);
  end.points.clear();
  const bool swapped = c.a != touch.a;
  contacts_of(world, c, end.normals, swapped ? X_WB : X_WA, swapped ? X_WA : X_WB, 0.0, end.queries,
              end.points);
  keep_points_of(world, c, touch, 0, end.points);
  for (ContactPoint& p : end.points) {
    if (swapped) p.n_AB_W = -p.n_AB_W;
  }
  return end.points;
}

NormalRow row_at(const Flight& flight, const Touch& touch, const ContactPoint& point,
                 const Vec3& p_WA, const Vec3& p_WB) {
  const Mobility& ma = flight.mobility[touch.a];
  NormalRow row;
  row.n = point.n_AB_W;
  row.ra_n = (point.p_W - p_WA).cross(row.n);
  row.rb_n = (point.p_W - p_WB).cross(row.n);
  row.ia = ma.inv_inertia_W * row.ra_n;
  row.ib = Vec3::Zero();
  double k_nn = ma.inv_mass + row.ra_n.dot(row.ia);
  if (touch.b_moves) {
    const Mobility& mb = flight.mobility[touch.b];
    row.ib = mb.inv_inertia_W * row.rb_n;
    k_nn += mb.inv_mass + row.rb_n.dot(row.ib);
  }
  row.mass = 1.0 / k_nn;
  return row;
}

}  // namespace headpin::engine::detail
