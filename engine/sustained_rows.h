#pragma once

#include <algorithm>

#include "engine/paths.h"
#include "engine/rules.h"

/// Data of the solver of lasting contacts: rows for normals, blocks of them, and friction, twist
/// and roll of a touch. Private to the engine.
namespace headpin::engine::detail {

/// Cosine between axis and normal from which a body stands; then it has no rolling resistance.
inline constexpr double kStanding = 0.9;

/// The rows of a touch depend on each other if their determinant, divided by the product of the
/// diagonal, is below this. The inverse would then be noise. For four points of one plane it is
/// 1e-9 times a measure of their spread.
inline constexpr double kDependent = 1e-12;

/// A smaller load counts as zero, because its inverse is not a usable number [N s].
inline constexpr double kNoLoad = 1e-150;

/// Kind of body B of a touch. The sums leave out bodies without velocity.
enum class Other { still, driven, moving };

inline Other other_of(const Touch& touch) {
  if (touch.b_moves) return Other::moving;
  return touch.b_driven ? Other::driven : Other::still;
}

inline void apply_impulse(State& state, const Mobility& m, const Vec3& F,
                          const Vec3& inv_inertia_torque) {
  state.v_WB += m.inv_mass * F;
  state.w_WB += inv_inertia_torque;
}

// Where the touch's bodies were when its points were found; B only if it is not still.
struct Arms {
  Vec3 p_WA, p_WB;
};

template <Other other>
Arms arms_of(const World& world, const Flight& flight, const Touch& touch) {
  Arms arms;
  arms.p_WA = position_at(world, flight, touch.a, touch.time);
  if constexpr (other != Other::still) {
    arms.p_WB = position_at(world, flight, touch.b, touch.time);
  }
  return arms;
}

/// The loads of the touch in the last step; none if it is fresh.
inline std::span<const Load> last_loads(const Memory& memory, const Touch& touch) {
  if (touch.fresh) return {};
  const PastTouch& last = memory.touches[touch.last];
  return std::span(memory.loads).subspan(last.first_load, last.loads);
}

/// Impulse of a point of a touch in the last step: that of the k-th point, or of the point with
/// this feature if the order changed. A new point in place of one that is gone gets its impulse: an
/// edge may have been found as a part of another face.
inline double last_impulse(const World& world, std::span<const Load> loads,
                           std::span<const ContactPoint> points, std::uint32_t k) {
  const std::uint32_t feature = points[k].feature;
  if (k < loads.size() && loads[k].feature == feature) return loads[k].impulse;
  for (const Load& load : loads) {
    if (load.feature == feature) return load.impulse;
  }
  if (k >= loads.size() || !keeps_loads_in_place(world.parameters)) return 0.0;
  for (const ContactPoint& point : points) {
    if (point.feature == loads[k].feature) return 0.0;
  }
  return loads[k].impulse;
}

/// The bodies that impulses act on.
struct Pushed {
  State* states;
  const Mobility* mobility;
};

template <Other other>
void push_by(const Pushed& bodies, const Touch& touch, const NormalRow& row, double impulse) {
  apply_impulse(bodies.states[touch.a], bodies.mobility[touch.a], -impulse * row.n,
                -impulse * row.ia);
  if constexpr (other == Other::moving) {
    apply_impulse(bodies.states[touch.b], bodies.mobility[touch.b], impulse * row.n,
                  impulse * row.ib);
  }
}

/// An island and the data for its solution.
struct Island {
  World& world;
  const Flight& flight;
  const Touch* touches;        ///< all touches, by their numbers
  const ContactPoint* points;  ///< points of all touches
  SolvedTouch* solved;         ///< results of all touches
  Solved& result;
  Rows& rows;
  Pushed bodies;
  IslandPart& part;                          ///< gets what is found for later stages
  std::span<const std::uint32_t> each = {};  ///< numbers of its touches
  std::uint32_t first_load = 0;              ///< of the next touch
  std::span<NormalRow> normals = {};         ///< rows of its touches, set by add_rows
};

/// The island's bodies that move, sorted.
inline void list_bodies(const Island& s, std::vector<BodyId>& bodies) {
  bodies.clear();
  for (const std::uint32_t k : s.each) {
    const Touch& touch = s.touches[k];
    bodies.push_back(touch.a);
    if (touch.b_moves) bodies.push_back(touch.b);
  }
  std::sort(bodies.begin(), bodies.end());
  bodies.erase(std::unique(bodies.begin(), bodies.end()), bodies.end());
}

template <Other other>
void add_normal_rows(const Island& s, const Touch& touch, const SolvedTouch& solved) {
  World& world = s.world;
  const Mobility &ma = s.bodies.mobility[touch.a], &mb = s.bodies.mobility[touch.b];
  const Arms arms = arms_of<other>(world, s.flight, touch);
  const double left = std::max(step_seconds(world) - touch.time, 1e-9 * step_seconds(world));
  const ContactPoint* const points = s.points + touch.first_point;
  const std::span<const Load> last = last_loads(world.memory, touch);
  NormalRow* const rows = s.normals.data() + solved.first_row;
  for (std::uint32_t k = 0; k < touch.points; ++k) {
    const ContactPoint& p = points[k];
    NormalRow& row = rows[k];
    row.feature = p.feature;
    row.n = p.n_AB_W;
    row.ra_n = (p.p_W - arms.p_WA).cross(row.n);
    row.ia = ma.inv_inertia_W * row.ra_n;
    double k_nn = ma.inv_mass + row.ra_n.dot(row.ia);
    if constexpr (other != Other::still) row.rb_n = (p.p_W - arms.p_WB).cross(row.n);
    if constexpr (other == Other::moving) {
      row.ib = mb.inv_inertia_W * row.rb_n;
      k_nn += mb.inv_mass + row.rb_n.dot(row.ib);
    }
    row.mass = 1.0 / k_nn;
    row.allowed = p.depth < 0.0 ? -p.depth / left : 0.0;
    row.impulse = last_impulse(world, last, {points, touch.points}, k);
    if (row.impulse > 0.0) push_by<other>(s.bodies, touch, row, row.impulse);
  }
}

/// Calls f.template operator()<n>() for a touch with n = 2 to 4 rows, which are solved as a block.
/// @return false for other numbers
template <typename F>
bool with_rows(const SolvedTouch& touch, F&& f) {
  switch (touch.rows) {
    case 2:
      return f.template operator()<2>();
    case 3:
      return f.template operator()<3>();
    case 4:
      return f.template operator()<4>();
    default:
      return false;
  }
}

/// Prepares to solve the rows of a touch as a block, so that a flat base stands without iteration.
/// Rows that are almost equal, of points at one place or on one line, are solved one by one
/// instead.
template <Other other, int n>
void add_block(const Island& s, const Touch& touch, SolvedTouch& solved) {
  const NormalRow* const rows = s.normals.data() + solved.first_row;
  double inv_mass = s.bodies.mobility[touch.a].inv_mass;
  if constexpr (other == Other::moving) inv_mass += s.bodies.mobility[touch.b].inv_mass;
  Eigen::Matrix<double, n, n> K;
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k <= i; ++k) {
      double value = inv_mass * rows[i].n.dot(rows[k].n) + rows[i].ra_n.dot(rows[k].ia);
      if constexpr (other == Other::moving) value += rows[i].rb_n.dot(rows[k].ib);
      K(i, k) = K(k, i) = value;
    }
    // The load of four points of one plane is not unique; this selects one way to share it.
    K(i, i) *= 1.0 + 1e-9;
  }
  Eigen::Matrix<double, n, n> inverse;
  double determinant = 0.0;
  bool independent = false;
  K.computeInverseAndDetWithCheck(inverse, determinant, independent,
                                  kDependent * K.diagonal().prod());
  solved.block = kNone;
  if (!independent) return;
  solved.block = static_cast<std::uint32_t>(s.rows.blocks.size());
  s.rows.blocks.emplace_back().topLeftCorner<n, n>() = inverse;
}

/// Point and normal of the friction of a touch: the mean of its points, weighted by their loads.
struct Foot {
  Vec3 p_W = Vec3::Zero(), n = Vec3::Zero();
  double spread = 0.0;  // of the points about the foot, root of the mean square [m]
};

/// @param level  measure the spread across the normal: what lies along it is no arm of a twist
inline Foot foot_of(std::span<const NormalRow> rows, const ContactPoint* points, bool level) {
  if (rows.size() == 1) return {points[0].p_W, rows[0].n, 0.0};
  double load = 0.0, deepest = points[0].depth;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    load += rows[k].impulse;
    deepest = std::max(deepest, points[k].depth);
  }
  // If there is no load yet, the points that touch first count.
  const auto weight = [&](std::size_t k) {
    return load > kNoLoad ? rows[k].impulse : (points[k].depth > deepest - 1e-4 ? 1.0 : 0.0);
  };
  Foot foot;
  const Vec3 from = points[0].p_W;
  double sum = 0.0, squares = 0.0;
  bool one_plane = true;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const double w = weight(k);
    const Vec3 r = points[k].p_W - from;
    sum += w;
    foot.p_W += w * r;
    squares += w * r.squaredNorm();
    one_plane = one_plane && rows[k].n == rows[0].n;
  }
  const double inverse = 1.0 / sum;
  foot.p_W *= inverse;
  foot.spread = std::sqrt(std::max(0.0, squares * inverse - foot.p_W.squaredNorm()));
  foot.p_W += from;
  foot.n = rows[0].n;
  if (one_plane) return foot;
  // Surfaces on opposite sides of a body have the same tangents, so their normals count as one.
  std::size_t most = 0;
  for (std::size_t k = 1; k < rows.size(); ++k) most = weight(k) > weight(most) ? k : most;
  const Vec3 side = rows[most].n;
  foot.n = Vec3::Zero();
  for (std::size_t k = 0; k < rows.size(); ++k) {
    foot.n += std::copysign(weight(k), rows[k].n.dot(side)) * rows[k].n;
  }
  foot.n.normalize();
  if (!level) return foot;
  double along = 0.0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const double height = foot.n.dot(points[k].p_W - foot.p_W);
    along += weight(k) * height * height;
  }
  foot.spread = std::sqrt(std::max(0.0, foot.spread * foot.spread - along * inverse));
  return foot;
}

inline Vec3 tangent(const Vec3& n) {
  const Vec3 t = std::abs(n.x()) < 0.7 ? Vec3(0.0, n.z(), -n.y()) : Vec3(-n.z(), 0.0, n.x());
  return t / std::sqrt(t.squaredNorm());
}

/// About which axes rolling resistance acts on the bodies of a touch.
enum class Rolling { freely, about_axis, about_any };

/// Rolling resistance acts on a lying body about its axis, more exactly the part across the normal,
/// and on a ball about any axis. A standing body does not roll.
inline Rolling rolling_of(const World& world, const Touch& touch, const Vec3& n, Vec3& axis_W) {
  for (const BodyId i : {touch.a, touch.b}) {
    if (world.bodies[i].kind != Kind::free || world.bodies[i].material.rolling_arm == 0.0) continue;
    if (is_ball(world.inertias[i])) return Rolling::about_any;
    const Vec3 axis = axis_of_revolution(world.inertias[i], world.states[i].X_WB.q);
    const double along = axis.dot(n);
    if (std::abs(along) >= kStanding) continue;
    axis_W = (axis - along * n).normalized();
    return Rolling::about_axis;
  }
  return Rolling::freely;
}

/// The part of a turn that rolling resistance acts on.
inline Vec3 rolling_part(const FrictionRows& f, const Vec3& w) {
  return f.rolls_any ? Vec3(w - f.n.dot(w) * f.n) : Vec3(f.axis.dot(w) * f.axis);
}

/// Velocity changes by unit impulses of the friction rows, summed over the bodies that move.
struct Yield {
  Eigen::Matrix2d slip = Eigen::Matrix2d::Zero();
  double twist = 0.0, roll = 0.0;
};

inline void add_side(const FrictionRows& f, FrictionSide& side, const Mobility& m, Yield& yield) {
  for (std::size_t i = 0; i < 2; ++i) side.i[i] = m.inv_inertia_W * side.r_t[i];
  const double off = side.r_t[0].dot(side.i[1]);
  yield.slip(0, 0) += m.inv_mass + side.r_t[0].dot(side.i[0]);
  yield.slip(1, 1) += m.inv_mass + side.r_t[1].dot(side.i[1]);
  yield.slip(0, 1) += off;
  yield.slip(1, 0) += off;
  side.twist_i = m.inv_inertia_W * f.n;
  yield.twist += f.n.dot(side.twist_i);
  if (f.roll_arm == 0.0) return;
  yield.roll += f.rolls_any ? std::max(f.t[0].dot(m.inv_inertia_W * f.t[0]),
                                       f.t[1].dot(m.inv_inertia_W * f.t[1]))
                            : f.axis.dot(m.inv_inertia_W * f.axis);
}

/// Apply the impulses of a pair's friction: along the tangents, about the normal, and of rolling.
template <Other other>
void push_along(const Pushed& bodies, const Touch& touch, const FrictionRows& f, const Vec2& slip) {
  const Vec3 F = slip[0] * f.t[0] + slip[1] * f.t[1];
  apply_impulse(bodies.states[touch.a], bodies.mobility[touch.a], F,
                slip[0] * f.a.i[0] + slip[1] * f.a.i[1]);
  if constexpr (other == Other::moving) {
    apply_impulse(bodies.states[touch.b], bodies.mobility[touch.b], -F,
                  -slip[0] * f.b.i[0] - slip[1] * f.b.i[1]);
  }
}

template <Other other>
void twist_by(const Pushed& bodies, const Touch& touch, const FrictionRows& f, double twist) {
  bodies.states[touch.a].w_WB += twist * f.a.twist_i;
  if constexpr (other == Other::moving) bodies.states[touch.b].w_WB -= twist * f.b.twist_i;
}

template <Other other>
void roll_by(const Pushed& bodies, const Touch& touch, const Vec3& roll) {
  bodies.states[touch.a].w_WB += bodies.mobility[touch.a].inv_inertia_W * roll;
  if constexpr (other == Other::moving) {
    bodies.states[touch.b].w_WB -= bodies.mobility[touch.b].inv_inertia_W * roll;
  }
}

/// Softens friction so that it leaves at least a part `kept` of the slip. If it leaves none,
/// contacts whose loads alternate may have no solution.
/// @return whether it left less before
inline bool soften(FrictionRows& f, double kept) {
  if (f.kept >= kept) return false;
  const double was = 1.0 - f.kept, is = 1.0 - kept, soft = kept / is;
  f.softness = soft * was * f.inverse.inverse();
  f.inverse *= is / was;
  if (f.twist_mass > 0.0) {
    f.twist_softness = soft * was / f.twist_mass;
    f.twist_mass *= is / was;
  }
  f.kept = kept;
  f.releases = 0;
  return true;
}

template <Other other>
void add_friction(const Island& s, std::uint32_t index) {
  World& world = s.world;
  const Touch& touch = s.touches[index];
  const SolvedTouch& solved = s.solved[index];
  const double kept = touch.sliding.kept;
  const Foot foot = foot_of({s.normals.data() + solved.first_row, solved.rows},
                            s.points + touch.first_point, spreads_across(world.parameters));
  FrictionRows& f = s.rows.friction.emplace_back();
  f.touch = index;
  f.n = foot.n;
  f.t[0] = tangent(f.n);
  f.t[1] = f.n.cross(f.t[0]);
  const double arm =
      world.bodies[touch.a].material.rolling_arm + world.bodies[touch.b].material.rolling_arm;
  f.axis = Vec3::Zero();
  const Rolling rolling = arm > 0.0 ? rolling_of(world, touch, f.n, f.axis) : Rolling::freely;
  f.rolls_any = rolling == Rolling::about_any;
  f.roll_arm = rolling == Rolling::freely ? 0.0 : arm;
  f.reach = foot.spread + arm;  // rolling resistance also resists twist, even on one point

  const Arms arms = arms_of<other>(world, s.flight, touch);
  Yield yield;
  for (std::size_t i = 0; i < 2; ++i) f.a.r_t[i] = (foot.p_W - arms.p_WA).cross(f.t[i]);
  add_side(f, f.a, s.bodies.mobility[touch.a], yield);
  if constexpr (other != Other::still) {
    for (std::size_t i = 0; i < 2; ++i) f.b.r_t[i] = (foot.p_W - arms.p_WB).cross(f.t[i]);
  }
  if constexpr (other == Other::moving) add_side(f, f.b, s.bodies.mobility[touch.b], yield);

  // Let u be the slip after the step without friction. A part `kept` of it must remain:
  // F = -(1 - kept) K^-1 u. With u' = u + K F, this is u' + softness F = 0.
  const double soft = kept < 1.0 ? kept / (1.0 - kept) : 0.0;
  const Eigen::Matrix2d& K = yield.slip;
  f.kept = kept;
  f.softness = soft * K;
  f.inverse << K(1, 1), -K(0, 1), -K(1, 0), K(0, 0);
  f.inverse *= (1.0 - kept) / (K(0, 0) * K(1, 1) - K(0, 1) * K(1, 0));
  f.twist_softness = soft * yield.twist;
  f.twist_mass = f.reach > 0.0 ? (1.0 - kept) / yield.twist : 0.0;
  f.roll_mass = f.roll_arm > 0.0 ? 1.0 / yield.roll : 0.0;

  f.impulse = Vec2(solved.friction_W.dot(f.t[0]), solved.friction_W.dot(f.t[1]));
  f.twist = f.twist_mass > 0.0 ? solved.twist : 0.0;
  f.roll = f.roll_arm > 0.0 ? rolling_part(f, solved.roll) : Vec3::Zero();
  f.yields = 0.5 * K.trace();
  push_along<other>(s.bodies, touch, f, f.impulse);
  twist_by<other>(s.bodies, touch, f, f.twist);
  if (f.roll_arm > 0.0) roll_by<other>(s.bodies, touch, f.roll);
}

}  // namespace headpin::engine::detail
