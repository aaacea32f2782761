#include "engine/direct.h"

#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "engine/passes.h"
#include "engine/stages.h"
#include "tests/support/bowling.h"
#include "tests/support/random_shapes.h"

// Direct solutions of islands: the order of elimination, and the conditions that the impulses must meet.
namespace headpin::engine {
namespace {

using namespace detail;

/// Touches of bodies, for the plan alone. Bodies are numbers from 0 on; their ids have gaps.
struct TouchingGraph {
  World world = make_world({});
  Flight flight;
  Solved result;
  Rows rows;
  IslandPart part;
  std::vector<Touch> touches;
  std::vector<SolvedTouch> solved;
  std::vector<std::uint32_t> each;

  void add(std::uint32_t a, std::uint32_t b, bool b_moves = true, std::uint32_t points = 1) {
    Touch touch;
    touch.a = 3 * a + 5;
    touch.b = 3 * b + 5;
    touch.b_moves = b_moves;
    each.push_back(static_cast<std::uint32_t>(touches.size()));
    touches.push_back(touch);
    solved.emplace_back().rows = points;
  }
  Island island() {
    return {world,  flight, touches.data(),     nullptr, solved.data(),
            result, rows,   {nullptr, nullptr}, part,    each};
  }
};

/// Each body on the one before.
TouchingGraph tower(std::uint32_t bodies) {
  TouchingGraph g;
  g.add(0, 1000, false);
  for (std::uint32_t i = 1; i < bodies; ++i) g.add(i, i - 1);
  return g;
}

TouchingGraph all_touch(std::uint32_t bodies) {
  TouchingGraph g;
  for (std::uint32_t i = 0; i < bodies; ++i) {
    for (std::uint32_t k = 0; k < i; ++k) g.add(k, i);
  }
  return g;
}

TEST(DirectPlan, TakesAHundredBodiesOnEachOtherOrAFewThatAllTouchAndNoMore) {
  Direct d;
  for (const int rules : {15, 16}) {
    const auto planned = [&](TouchingGraph g) {
      g.world.parameters.rules = rules;
      return plan_direct(g.island(), d);
    };
    EXPECT_TRUE(planned(tower(100)));
    EXPECT_FALSE(planned(tower(101)));
    const std::uint32_t most = rules == 15 ? 10 : 5;  // a pile is no stack
    EXPECT_TRUE(planned(all_touch(most)));
    EXPECT_FALSE(planned(all_touch(most + 1)));
    EXPECT_TRUE(planned(tower(1)));
  }
}

/// Follows the plan in sets of neighbours: what is eliminated joins its neighbours to each other.
void expect_follows(const Direct& d, std::vector<std::set<std::uint32_t>> near) {
  const auto n = static_cast<std::uint32_t>(near.size());
  ASSERT_EQ(d.eliminations.size(), n);
  std::set<std::uint32_t> left, blocks;
  for (std::uint32_t i = 0; i < n; ++i) left.insert(i);
  for (std::uint32_t p = 0; p < n; ++p) {
    const DirectElimination& e = d.eliminations[p];
    std::uint32_t fewest = *left.begin();  // the first of those with as few
    for (const std::uint32_t i : left) fewest = near[i].size() < near[fewest].size() ? i : fewest;
    ASSERT_EQ(e.body, fewest);
    EXPECT_EQ(d.place[e.body], p);
    const auto first = d.later.begin() + e.first;
    const std::set<std::uint32_t> later(first, first + e.count);
    ASSERT_EQ(later, near[e.body]);
    left.erase(e.body);
    blocks.insert(d.block_of[e.body * n + e.body]);
    for (const std::uint32_t i : later) {
      blocks.insert(d.block_of[i * n + e.body]);
      near[i].erase(e.body);
      for (const std::uint32_t k : later) {
        if (k != i) near[i].insert(k);
      }
    }
  }
  ASSERT_EQ(blocks.size(), n + d.later.size());  // each pair has its own
  EXPECT_EQ(*blocks.rbegin() + 1, blocks.size());
  EXPECT_EQ(d.blocks.size(), blocks.size());
}

TEST(DirectPlan, EliminatesTheBodyWithFewestNeighboursWhichThenTouchEachOther) {
  Random random(71);
  Direct d;  // serves them all
  int with_more = 0;
  for (int round = 0; round < 300; ++round) {
    if (round % 3 == 0) {
      EXPECT_FALSE(plan_direct(all_touch(14).island(), d));
    }
    const auto n = static_cast<std::uint32_t>(2 + index_below(random, 11));
    TouchingGraph g;
    std::vector<std::set<std::uint32_t>> near(n);
    for (std::uint32_t i = 0; i < n; ++i) g.add(i, 1000 + i, false);
    std::size_t pairs = 0;
    for (int k = 0; k < static_cast<int>(n) + index_below(random, 6); ++k) {
      const auto a = static_cast<std::uint32_t>(index_below(random, static_cast<int>(n)));
      const auto b = static_cast<std::uint32_t>(index_below(random, static_cast<int>(n)));
      if (a == b) continue;
      const bool touch = index_below(random, 4) != 0;  // others are only near
      g.add(a, b, true, touch ? 1 : 0);
      if (!touch) continue;
      pairs += near[a].insert(b).second ? 1 : 0;
      near[b].insert(a);
    }
    ASSERT_TRUE(plan_direct(g.island(), d));
    expect_follows(d, near);
    if (HasFatalFailure()) return;
    with_more += d.later.size() > pairs ? 1 : 0;
  }
  EXPECT_GT(with_more, 30);
}

/// Boxes, balls and logs on a platform that a driven wall touches: an island with all kinds of rows.
World furnished(std::string_view response, double rolling_arm) {
  World world = make_world({.response = response, .sleep = false});
  const Material rough{0.5, 0.8}, rolls{0.5, 0.8, rolling_arm};
  add_body(world, floor_body(rough));
  Body wall = solid(test::box({0.05, 0.5, 0.05}), rough);
  wall.kind = Kind::driven;
  add_body(world, wall, at(Vec3(1.05, 0.0, 0.06), Vec3(0.0, 0.01, 0.0), Vec3(0.0, 0.0, 0.02)));
  add_body(world, solid(test::box({1.0, 1.0, 0.05}), rough), at(Vec3(0.0, 0.0, 0.05)));
  const Shape cube = test::box({0.1, 0.1, 0.1}), ball = Ellipsoid{Vec3::Constant(0.1)};
  for (const double x : {-0.2, 0.2}) {
    add_body(world, solid(cube, rough), at(Vec3(x, 0.5, 0.2)));
    add_body(world, solid(ball, rolls), at(Vec3(0.5 * x, -0.5, 0.2)));
  }
  add_body(world, solid(test::box({0.4, 0.1, 0.02}), rough), at(Vec3(0.03, 0.5, 0.32)));
  add_body(world, solid(ball, rolls), at(Vec3(0.3, -0.5, 0.2)));
  const Quat lying(std::sqrt(0.5), std::sqrt(0.5), 0.0, 0.0);
  const Shape log = Cylinder{0.05, 0.2};
  for (const double x : {0.4, 0.5}) {
    add_body(world, solid(log, rolls), at(Pose{lying, {x, 0.0, 0.15}}));
  }
  return world;
}

/// The one island of a world after its lasting contacts were solved, to be solved again from other states and
/// impulses.
struct DirectProblem {
  World world;
  Workspace w;
  Touches* touches = nullptr;
  Island s;
  std::vector<double> x0;  ///< impulses before: of each touch normals, slip, twist, roll
  std::vector<State> v0;
  std::vector<double> loads;  ///< before, of the touches

  explicit DirectProblem(World made)
      : world(std::move(made)), s(solve(world, w, touches)), v0(world.states) {}

  static Island solve(World& world, Workspace& w, Touches*& touches) {
    touches = &find_touches(world, w);
    const Flight& flight = *resolve_impacts(world, *touches, w);
    for (const BodyId i : world.roll.movers) {
      world.states[i].v_WB += step_seconds(world) * world.parameters.gravity_W;
    }
    Solved& solved = sustain(world, *touches, flight, w);
    EXPECT_EQ(solved.islands.end.size(), 1u);
    Rows& rows = w.each_thread[0].rows;
    Island s{world,
             flight,
             touches->all.data(),
             touches->points.data(),
             solved.touches.data(),
             solved,
             rows,
             {world.states.data(), flight.mobility.data()},
             w.island_parts[0]};
    s.each = solved.islands.order;
    s.normals = rows.normals;
    return s;
  }

  /// Calls f(touch, its results, its friction or null) for the touches with points.
  template <typename F>
  void each_pair(F&& f) {
    for (const std::uint32_t k : s.each) {
      FrictionRows* mine = nullptr;
      for (FrictionRows& rows : s.rows.friction) mine = rows.touch == k ? &rows : mine;
      if (s.solved[k].rows > 0) f(s.touches[k], s.solved[k], mine);
    }
  }

  std::vector<double> impulses() {
    std::vector<double> x;
    each_pair([&](const Touch&, const SolvedTouch& solved, const FrictionRows* f) {
      for (std::uint32_t k = 0; k < solved.rows; ++k) {
        x.push_back(s.normals[solved.first_row + k].impulse);
      }
      if (!f) return;
      x.insert(x.end(), {f->impulse[0], f->impulse[1], f->twist});
      x.insert(x.end(), {f->roll[0], f->roll[1], f->roll[2]});
    });
    return x;
  }

  /// Remembers what the next solution starts from.
  void start() {
    x0 = impulses();
    v0 = world.states;
    loads.clear();
    each_pair([&](const Touch&, const SolvedTouch& solved, const FrictionRows*) {
      double load = 0.0;
      for (std::uint32_t k = 0; k < solved.rows; ++k) {
        load += s.normals[solved.first_row + k].impulse;
      }
      loads.push_back(load);
    });
  }

  /// Other velocities, and impulses from none to twice as large.
  void shake(Random& random, double speed, double much) {
    for (const BodyId i : world.roll.movers) {
      world.states[i].v_WB += speed * random.normal3();
      world.states[i].w_WB += 5.0 * speed * random.normal3();
    }
    each_pair([&](const Touch&, const SolvedTouch& solved, FrictionRows* f) {
      for (std::uint32_t k = 0; k < solved.rows; ++k) {
        const bool none = much == 1.0 && index_below(random, 4) == 0;
        s.normals[solved.first_row + k].impulse *=
            none ? 0.0 : random.uniform(1.0 - much, 1.0 + much);
      }
      if (!f) return;
      f->impulse *= random.uniform(1.0 - 2.0 * much, 1.0 + much);
      f->twist *= random.uniform(1.0 - 2.0 * much, 1.0 + much);
      f->roll *= random.uniform(1.0 - 2.0 * much, 1.0 + much);
    });
  }
};

Vec3 velocity_of(const DirectProblem& p, BodyId body, bool moves) {
  return moves ? p.world.states[body].v_WB : Vec3(Vec3::Zero());
}

/// Momentum: what the impulses changed is what the velocities changed.
void expect_momentum(DirectProblem& p) {
  std::vector<Vec3> force(p.world.bodies.size(), Vec3::Zero()), torque = force;
  const std::vector<double> x = p.impulses();
  std::size_t n = 0;
  p.each_pair([&](const Touch& t, const SolvedTouch& solved, const FrictionRows* f) {
    const auto add = [&](const Vec3& F, const Vec3& on_a, const Vec3& on_b) {
      force[t.a] += F;
      torque[t.a] += on_a;
      force[t.b] -= F;
      torque[t.b] -= on_b;
    };
    for (std::uint32_t k = 0; k < solved.rows; ++k, ++n) {
      const NormalRow& row = p.s.normals[solved.first_row + k];
      const double more = x[n] - p.x0[n];
      add(-more * row.n, -more * row.ra_n, t.b_moves ? -more * row.rb_n : Vec3(Vec3::Zero()));
    }
    if (!f) return;
    for (std::size_t i = 0; i < 2; ++i, ++n) {
      const double more = x[n] - p.x0[n];
      add(more * f->t[i], more * f->a.r_t[i], t.b_moves ? more * f->b.r_t[i] : Vec3(Vec3::Zero()));
    }
    const Vec3 turn = (x[n] - p.x0[n]) * f->n +
                      Vec3(x[n + 1] - p.x0[n + 1], x[n + 2] - p.x0[n + 2], x[n + 3] - p.x0[n + 3]);
    add(Vec3::Zero(), turn, turn);
    n += 4;
  });
  for (const BodyId i : p.world.roll.movers) {
    const Mobility& m = p.w.flight.mobility[i];
    const State &now = p.world.states[i], &before = p.v0[i];
    EXPECT_LT((now.v_WB - before.v_WB - m.inv_mass * force[i]).norm(), 1e-10) << i;
    EXPECT_LT((now.w_WB - before.w_WB - m.inv_inertia_W * torque[i]).norm(), 1e-9) << i;
  }
}

/// Of one impulse with bounds: what it leaves pulls it only against a bound that it is at.
void expect_bounded(double x, double least, double most, double left, const char* what) {
  const double near = 1e-9 * (1.0 + std::abs(x));
  EXPECT_GE(x, least - near) << what;
  EXPECT_LE(x, most + near) << what;
  EXPECT_TRUE(x <= least + near || left < 1e-9) << what << ": " << x << " leaves " << left;
  EXPECT_TRUE(x >= most - near || left > -1e-9) << what << ": " << x << " leaves " << left;
}

/// Of two impulses with a common limit: at the limit they pull against what they leave.
void expect_in_disc(const Vec2& x, double limit, const Vec2& left, const char* what) {
  const double size = x.norm();
  EXPECT_LE(size, limit * (1.0 + 1e-9) + 1e-15) << what;
  if (size < limit * (1.0 - 1e-9)) {
    EXPECT_LT(left.norm(), 1e-9) << what;
  } else if (size > 0.0) {
    EXPECT_LT(std::abs(left[0] * x[1] - left[1] * x[0]), 1e-9 * size) << what;
    EXPECT_LT(left.dot(x), 1e-9 * size) << what;
  }
}

/// The conditions of the minimum: each impulse is x0 - (velocity - allowed) / c, within its limits.
void expect_minimum(DirectProblem& p, double compliance) {
  std::size_t n = 0, touch = 0;
  p.each_pair([&](const Touch& t, const SolvedTouch& solved, const FrictionRows* f) {
    const bool moves = t.b_moves || t.b_driven;
    const State &sa = p.world.states[t.a], &sb = p.world.states[t.b];
    const Vec3 v = sa.v_WB - velocity_of(p, t.b, moves);
    const Vec3 spin = moves ? Vec3(sa.w_WB - sb.w_WB) : sa.w_WB;
    for (std::uint32_t k = 0; k < solved.rows; ++k) {
      const NormalRow& row = p.s.normals[solved.first_row + k];
      const double approach =
          row.n.dot(v) + row.ra_n.dot(sa.w_WB) - (moves ? row.rb_n.dot(sb.w_WB) : 0.0);
      const double left =
          row.allowed - approach + compliance / row.mass * (row.impulse - p.x0[n++]);
      expect_bounded(row.impulse, 0.0, 1e300, left, "normal");
    }
    const double load = p.loads[touch++];
    if (!f) return;
    const bool loaded = load > kRoundedLoad / f->yields;
    const double most = loaded ? t.sliding.limit * load : 0.0;
    Vec2 left = f->softness * f->impulse +
                compliance * f->yields * (f->impulse - Vec2(p.x0[n], p.x0[n + 1]));
    for (std::size_t i = 0; i < 2; ++i) {
      left[static_cast<Eigen::Index>(i)] +=
          f->t[i].dot(v) + f->a.r_t[i].dot(sa.w_WB) - (moves ? f->b.r_t[i].dot(sb.w_WB) : 0.0);
    }
    expect_in_disc(f->impulse, most, left, "slip");
    n += 2;
    if (f->twist_mass > 0.0) {
      const double turn = f->n.dot(spin) + f->twist_softness * f->twist +
                          compliance / f->twist_mass * (f->twist - p.x0[n]);
      const double bound = loaded ? most * f->reach : 0.0;
      expect_bounded(f->twist, -bound, bound, turn, "twist");
    }
    const Vec3 roll0(p.x0[n + 1], p.x0[n + 2], p.x0[n + 3]);
    n += 4;
    if (f->roll_arm == 0.0) return;
    const Vec3 turn = spin + compliance / f->roll_mass * (f->roll - roll0);
    const double bound = f->roll_arm * load;
    if (f->rolls_any) {
      expect_in_disc({f->roll.dot(f->t[0]), f->roll.dot(f->t[1])}, bound,
                     {turn.dot(f->t[0]), turn.dot(f->t[1])}, "roll");
    } else {
      expect_bounded(f->roll.dot(f->axis), -bound, bound, turn.dot(f->axis), "roll about an axis");
    }
  });
}

TEST(DirectSolution, MeetsTheConditionsOfTheMinimumAndKeepsMomentum) {
  constexpr double kParts[] = {0.01, 0.1, 1.0};
  Random random(72);
  int solved = 0, steps_in_all = 0;
  for (const std::string_view response : {"coulomb", "paper"}) {
    const double softest = response == "paper" ? 0.1 : 10.0;
    for (const double arm : {0.0, 2e-3}) {
      const World world = furnished(response, arm);
      for (int round = 0; round < 24; ++round) {
        DirectProblem p(world);
        ASSERT_TRUE(plan_direct(p.s, p.s.rows.direct));
        if (round % 5 == 2) {  // a touch whose bodies are only near
          p.s.solved[p.s.rows.friction.back().touch].rows = 0;
          p.s.rows.friction.pop_back();
        }
        const double compliance = softest * kParts[round % 3];
        p.shake(random, round % 4 == 0 ? 1e-3 : 1e-2, round % 8 < 4 ? 0.3 : 1.0);
        p.start();
        const int steps = solve_directly(p.s, p.s.rows.direct, compliance, 1e-11 / compliance);
        if (steps == 0) {  // it leaves all as it was
          EXPECT_EQ(p.impulses(), p.x0);
          for (const BodyId i : p.world.roll.movers) {
            EXPECT_EQ(p.world.states[i].v_WB, p.v0[i].v_WB);
            EXPECT_EQ(p.world.states[i].w_WB, p.v0[i].w_WB);
          }
          continue;
        }
        ++solved;
        steps_in_all += steps;
        expect_momentum(p);
        expect_minimum(p, compliance);
        if (HasFailure()) {
          FAIL() << response << " arm " << arm << " round " << round << ": " << steps << " steps";
        }
      }
    }
  }
  EXPECT_GE(solved, 92);                  // of 96
  EXPECT_LT(steps_in_all, 6.4 * solved);  // as Newton converges with the right matrix
}

// Within the limits the function is quadratic: one step of Newton's method ends at its minimum, and another one
// finds it there.
TEST(DirectSolution, TakesOneStepWhereNothingReachesALimit) {
  Random random(73);
  for (const std::string_view response : {"coulomb", "paper"}) {
    for (const double arm : {0.0, 2e-3}) {
      DirectProblem p(furnished(response, arm));
      ASSERT_TRUE(plan_direct(p.s, p.s.rows.direct));
      for (State& state : p.world.states) {
        state.v_WB = 1e-6 * random.normal3();
        state.w_WB = Vec3::Zero();
      }
      for (NormalRow& row : p.s.normals) row.impulse = 1.0;
      for (FrictionRows& f : p.s.rows.friction) {
        f.impulse = Vec2::Zero();
        f.roll = Vec3::Zero();
        f.twist = 0.0;
      }
      p.start();
      EXPECT_EQ(solve_directly(p.s, p.s.rows.direct, 1e-2, 1e-9), 2) << response << " " << arm;
    }
  }
}

}  // namespace
}  // namespace headpin::engine
