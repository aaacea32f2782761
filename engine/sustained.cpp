#include <algorithm>

#include "engine/inlining.h"
#include "engine/stages.h"

namespace headpin::engine::detail {
namespace {

/// Friction that lost its load so often within a step is left out of it: where a pair is just about
/// to part, its friction would come and go for ever.
constexpr int kReleases = 4;

/// Most islands are done after so many passes; the others are sped up.
constexpr int kPlainPasses = 8;

/// A body whose axis is nearer to the normal than this stands; it has no rolling resistance.
constexpr double kStanding = 0.9;

/// Determinant of a touch's rows, over the product of its diagonal, below which they depend on each
/// other: the inverse would be noise. Four points of one plane have 1e-9 times what their spread is.
constexpr double kDependent = 1e-12;

constexpr std::uint32_t kNone = ~std::uint32_t{0};

/// What B is to a touch: what has no velocity is left out of every sum.
enum class Other { still, driven, moving };

Other other_of(const World& world, const Touch& touch) {
  if (touch.b_moves) return Other::moving;
  return world.bodies[touch.b].kind == Kind::driven ? Other::driven : Other::still;
}

void push(State& state, const Mobility& m, const Vec3& F, const Vec3& inv_inertia_torque) {
  state.v_WB += m.inv_mass * F;
  state.w_WB += inv_inertia_torque;
}

// Where the touch's bodies were when its points were found.
struct Arms {
  Vec3 p_WA, p_WB;
};

Arms arms_of(const World& world, const Touch& touch) {
  return {position_at(world, touch.a, touch.time), position_at(world, touch.b, touch.time)};
}

double last_impulse(const Scratch& s, const Touch& touch, std::uint32_t feature) {
  if (touch.fresh) return 0.0;
  const Touch& last = s.last_touches[touch.last];
  for (std::uint32_t k = 0; k < last.rows; ++k) {
    const NormalRow& row = s.last_rows[last.first_row + k];
    if (row.feature == feature) return row.impulse;
  }
  return 0.0;
}

template <Other other>
void push_by(World& world, const Touch& touch, const NormalRow& row, double impulse) {
  const Scratch& s = world.scratch;
  push(world.states[touch.a], s.mobility[touch.a], -impulse * row.n, -impulse * row.ia);
  if constexpr (other == Other::moving) {
    push(world.states[touch.b], s.mobility[touch.b], impulse * row.n, impulse * row.ib);
  }
}

template <Other other>
void add_normal_rows(World& world, Touch& touch) {
  Scratch& s = world.scratch;
  const Mobility &ma = s.mobility[touch.a], &mb = s.mobility[touch.b];
  const Arms arms = arms_of(world, touch);
  const double left = std::max(step_seconds(world) - touch.time, 1e-9 * step_seconds(world));
  touch.first_row = static_cast<std::uint32_t>(s.rows.size());
  touch.rows = touch.points;
  for (std::uint32_t k = 0; k < touch.points; ++k) {
    const ContactPoint& p = s.points[touch.first_point + k];
    NormalRow& row = s.rows.emplace_back();
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
    row.impulse = last_impulse(s, touch, p.feature);
    if (row.impulse > 0.0) push_by<other>(world, touch, row, row.impulse);
  }
}

/// Calls f.template operator()<n>() for the 2 to 4 rows of a touch that are solved as one.
/// @return false for other numbers
template <typename F>
bool with_rows(const Touch& touch, F&& f) {
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

/// The rows of a touch solved as one: a base stands without any iteration. Rows that say almost the
/// same, of points on one spot or line, have no such solution and go one by one.
template <Other other, int n>
void add_block(Scratch& s, Touch& touch) {
  const NormalRow* const rows = s.rows.data() + touch.first_row;
  double inv_mass = s.mobility[touch.a].inv_mass;
  if constexpr (other == Other::moving) inv_mass += s.mobility[touch.b].inv_mass;
  Eigen::Matrix<double, n, n> K;
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k <= i; ++k) {
      double value = inv_mass * rows[i].n.dot(rows[k].n) + rows[i].ra_n.dot(rows[k].ia);
      if constexpr (other == Other::moving) value += rows[i].rb_n.dot(rows[k].ib);
      K(i, k) = K(k, i) = value;
    }
    // Four points of one plane carry each other; this picks one of the ways to share the load.
    K(i, i) *= 1.0 + 1e-9;
  }
  Eigen::Matrix<double, n, n> inverse;
  double determinant = 0.0;
  bool independent = false;
  K.computeInverseAndDetWithCheck(inverse, determinant, independent,
                                  kDependent * K.diagonal().prod());
  touch.block = kNone;
  if (!independent) return;
  touch.block = static_cast<std::uint32_t>(s.blocks.size());
  s.blocks.emplace_back().topLeftCorner<n, n>() = inverse;
}

/// Foot and normal of the friction of a touch: its points, weighted by what they carry.
struct Foot {
  Vec3 p_W = Vec3::Zero(), n = Vec3::Zero();
  double spread = 0.0;  // of the points about the foot, root of the mean square [m]
};

Foot foot_of(const Scratch& s, const Touch& touch) {
  const NormalRow* const rows = s.rows.data() + touch.first_row;
  const ContactPoint* const points = s.points.data() + touch.first_point;
  if (touch.rows == 1) return {points[0].p_W, rows[0].n, 0.0};
  double load = 0.0, deepest = points[0].depth;
  for (std::uint32_t k = 0; k < touch.rows; ++k) {
    load += rows[k].impulse;
    deepest = std::max(deepest, points[k].depth);
  }
  // Nothing carried yet: those that touch first.
  const auto weight = [&](std::uint32_t k) {
    return load > 0.0 ? rows[k].impulse : (points[k].depth > deepest - 1e-4 ? 1.0 : 0.0);
  };
  Foot foot;
  const Vec3 from = points[0].p_W;
  double sum = 0.0, squares = 0.0;
  bool one_plane = true;
  for (std::uint32_t k = 0; k < touch.rows; ++k) {
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
  // Surfaces on both sides of a body share their tangents: their normals count as one.
  std::uint32_t most = 0;
  for (std::uint32_t k = 1; k < touch.rows; ++k) most = weight(k) > weight(most) ? k : most;
  const Vec3 side = rows[most].n;
  foot.n = Vec3::Zero();
  for (std::uint32_t k = 0; k < touch.rows; ++k) {
    foot.n += std::copysign(weight(k), rows[k].n.dot(side)) * rows[k].n;
  }
  foot.n.normalize();
  return foot;
}

Vec3 tangent(const Vec3& n) {
  const Vec3 t = std::abs(n.x()) < 0.7 ? Vec3(0.0, n.z(), -n.y()) : Vec3(-n.z(), 0.0, n.x());
  return t / std::sqrt(t.squaredNorm());
}

/// How the bodies of a touch are kept from rolling.
enum class Rolling { freely, about_axis, about_any };

/// A lying body rolls heavily about its axis across the normal, a ball about any; one that stands
/// does not roll.
Rolling rolling_of(const World& world, const Touch& touch, const Vec3& n, Vec3& axis_W) {
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
Vec3 rolling_part(const FrictionRows& f, const Vec3& w) {
  return f.rolls_any ? Vec3(w - f.n.dot(w) * f.n) : Vec3(f.axis.dot(w) * f.axis);
}

/// What a body gives way to unit impulses of the friction rows, summed over the bodies that move.
struct Yield {
  Eigen::Matrix2d slip = Eigen::Matrix2d::Zero();
  double twist = 0.0, roll = 0.0;
};

void add_side(const FrictionRows& f, FrictionSide& side, const Mobility& m, Yield& yield) {
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

/// Impulses of a pair's friction: along the tangents, and turning about any axis.
template <Other other>
void push_along(World& world, const Touch& touch, const FrictionRows& f, const Vec2& slip) {
  const Scratch& s = world.scratch;
  const Vec3 F = slip[0] * f.t[0] + slip[1] * f.t[1];
  push(world.states[touch.a], s.mobility[touch.a], F, slip[0] * f.a.i[0] + slip[1] * f.a.i[1]);
  if constexpr (other == Other::moving) {
    push(world.states[touch.b], s.mobility[touch.b], -F, -slip[0] * f.b.i[0] - slip[1] * f.b.i[1]);
  }
}

template <Other other>
void twist_by(World& world, const Touch& touch, const FrictionRows& f, double twist) {
  world.states[touch.a].w_WB += twist * f.a.twist_i;
  if constexpr (other == Other::moving) world.states[touch.b].w_WB -= twist * f.b.twist_i;
}

template <Other other>
void roll_by(World& world, const Touch& touch, const Vec3& roll) {
  const Scratch& s = world.scratch;
  world.states[touch.a].w_WB += s.mobility[touch.a].inv_inertia_W * roll;
  if constexpr (other == Other::moving) {
    world.states[touch.b].w_WB -= s.mobility[touch.b].inv_inertia_W * roll;
  }
}

template <Other other>
void add_friction(World& world, Touch& touch, std::uint32_t index) {
  Scratch& s = world.scratch;
  const double kept = touch.sliding.kept;
  const Foot foot = foot_of(s, touch);
  FrictionRows& f = s.friction.emplace_back();
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
  f.reach = foot.spread + arm;  // what rolls heavily pivots heavily, even on one point

  const Arms arms = arms_of(world, touch);
  Yield yield;
  for (std::size_t i = 0; i < 2; ++i) f.a.r_t[i] = (foot.p_W - arms.p_WA).cross(f.t[i]);
  add_side(f, f.a, s.mobility[touch.a], yield);
  if constexpr (other != Other::still) {
    for (std::size_t i = 0; i < 2; ++i) f.b.r_t[i] = (foot.p_W - arms.p_WB).cross(f.t[i]);
  }
  if constexpr (other == Other::moving) add_side(f, f.b, s.mobility[touch.b], yield);

  // After the step a part `kept` of the slip u that there would be without friction shall be left:
  // F = -(1 - kept) K^-1 u. With u' = u + K F that is u' + softness F = 0.
  const double soft = kept < 1.0 ? kept / (1.0 - kept) : 0.0;
  const Eigen::Matrix2d& K = yield.slip;
  f.softness = soft * K;
  f.inverse << K(1, 1), -K(0, 1), -K(1, 0), K(0, 0);
  f.inverse *= (1.0 - kept) / (K(0, 0) * K(1, 1) - K(0, 1) * K(1, 0));
  f.twist_softness = soft * yield.twist;
  f.twist_mass = f.reach > 0.0 ? (1.0 - kept) / yield.twist : 0.0;
  f.roll_mass = f.roll_arm > 0.0 ? 1.0 / yield.roll : 0.0;

  f.impulse = Vec2(touch.friction_W.dot(f.t[0]), touch.friction_W.dot(f.t[1]));
  f.twist = f.twist_mass > 0.0 ? touch.twist : 0.0;
  f.roll = f.roll_arm > 0.0 ? rolling_part(f, touch.roll) : Vec3::Zero();
  f.yields = 0.5 * K.trace();
  push_along<other>(world, touch, f, f.impulse);
  twist_by<other>(world, touch, f, f.twist);
  if (f.roll_arm > 0.0) roll_by<other>(world, touch, f.roll);
}

template <Other other>
double approach_of(const NormalRow& row, const State& sa, const State& sb) {
  const double approach = row.n.dot(sa.v_WB) + row.ra_n.dot(sa.w_WB);
  if constexpr (other == Other::still) return approach;
  return approach - (row.n.dot(sb.v_WB) + row.rb_n.dot(sb.w_WB));
}

/// All rows of a touch at once, if they all press. @return whether they do
template <Other other, int n>
bool solve_as_block(World& world, const Touch& touch, double& worst) {
  Scratch& s = world.scratch;
  if (touch.block == kNone) return false;
  const State &sa = world.states[touch.a], &sb = world.states[touch.b];
  NormalRow* const rows = s.rows.data() + touch.first_row;
  Eigen::Matrix<double, n, 1> excess, more;
  for (int k = 0; k < n; ++k) {
    excess[k] = approach_of<other>(rows[k], sa, sb) - rows[k].allowed;
  }
  more.noalias() = s.blocks[touch.block].topLeftCorner<n, n>() * excess;
  for (int k = 0; k < n; ++k) {
    if (rows[k].impulse + more[k] < 0.0) return false;
  }
  for (int k = 0; k < n; ++k) {
    rows[k].impulse += more[k];
    push_by<other>(world, touch, rows[k], more[k]);
    worst = std::max(worst, std::abs(excess[k]));
  }
  return true;
}

/// One pass over the normal rows of a touch. @return largest change of a velocity [m/s]
template <Other other>
double solve_normals(World& world, const Touch& touch) {
  const State &sa = world.states[touch.a], &sb = world.states[touch.b];
  NormalRow* const rows = world.scratch.rows.data() + touch.first_row;
  double worst = 0.0;
  if (with_rows(touch, [&]<int n> { return solve_as_block<other, n>(world, touch, worst); })) {
    return worst;
  }
  for (std::uint32_t k = 0; k < touch.rows; ++k) {
    NormalRow& row = rows[k];
    const double excess = approach_of<other>(row, sa, sb) - row.allowed;
    const double impulse = std::max(0.0, row.impulse + row.mass * excess);
    const double more = impulse - row.impulse;
    if (more == 0.0) continue;
    row.impulse = impulse;
    push_by<other>(world, touch, row, more);
    worst = std::max(worst, std::abs(more) / row.mass);
  }
  return worst;
}

double load_of(const Scratch& s, const Touch& touch) {
  double load = 0.0;
  for (std::uint32_t k = 0; k < touch.rows; ++k) load += s.rows[touch.first_row + k].impulse;
  return load;
}

template <Other other>
double solve_friction(World& world, const Touch& touch, FrictionRows& f, double load) {
  const State &sa = world.states[touch.a], &sb = world.states[touch.b];
  const bool carries = load > 0.0 && f.releases < kReleases;
  if (f.carries && !carries) ++f.releases;
  f.carries = carries;
  // One after the other: slip, twist and rolling of one contact work on each other.
  const double most = touch.sliding.limit * load;
  Vec2 F = Vec2::Zero();
  if (carries) {
    Vec2 slip;
    for (int i = 0; i < 2; ++i) {
      const auto u = static_cast<std::size_t>(i);
      slip[i] = f.t[u].dot(sa.v_WB) + f.a.r_t[u].dot(sa.w_WB);
      if constexpr (other != Other::still) {
        slip[i] -= f.t[u].dot(sb.v_WB) + f.b.r_t[u].dot(sb.w_WB);
      }
    }
    F = f.impulse - f.inverse * (slip + f.softness * f.impulse);
    const double size = F.norm();
    if (size > most) F *= most / size;
  }
  const Vec2 more = F - f.impulse;
  f.impulse = F;
  push_along<other>(world, touch, f, more);
  const auto spin = [&] { return other == Other::still ? sa.w_WB : Vec3(sa.w_WB - sb.w_WB); };
  if (f.twist_mass > 0.0) {
    double twist = 0.0;
    if (carries) {
      twist = f.twist - f.twist_mass * (f.n.dot(spin()) + f.twist_softness * f.twist);
      twist = std::clamp(twist, -most * f.reach, most * f.reach);
    }
    twist_by<other>(world, touch, f, twist - f.twist);
    f.twist = twist;
  }
  if (f.roll_arm > 0.0) {
    Vec3 roll = Vec3::Zero();
    if (carries) {
      const double most_roll = f.roll_arm * load;
      roll = f.roll - f.roll_mass * rolling_part(f, spin());
      if (const double much = roll.norm(); much > most_roll) roll *= most_roll / much;
    }
    roll_by<other>(world, touch, roll - f.roll);
    f.roll = roll;
  }
  return more.norm() * world.scratch.mobility[touch.a].inv_mass;
}

template <Other other>
double solve(World& world, const Touch& touch, FrictionRows* friction) {
  const double worst = solve_normals<other>(world, touch);
  if (!friction) return worst;
  const double load = load_of(world.scratch, touch);
  return std::max(worst, solve_friction<other>(world, touch, *friction, load));
}

/// Calls f.template operator()<other>() with what B of the touch is.
template <typename F>
decltype(auto) with_other(const World& world, const Touch& touch, F&& f) {
  switch (other_of(world, touch)) {
    case Other::still:
      return f.template operator()<Other::still>();
    case Other::driven:
      return f.template operator()<Other::driven>();
    default:
      return f.template operator()<Other::moving>();
  }
}

/// Conjugate gradients over the passes of an island, each pass a gradient (Silcowitz-Hansen,
/// Niebe and Erleben 2010): what plain passes carry up a stack by one body each goes as a whole.
class Acceleration {
 public:
  Acceleration(World& world, std::span<const std::uint32_t> touches)
      : world_(world), s_(world.scratch), touches_(touches) {}

  void before_pass() {
    s_.before.clear();
    each([&](double& impulse, double, auto&&) { s_.before.push_back(impulse); });
    if (s_.along.size() < s_.before.size()) s_.along.resize(s_.before.size());
  }

  void after_pass() {
    double now = 0.0;
    std::size_t n = 0;
    each([&](double& impulse, double yields, auto&&) {
      const double more = impulse - s_.before[n++];
      now += more * more * yields;
    });
    const double keep = last_ > 0.0 && now < last_ ? now / last_ : 0.0;
    last_ = now;
    n = 0;
    each([&](double& impulse, double, auto&& push) {
      const double more = keep > 0.0 ? keep * s_.along[n] : 0.0;
      s_.along[n] = more + impulse - s_.before[n];
      ++n;
      if (more != 0.0) push(more);
    });
  }

 private:
  /// Calls f(impulse, velocity by a unit of it, how to add to it) for all of the island.
  template <typename F>
  void each(F&& f) {
    std::size_t at = 0;
    for (const std::uint32_t k : touches_) {
      const Touch& touch = s_.touches[k];
      if (touch.rows == 0) continue;
      for (std::uint32_t n = 0; n < touch.rows; ++n) {
        NormalRow& row = s_.rows[touch.first_row + n];
        f(row.impulse, 1.0 / row.mass, [&](double more) {
          more = std::max(more, -row.impulse);
          row.impulse += more;
          with_other(world_, touch, [&]<Other other> { push_by<other>(world_, touch, row, more); });
        });
      }
      if (at == s_.friction.size() || s_.friction[at].touch != k) continue;
      FrictionRows& rows = s_.friction[at++];
      for (int n = 0; n < 2; ++n) {
        f(rows.impulse[n], rows.yields, [&](double more) {
          rows.impulse[n] += more;
          with_other(world_, touch, [&]<Other other> {
            push_along<other>(world_, touch, rows, more * Vec2::Unit(n));
          });
        });
      }
      if (rows.twist_mass > 0.0) {
        f(rows.twist, 1.0 / rows.twist_mass, [&](double more) {
          rows.twist += more;
          with_other(world_, touch,
                     [&]<Other other> { twist_by<other>(world_, touch, rows, more); });
        });
      }
      if (rows.roll_arm == 0.0) continue;
      for (int n = 0; n < 3; ++n) {
        f(rows.roll[n], 1.0 / rows.roll_mass, [&](double more) {
          rows.roll[n] += more;
          with_other(world_, touch,
                     [&]<Other other> { roll_by<other>(world_, touch, more * Vec3::Unit(n)); });
        });
      }
    }
  }

  World& world_;
  Scratch& s_;
  std::span<const std::uint32_t> touches_;
  double last_ = 0.0;
};

/// Islands: movers joined by touches. Touches sorted by island, their own order kept.
void find_islands(World& world) {
  Scratch& s = world.scratch;
  for (const BodyId i : s.movers) {
    s.parent[i] = i;
    s.island_number[i] = kNone;
  }
  for (const Touch& touch : s.touches) {
    if (!touch.b_moves) continue;
    const BodyId a = island_root(s.parent, touch.a), b = island_root(s.parent, touch.b);
    s.parent[std::max(a, b)] = std::min(a, b);
  }
  // Number the islands by their first touch, count, and deal the touches out.
  s.island_start.clear();
  s.island_of.resize(s.touches.size());
  for (std::size_t k = 0; k < s.touches.size(); ++k) {
    std::uint32_t& n = s.island_number[island_root(s.parent, s.touches[k].a)];
    if (n == kNone) {
      n = static_cast<std::uint32_t>(s.island_start.size());
      s.island_start.push_back(0);
    }
    s.island_of[k] = n;
    ++s.island_start[n];
  }
  std::uint32_t sum = 0;
  for (std::uint32_t& start : s.island_start) {
    const std::uint32_t count = start;
    start = sum;
    sum += count;
  }
  s.order.resize(s.touches.size());
  for (std::size_t k = 0; k < s.touches.size(); ++k) {
    s.order[s.island_start[s.island_of[k]]++] = static_cast<std::uint32_t>(k);
  }
  // Each start is now the end of its island.
}

/// Work and push of driven bodies within the island's contacts.
void book_driven(World& world, std::span<const std::uint32_t> touches) {
  const Scratch& s = world.scratch;
  const auto book = [&](const Touch& touch, const Vec3& F, const Vec3& torque) {
    if (world.bodies[touch.b].kind != Kind::driven) return;
    const State& driven = world.states[touch.b];
    world.pushed.energy += F.dot(driven.v_WB) + torque.dot(driven.w_WB);
    world.pushed.momentum += F;
    world.pushed.angular_momentum += arms_of(world, touch).p_WB.cross(F) + torque;
  };
  for (const std::uint32_t k : touches) {
    const Touch& touch = s.touches[k];
    for (std::uint32_t n = 0; n < touch.rows; ++n) {
      const NormalRow& row = s.rows[touch.first_row + n];
      book(touch, -row.impulse * row.n, -row.impulse * row.rb_n);
    }
  }
  for (const FrictionRows& f : s.friction) {
    book(s.touches[f.touch], f.impulse[0] * f.t[0] + f.impulse[1] * f.t[1],
         f.impulse[0] * f.b.r_t[0] + f.impulse[1] * f.b.r_t[1] + f.twist * f.n + f.roll);
  }
}

HEADPIN_FLATTEN void solve_island(World& world, std::span<const std::uint32_t> touches) {
  Scratch& s = world.scratch;
  const Parameters& p = world.parameters;
  s.blocks.clear();
  s.friction.clear();
  for (const std::uint32_t k : touches) {
    Touch& touch = s.touches[k];
    if (touch.points == 0) continue;
    with_other(world, touch, [&]<Other other> {
      add_normal_rows<other>(world, touch);
      with_rows(touch, [&]<int n> {
        add_block<other, n>(s, touch);
        return true;
      });
    });
  }
  for (const std::uint32_t k : touches) {
    Touch& touch = s.touches[k];
    if (!touch.fresh) {
      const Touch& last = s.last_touches[touch.last];
      touch.friction_W = last.friction_W;
      touch.twist = last.twist;
      touch.roll = last.roll;
    }
    if (touch.rows == 0 || touch.sliding.kept == 1.0) continue;
    with_other(world, touch, [&]<Other other> { add_friction<other>(world, touch, k); });
  }
  int pass = 0;
  double worst = 0.0;
  Acceleration faster(world, touches);
  do {
    worst = 0.0;
    if (pass >= kPlainPasses) faster.before_pass();
    FrictionRows* friction = s.friction.data();
    FrictionRows* const end = s.friction.data() + s.friction.size();
    for (const std::uint32_t k : touches) {
      const Touch& touch = s.touches[k];
      if (touch.rows == 0) continue;
      FrictionRows* const mine = friction != end && friction->touch == k ? friction++ : nullptr;
      worst = std::max(worst, with_other(world, touch, [&]<Other other> {
                         return solve<other>(world, touch, mine);
                       }));
    }
    ++pass;
    if (worst <= p.solver_residual || pass >= p.solver_iterations) break;
    if (pass > kPlainPasses) faster.after_pass();
  } while (true);
  for (const FrictionRows& f : s.friction) {
    Touch& touch = s.touches[f.touch];
    touch.friction_W = f.impulse[0] * f.t[0] + f.impulse[1] * f.t[1];
    touch.twist = f.twist;
    touch.roll = f.roll;
  }
  if (p.keep_ledger && !s.driven.empty()) book_driven(world, touches);
  ++world.statistics.islands;
  world.statistics.solver_iterations += pass;
  world.statistics.unsolved += worst > p.solver_residual ? 1 : 0;
  world.statistics.residual = std::max(world.statistics.residual, worst);
}

/// Notes what part of each body's weight its contacts carry, and who need not fall in the next step:
/// what is carried by half at least and does not rise.
void note_carried(World& world) {
  Scratch& s = world.scratch;
  const Vec3& g = world.parameters.gravity_W;
  for (const BodyId i : s.movers) s.carried[i] = 0.0;
  for (const Touch& touch : s.touches) {
    if (touch.rows == 0) continue;
    Vec3 F = touch.friction_W;
    for (std::uint32_t k = 0; k < touch.rows; ++k) {
      const NormalRow& row = s.rows[touch.first_row + k];
      F -= row.impulse * row.n;
    }
    const double lift = -F.dot(g);
    s.carried[touch.a] += lift;
    if (touch.b_moves) s.carried[touch.b] -= lift;
  }
  const double fall = g.squaredNorm() * step_seconds(world);
  const double rise = g.norm() * lasting_speed(world);
  for (const BodyId i : s.movers) {
    double& part = s.carried[i];
    part = part > 0.0 ? std::min(1.0, part / (fall * world.bodies[i].mass)) : 0.0;
    s.supported[i] = part >= 0.5 && -world.states[i].v_WB.dot(g) <= rise;
  }
}

/// Notes who has met.
void note_met(World& world) {
  Scratch& s = world.scratch;
  for (Touch& touch : s.touches) {
    if (touch.met) continue;
    const double load = load_of(s, touch);
    if (load <= 0.0) continue;
    touch.met = true;
    std::uint32_t k = 0;  // the row that carries most
    for (std::uint32_t i = 1; i < touch.rows; ++i) {
      if (s.rows[touch.first_row + i].impulse > s.rows[touch.first_row + k].impulse) k = i;
    }
    const Vec3& n = s.rows[touch.first_row + k].n;
    world.events.push_back({touch.a, touch.b, s.points[touch.first_point + k].p_W, n,
                            -load * n + touch.friction_W, 0.0, true});
  }
}

}  // namespace

BodyId island_root(std::vector<BodyId>& parent, BodyId i) {
  while (parent[i] != i) {
    parent[i] = parent[parent[i]];
    i = parent[i];
  }
  return i;
}

void sustain_contacts(World& world) {
  Scratch& s = world.scratch;
  s.rows.clear();
  find_islands(world);
  std::uint32_t start = 0;
  for (const std::uint32_t end : s.island_start) {
    solve_island(world, std::span(s.order).subspan(start, end - start));
    start = end;
  }
  note_carried(world);
  note_met(world);
}

}  // namespace headpin::engine::detail
