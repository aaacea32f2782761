#pragma once

#include "engine/passes.h"
#include "engine/rules.h"
#include "engine/sustained_rows.h"

/// Islands that have no solution because driven bodies press them. Private to the engine.
namespace headpin::engine::detail {

/// Speed that a driven body gives to a body that it throws: its own speed at the contact points of
/// a touch, times 1 + elasticity [m/s].
inline double throws_at(const World& world, const ContactPoint* points, const Touch& touch) {
  const State& driven = world.states[touch.b];
  double fastest = 0.0;
  for (std::uint32_t k = 0; k < touch.points; ++k) {
    const Vec3& p_W = points[touch.first_point + k].p_W;
    fastest = std::max(fastest, velocity_at(driven, p_W - driven.X_WB.p).norm());
  }
  return (1.0 + touch.pair.elasticity) * fastest;
}

/// The largest speed and energy per mass of some bodies.
struct Fastest {
  double speed = 0.0, energy = 0.0;

  void note(const World& world, BodyId i, const State& state) {
    speed = std::max(speed, state.v_WB.norm());
    energy = std::max(energy, energy_per_mass(world, i, state));
  }
  /// Whether a body has more.
  /// @param error  of its speed, where passes end before they are exact [m/s]
  bool is_exceeded(const World& world, BodyId i, const State& state, double error) const {
    if (state.v_WB.norm() > speed + error) return true;
    const double most = error > 0.0 ? hoop_energy(std::sqrt(energy) + error) : energy;
    return energy_per_mass(world, i, state) > most;
  }
};

/// An island that driven bodies press. It may have no solution, because the driven bodies do not
/// stop and something behind the island cannot give way.
class Squeeze {
 public:
  /// Stores the states of the island before it is solved, if a moving driven body touches it.
  explicit Squeeze(const Island& island)
      : s_(island), pressed_(island.rows.pressed), pressing_(island.rows.pressing) {
    pressed_.clear();
    pressing_.clear();
    if (!s_.world.roll.driven.empty() && bounds_squeezes(s_.world.parameters)) note_pressing();
  }

  /// Whether there is no solution, or a body gets more speed or energy than a throw would give it.
  bool is_found(const Passes& done) const {
    if (pressing_.empty()) return false;
    if (!done.solved && !carried_) return true;
    const World& world = s_.world;
    const double error = error_of(done);
    return std::ranges::any_of(pressed_, [&](const auto& pressed) {
      const BodyId i = pressed.first;
      const State& now = world.states[i];
      if (!most_.is_exceeded(world, i, now, error)) return false;
      return !carried_ || most_beside_.is_exceeded(world, i, beside_driven(now), error);
    });
  }

  /// Undoes the impulses, and stops the driven bodies until the island is solved again. They then
  /// stop other bodies but give them no speed. Their overlap grows.
  void yield() {
    for (const auto& [i, before] : pressed_) s_.world.states[i] = before;
    for (NormalRow& row : s_.normals) row.impulse = 0.0;
    for (FrictionRows& f : s_.rows.friction) {
      f.impulse = Vec2::Zero();
      f.twist = 0.0;
      f.roll = Vec3::Zero();
      f.releases = 0;
    }
    for (const auto& [i, state] : pressing_) {
      s_.world.states[i].v_WB = s_.world.states[i].w_WB = Vec3::Zero();
    }
  }
  void insist() {
    for (const auto& [i, state] : pressing_) s_.world.states[i] = state;
    for (const std::uint32_t k : s_.each) {
      const Touch& touch = s_.touches[k];
      const bool moves = s_.flight.bodies[touch.b].top_speed > 0.0;
      if (moves && !touch.b_moves) s_.solved[k].insists = true;
    }
  }

 private:
  void note_pressing() {
    const World& world = s_.world;
    for (const std::uint32_t k : s_.each) {
      const Touch& touch = s_.touches[k];
      if (touch.points == 0 || !touch.b_driven) continue;
      if (s_.flight.bodies[touch.b].top_speed == 0.0) continue;
      pressing_.emplace_back(touch.b, world.states[touch.b]);
      most_.speed = std::max(most_.speed, throws_at(world, s_.points, touch));
      most_.energy = hoop_energy(most_.speed);
    }
    carried_ = knows_carried(world.parameters) && is_carried();
    if (pressing_.empty()) return;
    for (const std::uint32_t k : s_.each) {
      const Touch& touch = s_.touches[k];
      note(touch.a);
      if (touch.b_moves) note(touch.b);
    }
  }

  /// Whether one driven body alone holds the island. There is a solution then, as the island may move with that body as
  /// if they were one; and beside that body, contacts give no energy to the island as a whole.
  bool is_carried() const {
    if (pressing_.empty()) return false;
    const BodyId driven = pressing_.front().first;
    return std::ranges::all_of(s_.each, [&](std::uint32_t k) {
      const Touch& touch = s_.touches[k];
      return touch.points == 0 || touch.b_moves || touch.b == driven;
    });
  }

  /// A state as it is seen from the driven body.
  State beside_driven(State state) const {
    const State& driven = pressing_.front().second;
    state.v_WB -= velocity_at(driven, state.X_WB.p - driven.X_WB.p);
    state.w_WB -= driven.w_WB;
    return state;
  }

  /// How much too fast a body may be because passes end before they are exact [m/s].
  double error_of(const Passes& done) const {
    const Parameters& p = s_.world.parameters;
    if (!knows_carried(p)) return 0.0;
    const double falls = p.gravity_W.norm() * step_seconds(s_.world);
    return 10.0 * p.solver_residual + 2.0 * std::min(done.worst, 1e-2 * falls);
  }

  void note(BodyId i) {
    const State& state = s_.world.states[i];
    pressed_.emplace_back(i, state);
    most_.note(s_.world, i, state);
    if (!carried_) return;
    most_beside_.note(s_.world, i, beside_driven(state));
    most_beside_.energy = std::max(most_beside_.energy, hoop_energy(most_beside_.speed));
  }

  const Island& s_;
  std::vector<std::pair<BodyId, State>>&pressed_, &pressing_;
  Fastest most_;  ///< before the step, or by a throw
  bool carried_ = false;
  Fastest most_beside_;  ///< before the step, beside the driven body that carries the island
};

}  // namespace headpin::engine::detail
