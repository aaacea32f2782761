#pragma once

#include <limits>

#include "engine/acceleration.h"
#include "engine/rules.h"

/// Passes over the rows of an island. Private to the engine.
namespace headpin::engine::detail {

/// Friction that lost its load this many times within a step is left out. Where a pair is about to
/// separate, its friction could switch on and off without end.
inline constexpr int kReleases = 4;

/// A load that changes velocities by no more than this is rounding [m/s].
inline constexpr double kRoundedLoad = 1e-9;

/// Most islands are solved after this many passes. For the others, further passes are accelerated.
inline constexpr int kPlainPasses = 8;

/// Passes converge slowly where this many do not halve the largest change.
inline constexpr int kSlow = 8;

/// Accelerated passes diverge if one changes velocities by more than this many times the least
/// change so far. This happens where masses differ a thousandfold. The passes after that are plain.
inline constexpr double kAstray = 100.0;

template <Other other>
double approach_of(const NormalRow& row, const State& sa, const State& sb) {
  const double approach = row.n.dot(sa.v_WB) + row.ra_n.dot(sa.w_WB);
  if constexpr (other == Other::still) return approach;
  return approach - (row.n.dot(sb.v_WB) + row.rb_n.dot(sb.w_WB));
}

/// Solves all rows of a touch at once, if no impulse becomes negative. @return whether it did
template <Other other, int n>
bool solve_as_block(const Island& s, const Touch& touch, const SolvedTouch& solved, double& worst) {
  if (solved.block == kNone) return false;
  const State &sa = s.bodies.states[touch.a], &sb = s.bodies.states[touch.b];
  NormalRow* const rows = s.normals.data() + solved.first_row;
  Eigen::Matrix<double, n, 1> excess, more;
  for (int k = 0; k < n; ++k) {
    excess[k] = approach_of<other>(rows[k], sa, sb) - rows[k].allowed;
  }
  more.noalias() = s.rows.blocks[solved.block].topLeftCorner<n, n>() * excess;
  for (int k = 0; k < n; ++k) {
    if (rows[k].impulse + more[k] < 0.0) return false;
  }
  for (int k = 0; k < n; ++k) {
    rows[k].impulse += more[k];
    push_by<other>(s.bodies, touch, rows[k], more[k]);
    worst = std::max(worst, std::abs(excess[k]));
  }
  return true;
}

/// One pass over the normal rows of a touch. @return largest change of a velocity [m/s]
template <Other other>
double solve_normals(const Island& s, const Touch& touch, const SolvedTouch& solved) {
  const State &sa = s.bodies.states[touch.a], &sb = s.bodies.states[touch.b];
  NormalRow* const rows = s.normals.data() + solved.first_row;
  double worst = 0.0;
  if (with_rows(solved, [&]<int n> { return solve_as_block<other, n>(s, touch, solved, worst); })) {
    return worst;
  }
  for (std::uint32_t k = 0; k < solved.rows; ++k) {
    NormalRow& row = rows[k];
    const double excess = approach_of<other>(row, sa, sb) - row.allowed;
    const double impulse = std::max(0.0, row.impulse + row.mass * excess);
    const double more = impulse - row.impulse;
    if (more == 0.0) continue;
    row.impulse = impulse;
    push_by<other>(s.bodies, touch, row, more);
    worst = std::max(worst, std::abs(more) / row.mass);
  }
  return worst;
}

inline double load_of(const Island& s, const SolvedTouch& touch) {
  double load = 0.0;
  for (std::uint32_t k = 0; k < touch.rows; ++k) load += s.normals[touch.first_row + k].impulse;
  return load;
}

/// Whether a load is more than rounding.
inline bool is_loaded(const Island& s, const FrictionRows& f, double load) {
  const double least = rounds_loads(s.world.parameters) ? kRoundedLoad / f.yields : 0.0;
  return load > least;
}

/// The impulse of at most this size that takes most energy: friction is then opposite to the slip
/// that remains.
///
/// @param free  the impulse that leaves no slip, larger than `most`
inline Vec2 friction_at_limit(const Eigen::Matrix2d& inverse, const Vec2& free, double most) {
  const Eigen::Matrix2d A = inverse.inverse();
  const Vec2 g = A * free;
  double more = 0.0;  // (A + more) F = A free, where |F| = most
  Vec2 F = free;
  for (int round = 0; round < 8; ++round) {
    const double p = A(0, 0) + more, q = A(1, 1) + more, off = A(0, 1);
    const double det = p * q - off * off;
    F = Vec2(q * g[0] - off * g[1], p * g[1] - off * g[0]) / det;
    const double size = F.norm();
    if (size <= most * (1.0 + 1e-12)) break;
    const double falls = (q * F[0] * F[0] - 2.0 * off * F[0] * F[1] + p * F[1] * F[1]) / det;
    more += size * size * (size - most) / (most * falls);  // Newton's method for 1 / size
  }
  return most / F.norm() * F;
}

/// Slip along the two tangents [m/s].
template <Other other>
Vec2 slip_of(const FrictionRows& f, const State& sa, const State& sb) {
  Vec2 slip;
  for (int i = 0; i < 2; ++i) {
    const auto u = static_cast<std::size_t>(i);
    slip[i] = f.t[u].dot(sa.v_WB) + f.a.r_t[u].dot(sa.w_WB);
    if constexpr (other != Other::still) {
      slip[i] -= f.t[u].dot(sb.v_WB) + f.b.r_t[u].dot(sb.w_WB);
    }
  }
  return slip;
}

/// @return largest change of a velocity [m/s]; twist and rolling change it at their arms
template <Other other>
double solve_friction(const Island& s, const Touch& touch, FrictionRows& f, double load) {
  const State &sa = s.bodies.states[touch.a], &sb = s.bodies.states[touch.b];
  const bool carries = is_loaded(s, f, load) && f.releases < kReleases;
  if (f.carries && !carries) ++f.releases;
  f.carries = carries;
  // One after the other, because slip, twist and rolling of one contact affect each other.
  const double most = touch.sliding.limit * load;
  Vec2 F = Vec2::Zero();
  if (carries) {
    const Vec2 slip = slip_of<other>(f, sa, sb);
    F = f.impulse - f.inverse * (slip + f.softness * f.impulse);
    if (const double size = F.norm(); size > most) {
      F = opposes_slip(s.world.parameters) ? friction_at_limit(f.inverse, F, most)
                                           : Vec2(most / size * F);
    }
  }
  const Vec2 more = F - f.impulse;
  f.impulse = F;
  push_along<other>(s.bodies, touch, f, more);
  double worst = more.norm() * s.bodies.mobility[touch.a].inv_mass;
  const bool counts = counts_turning(s.world.parameters);
  const auto spin = [&] { return other == Other::still ? sa.w_WB : Vec3(sa.w_WB - sb.w_WB); };
  if (f.twist_mass > 0.0) {
    double twist = 0.0;
    if (carries) {
      twist = f.twist - f.twist_mass * (f.n.dot(spin()) + f.twist_softness * f.twist);
      twist = std::clamp(twist, -most * f.reach, most * f.reach);
    }
    if (counts) {
      double yields = f.n.dot(f.a.twist_i);
      if constexpr (other == Other::moving) yields += f.n.dot(f.b.twist_i);
      worst = std::max(worst, std::abs(twist - f.twist) * yields * f.reach);
    }
    twist_by<other>(s.bodies, touch, f, twist - f.twist);
    f.twist = twist;
  }
  if (f.roll_arm > 0.0) {
    Vec3 roll = Vec3::Zero();
    if (carries) {
      const double most_roll = f.roll_arm * load;
      roll = f.roll - f.roll_mass * rolling_part(f, spin());
      if (const double much = roll.norm(); much > most_roll) roll *= most_roll / much;
    }
    if (counts) worst = std::max(worst, (roll - f.roll).norm() / f.roll_mass * f.roll_arm);
    roll_by<other>(s.bodies, touch, roll - f.roll);
    f.roll = roll;
  }
  return worst;
}

template <Other other>
double solve(const Island& s, const Touch& touch, const SolvedTouch& solved,
             FrictionRows* friction) {
  const double worst = solve_normals<other>(s, touch, solved);
  if (!friction) return worst;
  const double load = friction->held ? friction->load : load_of(s, solved);
  return std::max(worst, solve_friction<other>(s, touch, *friction, load));
}

/// Number of passes over an island, and the largest change of a velocity in the last pass [m/s].
struct Passes {
  int count = 0;
  double worst = 0.0;
  bool solved = false;
};

/// How passes are made, and when they end.
struct PassPlan {
  int most = 0;              ///< passes
  double enough = 0.0;       ///< solved when no velocity changes by more in a pass [m/s]
  int plain = kPlainPasses;  ///< the first of them, which are not accelerated
  bool gives_up = false;     ///< ends where they converge slowly
};

inline Passes pass_over(const Island& s, const PassPlan& plan) {
  Passes done;
  double best = std::numeric_limits<double>::infinity(), earlier = best;
  bool plain = plan.plain >= plan.most;
  Acceleration faster(s);
  do {
    done.worst = 0.0;
    if (done.count >= plan.plain && !plain) faster.before_pass();
    FrictionRows* friction = s.rows.friction.data();
    FrictionRows* const end = friction + s.rows.friction.size();
    for (const std::uint32_t k : s.each) {
      const SolvedTouch& solved = s.solved[k];
      if (solved.rows == 0) continue;
      const Touch& touch = s.touches[k];
      FrictionRows* const mine = friction != end && friction->touch == k ? friction++ : nullptr;
      done.worst = std::max(done.worst, with_other(touch, [&]<Other other> {
                              return solve<other>(s, touch, solved, mine);
                            }));
    }
    ++done.count;
    done.solved = done.worst <= plan.enough;
    if (done.solved || done.count >= plan.most) return done;
    if (plan.gives_up && done.count % kSlow == 0) {
      if (done.worst > 0.5 * earlier) return done;
      earlier = done.worst;
    }
    best = std::min(best, done.worst);
    plain = plain || done.worst > kAstray * best;
    if (done.count > plan.plain && !plain) faster.after_pass();
  } while (true);
}

}  // namespace headpin::engine::detail
