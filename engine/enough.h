#pragma once

#include <algorithm>
#include <cmath>

#include "engine/rules.h"
#include "engine/sustained_rows.h"

/// How well an island must be solved that passes do not solve to the usual residual. Private to the engine.
namespace headpin::engine::detail {

/// What is left is solved when no velocity changes by more than this part of what gravity adds in a
/// step: an island that direct solutions did not solve better, and a crowd, which has none.
inline constexpr double kNearly = 5e-4, kCrowd = 1e-2;
/// For a crowd, plus this part of what its contacts change beyond what gravity adds.
inline constexpr double kOfMore = 2.5e-2;

/// A crowd of bodies slower than this [m/s] is to stand, and is then solved to this part of what gravity adds, if passes
/// come so far. Where they converge slowly, the error is many times what the last pass changed.
inline constexpr double kSlowCrowd = 0.1, kOfSlow = 2e-3;

/// How much contacts change the velocities of an island's bodies, root of the mean square [m/s].
inline double change_by_contacts(const Island& s) {
  std::vector<BodyId>& bodies = s.rows.bodies;
  std::vector<Vec3>& pushed = s.rows.pushed;
  list_bodies(s, bodies);
  pushed.resize(s.world.bodies.size());
  for (const BodyId i : bodies) pushed[i] = Vec3::Zero();
  const auto push = [&](const Touch& touch, const Vec3& F) {
    pushed[touch.a] += s.bodies.mobility[touch.a].inv_mass * F;
    if (touch.b_moves) pushed[touch.b] -= s.bodies.mobility[touch.b].inv_mass * F;
  };
  for (const std::uint32_t k : s.each) {
    const SolvedTouch& solved = s.solved[k];
    for (std::uint32_t n = 0; n < solved.rows; ++n) {
      const NormalRow& row = s.normals[solved.first_row + n];
      push(s.touches[k], -row.impulse * row.n);
    }
  }
  for (const FrictionRows& f : s.rows.friction) {
    push(s.touches[f.touch], f.impulse[0] * f.t[0] + f.impulse[1] * f.t[1]);
  }
  double sum = 0.0;
  for (const BodyId i : bodies) sum += pushed[i].squaredNorm();
  return std::sqrt(sum / static_cast<double>(bodies.size()));
}

/// Whether all bodies are slow, with their turning about their centres.
inline bool is_slow(const Island& s, const std::vector<BodyId>& bodies) {
  return std::ranges::all_of(bodies, [&](BodyId i) {
    const State& state = s.world.states[i];
    const double turning = state.w_WB.norm() * s.world.bodies[i].shape->bounding_radius;
    return state.v_WB.norm() + turning <= kSlowCrowd;
  });
}

/// The same as `enough_for` for a slow crowd [m/s].
inline double enough_to_stand(const World& world) {
  const Parameters& p = world.parameters;
  return std::max(p.solver_residual, kOfSlow * p.gravity_W.norm() * step_seconds(world));
}

/// The change of a velocity in a pass at which what is left is solved [m/s].
///
/// @param planned  the island has been solved directly, but not as well as it should be
inline double enough_for(const Island& s, bool planned) {
  const Parameters& p = s.world.parameters;
  const double falls = p.gravity_W.norm() * step_seconds(s.world);
  if (planned) return std::max(p.solver_residual, kNearly * falls);
  if (!speeds_up_first(p)) return std::max(p.solver_residual, kCrowd * falls);
  const double more = std::max(0.0, change_by_contacts(s) - falls);
  return std::max(p.solver_residual, kCrowd * falls + kOfMore * more);
}

}  // namespace headpin::engine::detail
