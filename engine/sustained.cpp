#include <algorithm>
#include <limits>
#include <utility>

#include "engine/direct.h"
#include "engine/enough.h"
#include "engine/inlining.h"
#include "engine/islands.h"
#include "engine/passes.h"
#include "engine/rules.h"
#include "engine/squeeze.h"
#include "engine/stages.h"
#include "engine/touching.h"

namespace headpin::engine::detail {
namespace {

/// Part of a slip that friction leaves in an island that is not solved otherwise, and the number of
/// passes for that, as a multiple of the usual number.
constexpr double kSoft = 0.01;
constexpr int kSoftPasses = 4;

/// After the plain passes, an island is solved directly this many times at most, each time with less
/// compliance.
constexpr int kDirectRounds = 10;
constexpr double kSoftest = 1e-3, kHardest = 1e-6;
constexpr double kFar = std::numeric_limits<double>::infinity();
constexpr int kQuick = 3;  // Newton's steps after which the next compliance may be smaller

/// Accelerated passes before an island is solved directly, unless they converge slowly.
constexpr int kQuickPasses = 100;

/// Square of the cosine between normal and gravity from which a surface is level: within a quarter of a
/// degree.
constexpr double kLevel = 1.0 - 2e-5;

/// Energy that an unsolved island may gain, as a fraction of its kinetic energy.
constexpr double kGain = 1e-9;

PassPlan all_plain(int most, double enough) {
  return {most, enough, most};
}

/// More passes over an island that was not solved.
void go_on(const Island& s, Passes& done, const PassPlan& plan) {
  const int count = done.count;
  done = pass_over(s, plan);
  done.count += count;
}

/// Energy and momentum that driven bodies give through the island's contacts.
Balance given_by_driven(const Island& s) {
  const World& world = s.world;
  Balance given;
  const auto book = [&](const Touch& touch, const Vec3& F, const Vec3& torque) {
    if (!touch.b_driven) return;
    const State& driven = world.states[touch.b];
    given.energy += F.dot(driven.v_WB) + torque.dot(driven.w_WB);
    given.momentum += F;
    given.angular_momentum += arms_of<Other::driven>(world, s.flight, touch).p_WB.cross(F) + torque;
  };
  for (const std::uint32_t k : s.each) {
    const SolvedTouch& solved = s.solved[k];
    for (std::uint32_t n = 0; n < solved.rows; ++n) {
      const NormalRow& row = s.normals[solved.first_row + n];
      book(s.touches[k], -row.impulse * row.n, -row.impulse * row.rb_n);
    }
  }
  for (const FrictionRows& f : s.rows.friction) {
    book(s.touches[f.touch], f.impulse[0] * f.t[0] + f.impulse[1] * f.t[1],
         f.impulse[0] * f.b.r_t[0] + f.impulse[1] * f.b.r_t[1] + f.twist * f.n + f.roll);
  }
  return given;
}

/// Kinetic energy of an island's bodies; each is listed once [J].
double energy_of(const World& world, std::span<const BodyId> bodies) {
  double sum = 0.0;
  for (const BodyId i : bodies) {
    const State& s = world.states[i];
    sum += 0.5 * world.bodies[i].mass * s.v_WB.squaredNorm() +
           turning_energy(world.inertias[i], s.X_WB.q, s.w_WB);
  }
  return sum;
}

/// Passes that do not converge may add energy, as where friction wedges a light body between heavy
/// ones: a load causes friction, and friction causes more load. Such an island is solved again,
/// with its friction limited by the loads of a solution without friction. With this limit, nearly
/// every pass removes energy. If the island still gains energy, it has no friction in this step.
[[gnu::noinline]] void take_back_gain(const Island& s, Passes& done) {
  World& world = s.world;
  const Parameters& p = world.parameters;
  std::vector<BodyId>& bodies = s.rows.bodies;
  list_bodies(s, bodies);
  std::vector<State>& unsolved = s.rows.unsolved;
  unsolved.clear();
  for (const BodyId i : bodies) unsolved.push_back(world.states[i]);
  std::vector<double>& before = s.rows.before;
  before.clear();
  each_impulse(s, [&](double& x, double, auto&&) { before.push_back(x); });

  const auto own_energy = [&] { return energy_of(world, bodies) - given_by_driven(s).energy; };
  const auto undo = [&] { each_impulse(s, [&](double& x, double, auto&& push) { push(-x); }); };
  const double after = own_energy();
  undo();
  const double start = own_energy(), most = start + kGain * start;
  if (after <= most) {  // unsolved, but harmless
    for (std::size_t k = 0; k < bodies.size(); ++k) world.states[bodies[k]] = unsolved[k];
    std::size_t n = 0;
    each_impulse(s, [&](double& x, double, auto&&) { x = before[n++]; });
    return;
  }
  const auto once_more = [&] { go_on(s, done, all_plain(p.solver_iterations, p.solver_residual)); };
  for (FrictionRows& f : s.rows.friction) f.hold(0.0);
  once_more();
  for (FrictionRows& f : s.rows.friction) f.hold(load_of(s, s.solved[f.touch]));
  once_more();
  if (own_energy() <= most) return;
  undo();
  for (FrictionRows& f : s.rows.friction) f.hold(0.0);
  once_more();
}

/// Continues with softer friction where passes did not converge, if any friction can be softer.
[[gnu::noinline]] void solve_softly(const Island& s, Passes& done, double enough) {
  bool softer = false;
  for (FrictionRows& f : s.rows.friction) softer = soften(f, kSoft) || softer;
  if (!softer) return;
  const Parameters& p = s.world.parameters;
  go_on(s, done, {kSoftPasses * p.solver_iterations, enough});
}

/// Stores the impulses of an island, and the states of its bodies.
void store(const Island& s, const std::vector<BodyId>& bodies) {
  RowsBefore& start = s.rows.start;
  start.loads.clear();
  for (const NormalRow& row : s.normals) start.loads.push_back(row.impulse);
  start.friction = s.rows.friction;
  start.states.clear();
  for (const BodyId i : bodies) start.states.push_back(s.world.states[i]);
}
void put_back(const Island& s, const std::vector<BodyId>& bodies) {
  const RowsBefore& start = s.rows.start;
  for (std::size_t k = 0; k < s.normals.size(); ++k) s.normals[k].impulse = start.loads[k];
  s.rows.friction = start.friction;
  for (std::size_t k = 0; k < bodies.size(); ++k) s.world.states[bodies[k]] = start.states[k];
}

/// Accelerated passes over an island that is planned, as long as they converge quickly. If they do not solve it,
/// they change nothing: direct solutions converge less often from where such passes have come to. They leave out no
/// friction: one that goes on and off without end is no solution.
void solve_quickly(const Island& s, Passes& done) {
  const Parameters& p = s.world.parameters;
  const std::vector<BodyId>& bodies = s.rows.direct.bodies;
  store(s, bodies);
  for (FrictionRows& f : s.rows.friction) f.releases = -kQuickPasses;
  go_on(s, done, {std::min(kQuickPasses, p.solver_iterations), p.solver_residual, 1, true});
  for (FrictionRows& f : s.rows.friction) f.releases = 0;
  if (!done.solved) put_back(s, bodies);
}

/// Direct solutions of an island, until a pass finds it solved.
[[gnu::noinline]] void solve_in_rounds(const Island& s, Passes& done) {
  const double residual = s.world.parameters.solver_residual;
  const bool gives_up = speeds_up_first(s.world.parameters);
  double compliance = kSoftest, last = kFar, before_last = kFar;
  for (int round = 0; round < kDirectRounds && !done.solved; ++round) {
    const int steps = solve_directly(s, s.rows.direct, compliance, residual);
    if (steps == 0) {
      compliance *= 10.0;
      continue;
    }
    if (steps <= kQuick) compliance = std::max(kHardest, 0.1 * compliance);
    go_on(s, done, all_plain(1, residual));
    // Where friction and load switch each other on and off, two results take turns without end.
    if (gives_up && done.worst > 0.9 * before_last) return;
    before_last = std::exchange(last, done.worst);
  }
}

/// More passes over a slow crowd that is solved, so that it stands. Where they do not solve it as well as that, they
/// change nothing: there are crowds that no number of passes solves so well, as where a body is wedged.
[[gnu::noinline]] void solve_to_stand(const Island& s, Passes& done) {
  std::vector<BodyId>& bodies = s.rows.bodies;
  list_bodies(s, bodies);
  if (!is_slow(s, bodies)) return;
  const double enough = enough_to_stand(s.world);
  if (done.worst <= enough) return;
  store(s, bodies);
  const Passes coarse = done;
  go_on(s, done, {s.world.parameters.solver_iterations, enough, 1});
  if (done.solved) return;
  put_back(s, bodies);
  done = {done.count, coarse.worst, true};
}

/// A few plain passes, then accelerated ones as long as they converge quickly, then direct solutions. Where these
/// fail, or are too expensive, more passes, which need not solve the island as well. What is not solved then gets
/// softer friction.
Passes solve_rows(const Island& s) {
  const Parameters& p = s.world.parameters;
  if (!solves_directly(p)) {
    Passes done = pass_over(s, {p.solver_iterations, p.solver_residual});
    if (!done.solved) solve_softly(s, done, p.solver_residual);
    return done;
  }
  const bool quick = speeds_up_first(p);
  const int few = std::min(kPlainPasses, p.solver_iterations);
  Passes done = pass_over(s, all_plain(few, p.solver_residual));
  if (done.solved) return done;
  const bool planned = plan_direct(s, s.rows.direct);
  if (planned && quick) solve_quickly(s, done);
  if (planned) solve_in_rounds(s, done);
  if (done.solved) return done;
  const double enough = enough_for(s, planned);
  go_on(s, done, {p.solver_iterations, enough, quick ? 1 : kPlainPasses});
  if (!done.solved) {
    solve_softly(s, done, enough);
  } else if (!planned && keeps_crowds_standing(p)) {
    solve_to_stand(s, done);
  }
  return done;
}

/// Stores the velocity that friction gives bodies that slide on a level surface. Friction at its limit is the
/// same for the whole step. On a slope the normal force and gravity act along it too.
void note_slide(const Island& s, const FrictionRows& f) {
  const Touch& touch = s.touches[f.touch];
  const double load = f.held ? f.load : load_of(s, s.solved[f.touch]);
  const double most = touch.sliding.limit * load;
  if (!(f.impulse.squaredNorm() >= (1.0 - 1e-6) * most * most)) return;
  const Vec3& g = s.world.parameters.gravity_W;
  const double along = f.n.dot(g);
  if (along * along < kLevel * g.squaredNorm() || along == 0.0) return;
  const Vec3 F = f.impulse[0] * f.t[0] + f.impulse[1] * f.t[1];
  s.result.slowed[touch.a] += s.bodies.mobility[touch.a].inv_mass * F;
  if (touch.b_moves) s.result.slowed[touch.b] -= s.bodies.mobility[touch.b].inv_mass * F;
}

/// Stores the results of an island's contacts for later stages: loads, friction and deep points.
void keep(Island& s) {
  const World& world = s.world;
  Solved& solved = s.result;
  const double slop = world.parameters.slop;
  std::vector<DeepRow>& deep_rows = s.part.deep_rows;
  double& deepest = s.part.statistics.deepest_overlap;
  for (const FrictionRows& f : s.rows.friction) {
    SolvedTouch& touch = solved.touches[f.touch];
    touch.friction_W = f.impulse[0] * f.t[0] + f.impulse[1] * f.t[1];
    touch.twist = f.twist;
    touch.roll = f.roll;
    if (moves_with_the_mean(world.parameters)) note_slide(s, f);
  }
  for (const std::uint32_t k : s.each) {
    const Touch& found = s.touches[k];
    SolvedTouch& touch = solved.touches[k];
    if (touch.rows == 0) continue;
    touch.first_load = s.first_load;
    touch.first_deep = static_cast<std::uint32_t>(deep_rows.size());
    Vec3 F = touch.friction_W;
    double load = 0.0;
    const NormalRow* const rows = s.normals.data() + touch.first_row;
    const ContactPoint* const points = s.points + found.first_point;
    for (std::uint32_t n = 0; n < touch.rows; ++n) {
      const NormalRow& row = rows[n];
      const double depth = points[n].depth;
      solved.loads[s.first_load++] = {row.impulse, row.feature};
      F -= row.impulse * row.n;
      load += row.impulse;
      touch.depth = std::max(touch.depth, depth);
      if (depth > slop) deep_rows.push_back({row, found.first_point + n});
    }
    touch.deep = static_cast<std::uint32_t>(deep_rows.size()) - touch.first_deep;
    deepest = std::max(deepest, touch.depth);
    const double lift = -F.dot(world.parameters.gravity_W);
    solved.carried[found.a] += lift;
    if (found.b_moves) solved.carried[found.b] -= lift;
    if (!touch.met && load > 0.0) s.part.met_now.push_back(k);
  }
}

/// Adds rows for all contact points, then for their friction, with the impulses of the last step.
void add_rows(Island& s) {
  s.rows.blocks.clear();
  s.rows.friction.clear();
  std::uint32_t count = 0;
  for (const std::uint32_t k : s.each) {
    SolvedTouch& solved = s.solved[k];
    solved.first_row = count;
    count += solved.rows;
  }
  if (s.rows.normals.size() < count) s.rows.normals.resize(count);
  s.normals = {s.rows.normals.data(), count};
  for (const std::uint32_t k : s.each) {
    const Touch& touch = s.touches[k];
    SolvedTouch& solved = s.solved[k];
    if (solved.rows == 0) continue;
    with_other(touch, [&]<Other other> {
      add_normal_rows<other>(s, touch, solved);
      with_rows(solved, [&]<int n> {
        add_block<other, n>(s, touch, solved);
        return true;
      });
    });
  }
  for (const std::uint32_t k : s.each) {
    const Touch& touch = s.touches[k];
    SolvedTouch& solved = s.solved[k];
    if (!touch.fresh) {
      const PastTouch& last = s.world.memory.touches[touch.last];
      const double side = side_of(s.world.parameters, touch);
      solved.friction_W = side * last.friction_W;
      solved.twist = last.twist;
      solved.roll = side * last.roll_W;
    }
    if (solved.rows == 0 || touch.sliding.kept == 1.0) continue;
    with_other(touch, [&]<Other other> { add_friction<other>(s, k); });
  }
}

HEADPIN_ALSO_AVX HEADPIN_FLATTEN void solve_island(Island& s, Workspace& w) {
  World& world = s.world;
  const Parameters& p = world.parameters;
  Squeeze squeeze(s);
  add_rows(s);
  Passes done = solve_rows(s);
  const bool squeezed = squeeze.is_found(done);
  if (squeezed) {
    squeeze.yield();
    go_on(s, done, {p.solver_iterations, p.solver_residual});
  }
  const bool solved = done.solved;
  if (!solved) take_back_gain(s, done);  // this solves it without a part of its friction
  // Driven bodies that yielded stand still here: they gave no energy.
  if (p.keep_ledger && !world.roll.driven.empty()) w.by_driven += given_by_driven(s);
  if (squeezed) squeeze.insist();
  keep(s);
  Statistics& sum = s.part.statistics;
  ++sum.islands;
  sum.solver_iterations += done.count;
  sum.unsolved += solved ? 0 : 1;
  sum.residual = std::max(sum.residual, done.worst);
}

/// Stores the part of each body's weight that its contacts carry, and which bodies do not fall in
/// the next step: those that are at least half carried and do not rise.
void note_carried(World& world, const Flight& flight, std::vector<double>& carried, Workspace& w) {
  const Vec3& g = world.parameters.gravity_W;
  const double fall = g.squaredNorm() * step_seconds(world);
  const double rise = g.norm() * flight.lasting_speed;
  each_mover(world, w, [&](BodyId i) {
    double& part = carried[i];
    part = part > 0.0 ? std::min(1.0, part / (fall * world.bodies[i].mass)) : 0.0;
    world.memory.bodies[i].supported = part >= 0.5 && -world.states[i].v_WB.dot(g) <= rise;
  });
}

/// Adds the events of bodies that meet for the first time.
void note_met(World& world, const Touches& touches, Solved& solved,
              std::vector<std::uint32_t>& met_now) {
  std::sort(met_now.begin(), met_now.end());
  for (const std::uint32_t touch_number : met_now) {
    const Touch& touch = touches.all[touch_number];
    SolvedTouch& s = solved.touches[touch_number];
    s.met = true;
    const Load* const loads = solved.loads.data() + s.first_load;
    double load = 0.0;
    std::uint32_t k = 0;  // the point that carries most
    for (std::uint32_t i = 0; i < s.rows; ++i) {
      load += loads[i].impulse;
      if (loads[i].impulse > loads[k].impulse) k = i;
    }
    const ContactPoint& point = touches.points[touch.first_point + k];
    world.events.push_back({touch.a, touch.b, point.p_W, point.n_AB_W,
                            -load * point.n_AB_W + s.friction_W, 0.0, true});
  }
}

/// Prepares the results of all touches.
void begin(const World& world, const Touches& touches, const Flight& flight, Workspace& w) {
  Solved& solved = w.solved;
  solved.carried.resize(world.bodies.size());
  solved.slowed.resize(world.bodies.size());
  each_mover(world, w, [&](BodyId i) {
    solved.carried[i] = 0.0;
    solved.slowed[i] = Vec3::Zero();
  });
  solved.touches.resize(touches.all.size());
  w.crew.share_range(touches.all.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      SolvedTouch& touch = solved.touches[k] = {};
      touch.rows = touches.all[k].points;
      touch.met = touches.all[k].met;
      touch.insists = flight.touches[k].insists;
    }
  });
}

/// Parts of about as many touches each. Islands that one driven body may press are one part: they stop it in
/// turn while they are solved.
void part_islands(const World& world, Workspace& w) {
  const bool together = w.crew.threads() < 2 || !world.roll.driven.empty();
  const Islands& islands = w.solved.islands;
  const std::size_t most = together ? islands.order.size() : Crew::kRange;
  std::size_t parts = 0;
  std::uint32_t loads = 0;
  std::size_t start = 0;  // first touch of the part
  const auto begin_part = [&](std::uint32_t island) {
    if (parts == w.island_parts.size()) w.island_parts.emplace_back();
    IslandPart& part = w.island_parts[parts++];
    part.begin = island;
    part.first_load = loads;
    part.deep_rows.clear();
    part.met_now.clear();
    part.statistics = {};
  };
  begin_part(0);
  std::size_t k = 0;
  for (std::uint32_t n = 0; n < islands.end.size(); ++n) {
    if (k - start >= most) {
      w.island_parts[parts - 1].end = n;
      begin_part(n);
      start = k;
    }
    for (; k < islands.end[n]; ++k) loads += w.solved.touches[islands.order[k]].rows;
  }
  w.island_parts[parts - 1].end = static_cast<std::uint32_t>(islands.end.size());
  w.island_parts.resize(parts);
  w.solved.loads.resize(loads);
}

/// Puts together what the parts have found, in the order of the islands.
void join(World& world, Workspace& w) {
  Solved& solved = w.solved;
  solved.deep_rows.clear();
  w.met_now.clear();
  for (const IslandPart& part : w.island_parts) {
    if (!solved.deep_rows.empty() && !part.deep_rows.empty()) {
      const auto before = static_cast<std::uint32_t>(solved.deep_rows.size());
      for (const std::uint32_t k : touches_of(solved.islands, part)) {
        solved.touches[k].first_deep += before;
      }
    }
    solved.deep_rows.insert(solved.deep_rows.end(), part.deep_rows.begin(), part.deep_rows.end());
    w.met_now.insert(w.met_now.end(), part.met_now.begin(), part.met_now.end());
    world.statistics += part.statistics;
  }
}

}  // namespace

Solved& sustain(World& world, const Touches& touches, const Flight& flight, Workspace& w) {
  Solved& solved = w.solved;
  begin(world, touches, flight, w);
  find_islands(world, touches.all, solved.islands);
  part_islands(world, w);
  w.crew.share(w.island_parts.size(), [&](std::size_t k, std::size_t who) {
    IslandPart& part = w.island_parts[k];
    Island island{world,
                  flight,
                  touches.all.data(),
                  touches.points.data(),
                  solved.touches.data(),
                  solved,
                  w.each_thread[who].rows,
                  {world.states.data(), flight.mobility.data()},
                  part};
    island.first_load = part.first_load;
    for (std::uint32_t n = part.begin; n < part.end; ++n) {
      island.each = touches_of(solved.islands, n);
      solve_island(island, w);
    }
  });
  join(world, w);
  note_carried(world, flight, solved.carried, w);
  note_met(world, touches, solved, w.met_now);
  return solved;
}

}  // namespace headpin::engine::detail
