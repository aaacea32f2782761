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
    if (!done.solved) return true;
    double most = most_, most_energy = most_energy_;
    if (const Parameters& p = s_.world.parameters; knows_carried(p)) {
      const double error = 10.0 * p.solver_residual + 2.0 * done.worst;  // of passes
      most += error;
      most_energy = hoop_energy(std::sqrt(most_energy_) + error);
    }
    for (const auto& [i, before] : pressed_) {
      const State& now = s_.world.states[i];
      if (now.v_WB.norm() > most) return true;
      if (energy_per_mass(s_.world, i, now) > most_energy) return true;
    }
    return false;
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
      most_ = std::max(most_, throws_at(world, s_.points, touch));
      most_energy_ = hoop_energy(most_);
    }
    if (knows_carried(world.parameters) && is_carried()) pressing_.clear();
    if (pressing_.empty()) return;
    for (const std::uint32_t k : s_.each) {
      const Touch& touch = s_.touches[k];
      note(touch.a);
      if (touch.b_moves) note(touch.b);
    }
  }

  /// Whether one driven body alone holds the island. There is a solution then, as the island may move with that body as
  /// if they were one; and contacts give no energy relative to it.
  bool is_carried() const {
    if (pressing_.empty()) return false;
    const BodyId driven = pressing_.front().first;
    return std::ranges::all_of(s_.each, [&](std::uint32_t k) {
      const Touch& touch = s_.touches[k];
      return touch.points == 0 || touch.b_moves || touch.b == driven;
    });
  }

  void note(BodyId i) {
    const State& state = s_.world.states[i];
    pressed_.emplace_back(i, state);
    most_ = std::max(most_, state.v_WB.norm());
    most_energy_ = std::max(most_energy_, energy_per_mass(s_.world, i, state));
  }

  const Island& s_;
  std::vector<std::pair<BodyId, State>>&pressed_, &pressing_;
  double most_ = 0.0, most_energy_ = 0.0;
};

}  // namespace headpin::engine::detail
