#include <algorithm>
#include <limits>

#include "engine/acceleration.h"
#include "engine/inlining.h"

namespace headpin::engine::detail {
namespace {

/// Friction that lost its load so often within a step is left out of it: where a pair is just about
/// to part, its friction would come and go for ever.
constexpr int kReleases = 4;

/// Most islands are done after so many passes; the others are sped up.
constexpr int kPlainPasses = 8;

/// Passes that are sped up and yet change velocities so many times as much as the best have left their
/// way, as they do where masses differ a thousandfold: from there on they go plainly.
constexpr double kAstray = 100.0;

/// Part of a slip that friction leaves in an island that is not solved otherwise, and how many times
/// the usual passes it gets for that.
constexpr double kSoft = 0.01;
constexpr int kSoftPasses = 4;

/// What an unsolved island may gain, in parts of its energy of motion.
constexpr double kGain = 1e-9;

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
  const double load = friction->held ? friction->load : load_of(world.scratch, touch);
  return std::max(worst, solve_friction<other>(world, touch, *friction, load));
}

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
Balance given_by_driven(const World& world, std::span<const std::uint32_t> touches) {
  const Scratch& s = world.scratch;
  Balance given;
  const auto book = [&](const Touch& touch, const Vec3& F, const Vec3& torque) {
    if (world.bodies[touch.b].kind != Kind::driven) return;
    const State& driven = world.states[touch.b];
    given.energy += F.dot(driven.v_WB) + torque.dot(driven.w_WB);
    given.momentum += F;
    given.angular_momentum += arms_of(world, touch).p_WB.cross(F) + torque;
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
  return given;
}

/// How often an island was gone over, and the largest change of a velocity in the last pass [m/s].
struct Passes {
  int count = 0;
  double worst = 0.0;
};

Passes pass_over(World& world, std::span<const std::uint32_t> touches, bool sped_up, int most) {
  Scratch& s = world.scratch;
  const Parameters& p = world.parameters;
  Passes done;
  double best = std::numeric_limits<double>::infinity();
  bool plain = !sped_up;
  Acceleration faster(world, touches);
  do {
    done.worst = 0.0;
    if (done.count >= kPlainPasses && !plain) faster.before_pass();
    FrictionRows* friction = s.friction.data();
    FrictionRows* const end = s.friction.data() + s.friction.size();
    for (const std::uint32_t k : touches) {
      const Touch& touch = s.touches[k];
      if (touch.rows == 0) continue;
      FrictionRows* const mine = friction != end && friction->touch == k ? friction++ : nullptr;
      done.worst = std::max(done.worst, with_other(world, touch, [&]<Other other> {
                              return solve<other>(world, touch, mine);
                            }));
    }
    ++done.count;
    if (done.worst <= p.solver_residual || done.count >= most) return done;
    best = std::min(best, done.worst);
    plain = plain || done.worst > kAstray * best;
    if (done.count > kPlainPasses && !plain) faster.after_pass();
  } while (true);
}

/// Energy of motion of an island's bodies, which are listed once each [J].
double energy_of(const World& world, std::span<const BodyId> bodies) {
  double sum = 0.0;
  for (const BodyId i : bodies) {
    const State& s = world.states[i];
    sum += 0.5 * world.bodies[i].mass * s.v_WB.squaredNorm() +
           turning_energy(world.inertias[i], s.X_WB.q, s.w_WB);
  }
  return sum;
}

/// Passes that do not end may add energy, as they do where friction wedges a light body between
/// heavy ones: a load brings friction, and that more load. Such an island is solved once more, its
/// friction limited by what its normals carry without any. So limited every pass takes energy, or
/// nearly: if it still gains, it is left without friction for the step.
[[gnu::noinline]] void take_back_gain(World& world, std::span<const std::uint32_t> touches,
                                      Passes& done) {
  Scratch& s = world.scratch;
  std::vector<BodyId>& bodies = s.island_bodies;
  bodies.clear();
  for (const std::uint32_t k : touches) {
    bodies.push_back(s.touches[k].a);
    if (s.touches[k].b_moves) bodies.push_back(s.touches[k].b);
  }
  std::sort(bodies.begin(), bodies.end());
  bodies.erase(std::unique(bodies.begin(), bodies.end()), bodies.end());
  s.unsolved.clear();
  for (const BodyId i : bodies) s.unsolved.push_back(world.states[i]);
  s.before.clear();
  each_impulse(world, touches, [&](double& x, double, auto&&) { s.before.push_back(x); });

  const auto own_energy = [&] {
    return energy_of(world, bodies) - given_by_driven(world, touches).energy;
  };
  const auto undo = [&] {
    each_impulse(world, touches, [&](double& x, double, auto&& push) { push(-x); });
  };
  const double after = own_energy();
  undo();
  const double start = own_energy(), most = start + kGain * start;
  if (after <= most) {  // unsolved, but harmless
    for (std::size_t k = 0; k < bodies.size(); ++k) world.states[bodies[k]] = s.unsolved[k];
    std::size_t n = 0;
    each_impulse(world, touches, [&](double& x, double, auto&&) { x = s.before[n++]; });
    return;
  }
  const auto once_more = [&] {
    const Passes more = pass_over(world, touches, false, world.parameters.solver_iterations);
    done = {done.count + more.count, more.worst};
  };
  for (FrictionRows& f : s.friction) f.hold(0.0);
  once_more();
  for (FrictionRows& f : s.friction) f.hold(load_of(s, s.touches[f.touch]));
  once_more();
  if (own_energy() <= most) return;
  undo();
  for (FrictionRows& f : s.friction) f.hold(0.0);
  once_more();
}

/// Goes on where passes did not end, and friction leaves less of a slip than it might.
[[gnu::noinline]] void solve_softly(World& world, std::span<const std::uint32_t> touches,
                                    Passes& done) {
  bool softer = false;
  for (FrictionRows& f : world.scratch.friction) softer = soften(f, kSoft) || softer;
  if (!softer) return;
  const Passes more =
      pass_over(world, touches, true, kSoftPasses * world.parameters.solver_iterations);
  done = {done.count + more.count, more.worst};
}

/// Speed that a driven body gives what it throws, as it presses a touch: its own where they touch,
/// and as much again by elasticity [m/s].
double throws_at(const World& world, const Touch& touch) {
  const State& driven = world.states[touch.b];
  double fastest = 0.0;
  for (std::uint32_t k = 0; k < touch.points; ++k) {
    const Vec3& p_W = world.scratch.points[touch.first_point + k].p_W;
    fastest = std::max(fastest, velocity_at(driven, p_W - driven.X_WB.p).norm());
  }
  return (1.0 + touch.pair.elasticity) * fastest;
}

/// An island that driven bodies press, which may have no solution: they insist, and something behind
/// does not give way.
class Squeeze {
 public:
  /// Notes how the island is before it is solved, if a driven body that moves touches it.
  Squeeze(World& world, std::span<const std::uint32_t> touches) : world_(world), touches_(touches) {
    Scratch& s = world.scratch;
    s.pressed.clear();
    s.pressing.clear();
    if (s.driven.empty() || world.parameters.rules < 2) return;
    for (const std::uint32_t k : touches) {
      const Touch& touch = s.touches[k];
      if (touch.points == 0 || world.bodies[touch.b].kind != Kind::driven) continue;
      if (s.top_speed[touch.b] == 0.0) continue;
      s.pressing.emplace_back(touch.b, world.states[touch.b]);
      most_ = std::max(most_, throws_at(world, touch));
      most_energy_ = hoop_energy(most_);
    }
    if (s.pressing.empty()) return;
    for (const std::uint32_t k : touches) {
      note(s.touches[k].a);
      if (s.touches[k].b_moves) note(s.touches[k].b);
    }
  }

  /// Whether the solution is none, or something gets faster than what is driven would throw it.
  bool is_found(bool solved) const {
    const Scratch& s = world_.scratch;
    if (s.pressing.empty()) return false;
    if (!solved) return true;
    for (const auto& [i, before] : s.pressed) {
      if (world_.states[i].v_WB.norm() > most_) return true;
      if (energy_per_mass(world_, i, world_.states[i]) > most_energy_) return true;
    }
    return false;
  }

  /// Takes the impulses back; until the island is solved again what is driven stands still, so that
  /// it stops what comes and gives no speed. It overlaps what it presses the more.
  void yield() {
    Scratch& s = world_.scratch;
    for (const auto& [i, before] : s.pressed) world_.states[i] = before;
    for (NormalRow& row : s.rows) row.impulse = 0.0;
    for (FrictionRows& f : s.friction) {
      f.impulse = Vec2::Zero();
      f.twist = 0.0;
      f.roll = Vec3::Zero();
      f.releases = 0;
    }
    for (const auto& [i, state] : s.pressing) {
      world_.states[i].v_WB = world_.states[i].w_WB = Vec3::Zero();
    }
  }
  void insist() {
    Scratch& s = world_.scratch;
    for (const auto& [i, state] : s.pressing) world_.states[i] = state;
    for (const std::uint32_t k : touches_) {
      Touch& touch = s.touches[k];
      if (s.top_speed[touch.b] > 0.0 && !touch.b_moves) touch.insists = true;
    }
  }

 private:
  void note(BodyId i) {
    const State& state = world_.states[i];
    world_.scratch.pressed.emplace_back(i, state);
    most_ = std::max(most_, state.v_WB.norm());
    most_energy_ = std::max(most_energy_, energy_per_mass(world_, i, state));
  }

  World& world_;
  std::span<const std::uint32_t> touches_;
  double most_ = 0.0, most_energy_ = 0.0;
};

/// Keeps what is asked for later of an island's contacts: what they carry, which are deep.
void keep(World& world, std::span<const std::uint32_t> touches) {
  Scratch& s = world.scratch;
  const double slop = world.parameters.slop;
  double& deepest = world.statistics.deepest_overlap;
  for (const FrictionRows& f : s.friction) {
    Touch& touch = s.touches[f.touch];
    touch.friction_W = f.impulse[0] * f.t[0] + f.impulse[1] * f.t[1];
    touch.twist = f.twist;
    touch.roll = f.roll;
  }
  for (const std::uint32_t k : touches) {
    Touch& touch = s.touches[k];
    if (touch.rows == 0) continue;
    touch.first_load = static_cast<std::uint32_t>(s.loads.size());
    touch.first_deep = static_cast<std::uint32_t>(s.deep_rows.size());
    Vec3 F = touch.friction_W;
    double load = 0.0;
    for (std::uint32_t n = 0; n < touch.rows; ++n) {
      const NormalRow& row = s.rows[touch.first_row + n];
      const double depth = s.points[touch.first_point + n].depth;
      s.loads.push_back({row.impulse, row.feature});
      F -= row.impulse * row.n;
      load += row.impulse;
      touch.depth = std::max(touch.depth, depth);
      if (depth > slop) s.deep_rows.push_back({row, touch.first_point + n});
    }
    touch.deep = static_cast<std::uint32_t>(s.deep_rows.size()) - touch.first_deep;
    deepest = std::max(deepest, touch.depth);
    const double lift = -F.dot(world.parameters.gravity_W);
    s.carried[touch.a] += lift;
    if (touch.b_moves) s.carried[touch.b] -= lift;
    if (!touch.met && load > 0.0) s.met_now.push_back(k);
  }
}

HEADPIN_FLATTEN void solve_island(World& world, std::span<const std::uint32_t> touches) {
  Scratch& s = world.scratch;
  const Parameters& p = world.parameters;
  s.rows.clear();
  s.blocks.clear();
  s.friction.clear();
  Squeeze squeeze(world, touches);
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
      const PastTouch& last = s.last_touches[touch.last];
      touch.friction_W = last.friction_W;
      touch.twist = last.twist;
      touch.roll = last.roll_W;
    }
    if (touch.rows == 0 || touch.sliding.kept == 1.0) continue;
    with_other(world, touch, [&]<Other other> { add_friction<other>(world, touch, k); });
  }
  Passes done = pass_over(world, touches, true, p.solver_iterations);
  if (done.worst > p.solver_residual) solve_softly(world, touches, done);
  if (squeeze.is_found(done.worst <= p.solver_residual)) {
    squeeze.yield();
    const Passes more = pass_over(world, touches, true, p.solver_iterations);
    done = {done.count + more.count, more.worst};
    if (done.worst > p.solver_residual) take_back_gain(world, touches, done);
    squeeze.insist();
  } else if (done.worst > p.solver_residual) {
    take_back_gain(world, touches, done);
  }
  keep(world, touches);
  if (p.keep_ledger && !s.driven.empty()) world.pushed += given_by_driven(world, touches);
  ++world.statistics.islands;
  world.statistics.solver_iterations += done.count;
  world.statistics.unsolved += done.worst > p.solver_residual ? 1 : 0;
  world.statistics.residual = std::max(world.statistics.residual, done.worst);
}

/// Notes what part of each body's weight its contacts carry, and who need not fall in the next step:
/// what is carried by half at least and does not rise.
void note_carried(World& world) {
  Scratch& s = world.scratch;
  const Vec3& g = world.parameters.gravity_W;
  const double fall = g.squaredNorm() * step_seconds(world);
  const double rise = g.norm() * s.lasting_speed;
  for (const BodyId i : s.movers) {
    double& part = s.carried[i];
    part = part > 0.0 ? std::min(1.0, part / (fall * world.bodies[i].mass)) : 0.0;
    s.supported[i] = part >= 0.5 && -world.states[i].v_WB.dot(g) <= rise;
  }
}

/// Notes who has met.
void note_met(World& world) {
  Scratch& s = world.scratch;
  std::sort(s.met_now.begin(), s.met_now.end());
  for (const std::uint32_t touch_number : s.met_now) {
    Touch& touch = s.touches[touch_number];
    touch.met = true;
    const Load* const loads = s.loads.data() + touch.first_load;
    double load = 0.0;
    std::uint32_t k = 0;  // the point that carries most
    for (std::uint32_t i = 0; i < touch.rows; ++i) {
      load += loads[i].impulse;
      if (loads[i].impulse > loads[k].impulse) k = i;
    }
    const ContactPoint& point = s.points[touch.first_point + k];
    world.events.push_back({touch.a, touch.b, point.p_W, point.n_AB_W,
                            -load * point.n_AB_W + touch.friction_W, 0.0, true});
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
  s.loads.clear();
  s.deep_rows.clear();
  s.met_now.clear();
  for (const BodyId i : s.movers) s.carried[i] = 0.0;
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
