#pragma once

#include <cmath>

#include "engine/rules.h"
#include "engine/sustained_rows.h"

/// Operations on all impulses of an island, and passes that are accelerated. Private to the engine.
namespace headpin::engine::detail {

/// Calls f.template operator()<other>(), where `other` is the kind of body B of the touch.
template <typename F>
decltype(auto) with_other(const Touch& touch, F&& f) {
  switch (other_of(touch)) {
    case Other::still:
      return f.template operator()<Other::still>();
    case Other::driven:
      return f.template operator()<Other::driven>();
    default:
      return f.template operator()<Other::moving>();
  }
}

/// Calls f(impulse, velocity change per unit impulse, function that adds to the impulse) for all
/// impulses of an island.
template <typename F>
void each_impulse(const Island& s, F&& f) {
  std::vector<FrictionRows>& friction = s.rows.friction;
  std::size_t at = 0;
  for (const std::uint32_t k : s.each) {
    const Touch& touch = s.touches[k];
    const SolvedTouch& solved = s.solved[k];
    if (solved.rows == 0) continue;
    for (std::uint32_t n = 0; n < solved.rows; ++n) {
      NormalRow& row = s.normals[solved.first_row + n];
      f(row.impulse, 1.0 / row.mass, [&](double more) {
        more = std::max(more, -row.impulse);
        row.impulse += more;
        with_other(touch, [&]<Other other> { push_by<other>(s.bodies, touch, row, more); });
      });
    }
    if (at == friction.size() || friction[at].touch != k) continue;
    FrictionRows& rows = friction[at++];
    for (int n = 0; n < 2; ++n) {
      f(rows.impulse[n], rows.yields, [&](double more) {
        rows.impulse[n] += more;
        with_other(touch, [&]<Other other> {
          push_along<other>(s.bodies, touch, rows, more * Vec2::Unit(n));
        });
      });
    }
    if (rows.twist_mass > 0.0) {
      f(rows.twist, 1.0 / rows.twist_mass, [&](double more) {
        rows.twist += more;
        with_other(touch, [&]<Other other> { twist_by<other>(s.bodies, touch, rows, more); });
      });
    }
    if (rows.roll_arm == 0.0) continue;
    for (int n = 0; n < 3; ++n) {
      f(rows.roll[n], 1.0 / rows.roll_mass, [&](double more) {
        rows.roll[n] += more;
        with_other(touch,
                   [&]<Other other> { roll_by<other>(s.bodies, touch, more * Vec3::Unit(n)); });
      });
    }
  }
}

/// Accelerates the passes of an island; each pass serves as a gradient. Plain passes carry a change of load up a
/// stack by one body each; accelerated passes carry it faster. Nesterov's method: the next pass begins beyond where
/// the last one came to, in the direction in which they came there from the one before. It starts again where a pass
/// leads back (O'Donoghue and Candes 2015, gradient scheme). Older rules use conjugate gradients (Silcowitz-Hansen,
/// Niebe and Erleben 2010).
class Acceleration {
 public:
  explicit Acceleration(const Island& island)
      : island_(island), s_(island.rows), conjugate_(!speeds_up_first(island.world.parameters)) {}

  void before_pass() {
    s_.before.clear();
    each_impulse(island_, [&](double& impulse, double, auto&&) { s_.before.push_back(impulse); });
    if (s_.along.size() < s_.before.size()) s_.along.resize(s_.before.size());
  }

  void after_pass() {
    conjugate_ ? follow_conjugate() : go_beyond();
    begun_ = true;
  }

 private:
  /// `along` are the impulses after the last pass.
  void go_beyond() {
    double onward = 0.0;  // how far this pass leads on from the last one [J]
    std::size_t n = 0;
    each_impulse(island_, [&](double& impulse, double yields, auto&&) {
      if (begun_) onward += (impulse - s_.before[n]) * (impulse - s_.along[n]) * yields;
      ++n;
    });
    const double was = begun_ && onward >= 0.0 ? inertia_ : 1.0;
    inertia_ = 0.5 * (1.0 + std::sqrt(1.0 + 4.0 * was * was));
    const double keep = (was - 1.0) / inertia_;
    n = 0;
    each_impulse(island_, [&](double& impulse, double, auto&& apply) {
      const double more = keep > 0.0 ? keep * (impulse - s_.along[n]) : 0.0;
      s_.along[n++] = impulse;
      if (more != 0.0) apply(more);
    });
  }

  /// `along` is the search direction.
  void follow_conjugate() {
    double now = 0.0;
    std::size_t n = 0;
    each_impulse(island_, [&](double& impulse, double yields, auto&&) {
      const double more = impulse - s_.before[n++];
      now += more * more * yields;
    });
    const double keep = last_ > 0.0 && now < last_ ? now / last_ : 0.0;
    last_ = now;
    n = 0;
    each_impulse(island_, [&](double& impulse, double, auto&& apply) {
      const double more = keep > 0.0 ? keep * s_.along[n] : 0.0;
      s_.along[n] = more + impulse - s_.before[n];
      ++n;
      if (more != 0.0) apply(more);
    });
  }

  const Island& island_;
  Rows& s_;
  bool conjugate_;
  bool begun_ = false;
  double last_ = 0.0, inertia_ = 1.0;
};

}  // namespace headpin::engine::detail
