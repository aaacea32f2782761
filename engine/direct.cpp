#include "engine/direct.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "engine/acceleration.h"
#include "engine/passes.h"

namespace headpin::engine::detail {
namespace {

/// Multiplications of a body's elimination: its own block, and for each neighbour and each two.
constexpr double kOwn = 72.0, kNeighbour = 216.0, kTwo = 216.0;
/// Most multiplications of a factorisation: 100 bodies on each other; under older rules also 10 that all touch.
constexpr double kMostProducts = 5e4;
/// Where there are more than this, most for each body: it is 500 in a stack, 700 in a card house, 1300 and more in
/// a pile. Direct solutions of piles need many of Newton's steps, and piles stand without them.
constexpr double kFewProducts = 1e4, kMostOfABody = 1000.0;
constexpr int kNewtonSteps = 12;
constexpr int kSearches = 20;  // for the length of a step

std::uint32_t number_of(const Direct& d, BodyId body) {
  const auto place = std::lower_bound(d.bodies.begin(), d.bodies.end(), body);
  return static_cast<std::uint32_t>(place - d.bodies.begin());
}

Mat6& block(Direct& d, std::uint32_t row, std::uint32_t column) {
  return d.blocks[d.block_of[row * d.bodies.size() + column]];
}

/// Calls f(touch, its results, its friction or null) for the island's touches with rows.
template <typename F>
void each_touch(const Island& s, F&& f) {
  auto friction = s.rows.friction.begin();
  for (const std::uint32_t k : s.each) {
    if (s.solved[k].rows == 0) continue;
    const bool rough = friction != s.rows.friction.end() && friction->touch == k;
    f(s.touches[k], s.solved[k], rough ? &*friction++ : nullptr);
  }
}

/// Marks which bodies touch: `block_of` is 0 where they do, kNone elsewhere.
void mark_neighbours(const Island& s, Direct& d) {
  const std::size_t n = d.bodies.size();
  d.block_of.assign(n * n, kNone);
  d.neighbours.assign(n, 0);
  each_touch(s, [&](const Touch& touch, const SolvedTouch&, const FrictionRows*) {
    if (!touch.b_moves) return;
    const std::uint32_t a = number_of(d, touch.a), b = number_of(d, touch.b);
    if (d.block_of[a * n + b] == 0) return;
    d.block_of[a * n + b] = d.block_of[b * n + a] = 0;
    ++d.neighbours[a];
    ++d.neighbours[b];
  });
}

/// Removes the body with the fewest neighbours; its neighbours become neighbours of each other.
void eliminate_next(Direct& d) {
  const std::size_t n = d.bodies.size();
  std::uint32_t next = kNone;
  for (std::uint32_t i = 0; i < n; ++i) {
    if (d.place[i] != kNone) continue;
    if (next == kNone || d.neighbours[i] < d.neighbours[next]) next = i;
  }
  d.place[next] = static_cast<std::uint32_t>(d.eliminations.size());
  const auto first = static_cast<std::uint32_t>(d.later.size());
  for (std::uint32_t i = 0; i < n; ++i) {
    if (d.block_of[next * n + i] == 0 && d.place[i] == kNone) d.later.push_back(i);
  }
  const auto count = static_cast<std::uint32_t>(d.later.size()) - first;
  d.eliminations.push_back({next, first, count});
  for (std::uint32_t p = first; p < first + count; ++p) {
    const std::uint32_t i = d.later[p];
    --d.neighbours[i];
    for (std::uint32_t q = first; q < p; ++q) {
      const std::uint32_t k = d.later[q];
      if (d.block_of[i * n + k] == 0) continue;
      d.block_of[i * n + k] = d.block_of[k * n + i] = 0;
      ++d.neighbours[i];
      ++d.neighbours[k];
    }
  }
}

void add_row(Direct& d, DirectRow::Kind kind, const Touch& touch, const Vec3& along,
             const Vec3& turn_a, const Vec3& turn_b) {
  DirectRow& row = d.rows.emplace_back();
  row.kind = kind;
  row.a = number_of(d, touch.a);
  row.b = touch.b_moves ? number_of(d, touch.b) : kNone;
  row.ja << along, turn_a;
  row.jb << -along, -turn_b;
}

/// The rows of a touch: what they resist, and their impulses.
template <Other other>
void add_rows_of(const Island& s, Direct& d, double compliance, const Touch& touch,
                 const SolvedTouch& solved, const FrictionRows* f) {
  const State &sa = s.bodies.states[touch.a], &sb = s.bodies.states[touch.b];
  const auto set = [&](double velocity, double c, double impulse, double limit) {
    DirectRow& row = d.rows.back();
    row.velocity = velocity;
    row.compliance = c;
    row.before = impulse;
    row.limit = limit;
  };
  for (std::uint32_t k = 0; k < solved.rows; ++k) {
    const NormalRow& row = s.normals[solved.first_row + k];
    add_row(d, DirectRow::normal, touch, -row.n, -row.ra_n, -row.rb_n);
    set(row.allowed - approach_of<other>(row, sa, sb), compliance / row.mass, row.impulse, 0.0);
  }
  if (!f) return;
  const double load = load_of(s, solved);
  const bool loaded = is_loaded(s, *f, load);
  const double most = loaded ? touch.sliding.limit * load : 0.0;
  const Vec2 slip = slip_of<other>(*f, sa, sb);
  const Vec3 spin = other == Other::still ? sa.w_WB : Vec3(sa.w_WB - sb.w_WB);
  for (std::size_t i = 0; i < 2; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const DirectRow::Kind kind = i == 0 ? DirectRow::pair : DirectRow::second;
    add_row(d, kind, touch, f->t[i], f->a.r_t[i], f->b.r_t[i]);
    set(slip[k], compliance * f->yields, f->impulse[k], most);
    d.rows.back().softness = f->softness.row(k);
  }
  if (f->twist_mass > 0.0) {
    add_row(d, DirectRow::single, touch, Vec3::Zero(), f->n, f->n);
    set(f->n.dot(spin), compliance / f->twist_mass, f->twist, loaded ? most * f->reach : 0.0);
    d.rows.back().softness[0] = f->twist_softness;
  }
  if (f->roll_arm == 0.0) return;
  const auto add_roll = [&](DirectRow::Kind kind, const Vec3& axis) {
    add_row(d, kind, touch, Vec3::Zero(), axis, axis);
    set(axis.dot(spin), compliance / f->roll_mass, f->roll.dot(axis), f->roll_arm * load);
  };
  if (!f->rolls_any) return add_roll(DirectRow::single, f->axis);
  add_roll(DirectRow::pair, f->t[0]);
  add_roll(DirectRow::second, f->t[1]);
}

/// The impulses of two rows with a common limit, and how much they resist along two directions.
void resist(DirectRow& r, DirectRow& q, const Vec2& velocity) {
  Eigen::Matrix2d C;
  C << r.compliance + r.softness[0], r.softness[1], q.softness[0], q.compliance + q.softness[1];
  const Eigen::Matrix2d inverse = C.inverse();
  const Vec2 pull(r.compliance * r.before - velocity[0], q.compliance * q.before - velocity[1]);
  Vec2 x = inverse * pull;
  r.directions = 2;
  if (x.norm() <= r.limit) {  // inverse = L L^T; the directions are the columns of L
    const double l00 = std::sqrt(inverse(0, 0)), l10 = inverse(1, 0) / l00;
    r.direction = Vec2(l00, l10);
    q.direction = Vec2(0.0, std::sqrt(std::max(0.0, inverse(1, 1) - l10 * l10)));
  } else {  // slides: it resists a change across the impulse only
    r.directions = 0;
    x = r.limit > 0.0 ? friction_at_limit(inverse, x, r.limit) : Vec2(Vec2::Zero());
    if (r.limit > 0.0) {
      const Vec2 across = Vec2(-x[1], x[0]) / r.limit;
      const double more = (pull - C * x).dot(x) / (r.limit * r.limit);
      r.directions = 1;
      r.direction = across / std::sqrt(across.dot(C * across) + more);
    }
  }
  r.impulse = x[0];
  q.impulse = x[1];
}

/// Sets all impulses for the velocities after a part of the step.
void resist(std::vector<DirectRow>& rows, double part) {
  for (std::size_t k = 0; k < rows.size(); ++k) {
    DirectRow& r = rows[k];
    const double velocity = r.velocity + part * r.change;
    if (r.kind == DirectRow::pair) {
      DirectRow& q = rows[++k];
      resist(r, q, Vec2(velocity, q.velocity + part * q.change));
      continue;
    }
    const double c = r.compliance + r.softness[0];
    const double free = (r.compliance * r.before - velocity) / c;
    const double least = r.kind == DirectRow::normal ? 0.0 : -r.limit;
    const double most =
        r.kind == DirectRow::normal ? std::numeric_limits<double>::infinity() : r.limit;
    r.impulse = std::clamp(free, least, most);
    r.directions = free > least && free < most ? 1 : 0;
    r.direction = Vec2(1.0 / std::sqrt(c), 0.0);
  }
}

void set_masses(const Island& s, Direct& d) {
  d.masses.resize(d.bodies.size());
  d.changes.assign(d.bodies.size(), Vec6::Zero());
  for (std::size_t i = 0; i < d.bodies.size(); ++i) {
    const Mobility& m = s.bodies.mobility[d.bodies[i]];
    d.masses[i] = {1.0 / m.inv_mass, m.inv_inertia_W.inverse()};
  }
}

Vec6 times(const DirectMass& m, const Vec6& v) {
  Vec6 p;
  p << m.mass * v.head<3>(), m.inertia_W * v.tail<3>();
  return p;
}

/// Adds j j^T to the matrix.
void add_square(Direct& d, const DirectRow& row, const Vec6& ja, const Vec6& jb) {
  block(d, row.a, row.a).noalias() += ja * ja.transpose();
  if (row.b == kNone) return;
  block(d, row.b, row.b).noalias() += jb * jb.transpose();
  if (d.place[row.a] < d.place[row.b]) {
    block(d, row.b, row.a).noalias() += jb * ja.transpose();
  } else {
    block(d, row.a, row.b).noalias() += ja * jb.transpose();
  }
}

/// The matrix and the right side of Newton's method.
void set_equations(Direct& d) {
  std::fill(d.blocks.begin(), d.blocks.end(), Mat6::Zero());
  d.step.resize(d.bodies.size());
  for (std::uint32_t i = 0; i < d.bodies.size(); ++i) {
    Mat6& m = block(d, i, i);
    m.topLeftCorner<3, 3>() = d.masses[i].mass * Mat3::Identity();
    m.bottomRightCorner<3, 3>() = d.masses[i].inertia_W;
    d.step[i] = -times(d.masses[i], d.changes[i]);
  }
  for (std::size_t k = 0; k < d.rows.size(); ++k) {
    const DirectRow& r = d.rows[k];
    const double more = r.impulse - r.before;
    d.step[r.a] += more * r.ja;
    if (r.b != kNone) d.step[r.b] += more * r.jb;
    if (r.kind == DirectRow::second) continue;
    if (r.kind != DirectRow::pair) {
      if (r.directions > 0) add_square(d, r, r.direction[0] * r.ja, r.direction[0] * r.jb);
      continue;
    }
    const DirectRow& q = d.rows[k + 1];
    const auto add = [&](const Vec2& u) {
      add_square(d, r, u[0] * r.ja + u[1] * q.ja, u[0] * r.jb + u[1] * q.jb);
    };
    if (r.directions > 0) add(r.direction);
    if (r.directions > 1) add(q.direction);
  }
}

/// Cholesky factor of a positive definite matrix, in its lower triangle.
void factorise(Mat6& m) {
  for (int j = 0; j < 6; ++j) {
    for (int k = 0; k < j; ++k) {
      for (int i = j; i < 6; ++i) m(i, j) -= m(i, k) * m(j, k);
    }
    const double root = std::sqrt(m(j, j));
    for (int i = j; i < 6; ++i) m(i, j) /= root;
  }
}

/// x becomes L^-1 x.
void solve_lower(const Mat6& L, Vec6& x) {
  for (int j = 0; j < 6; ++j) {
    x[j] /= L(j, j);
    for (int i = j + 1; i < 6; ++i) x[i] -= L(i, j) * x[j];
  }
}

/// m becomes m L^-T.
void divide_by_upper(const Mat6& L, Mat6& m) {
  for (int j = 0; j < 6; ++j) {
    for (int k = 0; k < j; ++k) m.col(j) -= L(j, k) * m.col(k);
    m.col(j) /= L(j, j);
  }
}

/// The right side becomes the solution.
void solve_equations(Direct& d) {
  for (const DirectElimination& e : d.eliminations) {
    const Mat6& L = block(d, e.body, e.body);
    factorise(block(d, e.body, e.body));
    solve_lower(L, d.step[e.body]);
    const std::span<const std::uint32_t> later = std::span(d.later).subspan(e.first, e.count);
    for (std::size_t p = 0; p < later.size(); ++p) {
      const std::uint32_t i = later[p];
      Mat6& m = block(d, i, e.body);
      divide_by_upper(L, m);
      d.step[i].noalias() -= m * d.step[e.body];
      for (std::size_t q = 0; q <= p; ++q) {
        const std::uint32_t k = later[q];
        const bool k_first = d.place[k] < d.place[i];
        const std::uint32_t row = k_first ? i : k, column = k_first ? k : i;
        block(d, row, column).noalias() -=
            block(d, row, e.body) * block(d, column, e.body).transpose();
      }
    }
  }
  for (std::size_t n = d.eliminations.size(); n-- > 0;) {
    const DirectElimination& e = d.eliminations[n];
    Vec6& x = d.step[e.body];
    for (const std::uint32_t i : std::span(d.later).subspan(e.first, e.count)) {
      x.noalias() -= block(d, i, e.body).transpose() * d.step[i];
    }
    const Mat6& L = block(d, e.body, e.body);
    for (int j = 5; j >= 0; --j) {
      for (int i = j + 1; i < 6; ++i) x[j] -= L(i, j) * x[i];
      x[j] /= L(j, j);
    }
  }
}

/// The derivative of the convex function along the step, after a part of it.
double steepness(Direct& d, double part) {
  resist(d.rows, part);
  double sum = 0.0;
  for (std::size_t i = 0; i < d.bodies.size(); ++i) {
    sum += d.step[i].dot(times(d.masses[i], d.changes[i] + part * d.step[i]));
  }
  for (const DirectRow& row : d.rows) sum -= (row.impulse - row.before) * row.change;
  return sum;
}

/// The part of the step after which the convex function is about least.
double part_to_go(Direct& d) {
  const double start = steepness(d, 0.0);
  double part = 1.0, here = steepness(d, part);
  if (here <= -1e-3 * start) return part;
  double low = 0.0, high = 1.0, at_low = start, at_high = here;
  for (int k = 0; k < kSearches && std::abs(here) > -1e-2 * start; ++k) {
    part = low + (high - low) * std::clamp(at_low / (at_low - at_high), 0.1, 0.9);
    here = steepness(d, part);
    (here < 0.0 ? low : high) = part;
    (here < 0.0 ? at_low : at_high) = here;
  }
  return part;
}

/// Sets how the velocities of all rows change by the step. @return the largest change [m/s]
double set_changes(Direct& d) {
  double most = 0.0;
  for (DirectRow& row : d.rows) {
    row.change = row.ja.dot(d.step[row.a]);
    if (row.b != kNone) row.change += row.jb.dot(d.step[row.b]);
    most = std::max(most, std::abs(row.change));
  }
  return most;
}

/// Applies the impulses that were found.
template <Other other>
void apply(const Island& s, const DirectRow*& row, const Touch& touch, const SolvedTouch& solved,
           FrictionRows* f) {
  for (std::uint32_t k = 0; k < solved.rows; ++k) {
    NormalRow& normal = s.normals[solved.first_row + k];
    const double impulse = (row++)->impulse;
    push_by<other>(s.bodies, touch, normal, impulse - normal.impulse);
    normal.impulse = impulse;
  }
  if (!f) return;
  f->releases = 0;
  f->carries = is_loaded(s, *f, load_of(s, solved));
  const Vec2 F(row[0].impulse, row[1].impulse);
  row += 2;
  push_along<other>(s.bodies, touch, *f, F - f->impulse);
  f->impulse = F;
  if (f->twist_mass > 0.0) {
    const double twist = (row++)->impulse;
    twist_by<other>(s.bodies, touch, *f, twist - f->twist);
    f->twist = twist;
  }
  if (f->roll_arm == 0.0) return;
  Vec3 roll;
  if (f->rolls_any) {
    roll = row[0].impulse * f->t[0] + row[1].impulse * f->t[1];
    row += 2;
  } else {
    roll = (row++)->impulse * f->axis;
  }
  roll_by<other>(s.bodies, touch, roll - f->roll);
  f->roll = roll;
}

double most_products(const Island& s, std::size_t bodies) {
  if (!speeds_up_first(s.world.parameters)) return kMostProducts;
  return std::clamp(kMostOfABody * static_cast<double>(bodies), kFewProducts, kMostProducts);
}

}  // namespace

bool plan_direct(const Island& s, Direct& d) {
  list_bodies(s, d.bodies);
  const std::size_t n = d.bodies.size();
  const double most = most_products(s, n);
  // All but the last have a neighbour that is eliminated later.
  if (static_cast<double>(n - 1) * (kOwn + kNeighbour + kTwo) > most) return false;
  mark_neighbours(s, d);
  d.place.assign(n, kNone);
  d.eliminations.clear();
  d.later.clear();
  double products = 0.0;
  for (std::size_t k = 0; k < n && products <= most; ++k) {
    eliminate_next(d);
    const double count = d.eliminations.back().count;
    products += kOwn + kNeighbour * count + 0.5 * kTwo * count * (count + 1.0);
  }
  if (products > most) return false;
  std::uint32_t blocks = 0;
  for (const DirectElimination& e : d.eliminations) {
    d.block_of[e.body * n + e.body] = blocks++;
    for (std::uint32_t p = e.first; p < e.first + e.count; ++p) {
      d.block_of[d.later[p] * n + e.body] = blocks++;
    }
  }
  d.blocks.resize(blocks);
  return true;
}

int solve_directly(const Island& s, Direct& d, double compliance, double residual) {
  d.rows.clear();
  each_touch(s, [&](const Touch& touch, const SolvedTouch& solved, const FrictionRows* f) {
    with_other(touch, [&]<Other other> { add_rows_of<other>(s, d, compliance, touch, solved, f); });
  });
  set_masses(s, d);
  resist(d.rows, 0.0);
  for (int k = 1; k <= kNewtonSteps; ++k) {
    set_equations(d);
    solve_equations(d);
    if (set_changes(d) <= compliance * residual) {  // an error of v is one of x over the compliance
      const DirectRow* row = d.rows.data();
      each_touch(s, [&](const Touch& touch, const SolvedTouch& solved, FrictionRows* f) {
        with_other(touch, [&]<Other other> { apply<other>(s, row, touch, solved, f); });
      });
      return k;
    }
    const double part = part_to_go(d);
    for (std::size_t i = 0; i < d.bodies.size(); ++i) d.changes[i] += part * d.step[i];
    for (DirectRow& row : d.rows) {
      row.velocity += part * row.change;
      row.change = 0.0;
    }
    resist(d.rows, 0.0);
  }
  return 0;
}

}  // namespace headpin::engine::detail
