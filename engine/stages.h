#pragma once

#include <optional>

#include "engine/world.h"

/// The stages of a step, for world.cpp; users call `step`.
namespace headpin::engine::detail {

/// Gap up to which one body lies on another [m].
inline constexpr double kRests = 1e-4;

/// Turn within a step after which the points of a contact are others [rad].
inline constexpr double kFarTurn = 0.2;

/// Pairs whose bounds meet, the bounds widened by how far a body comes within the step.
void find_pairs(World& world);

/// Contact points of those pairs. A sleeping body that something moving touches is woken.
///
/// @return  whether any body was woken: pairs and contacts must then be found again
bool find_contacts(World& world);

/// Impulses where bodies meet within the step, one after the other as they happen, until no pair
/// approaches. A body that is struck is brought to where that happens; `Scratch::clock` says when.
///
/// @return  whether a sleeping body was hit: it is awake now, and the step must be started over
bool resolve_impacts(World& world);

/// Lasting contacts: elasticity 0, impulses accumulated and clamped, island by island.
void sustain_contacts(World& world);

/// What turns far within a step may swing deep into what it lies on, by points that were not near
/// when its contacts were found: those are stopped, without elasticity.
void stop_swings(World& world);

/// Contact points of a touch, from its A, where its bodies are at the end of the step: valid until
/// asked for again.
std::span<const ContactPoint> points_at_end(World& world, const Touch& touch, const Pose& X_WA,
                                            const Pose& X_WB);

/// What an impulse at a point does, the centres of mass being there.
NormalRow row_at(const World& world, const Touch& touch, const ContactPoint& point,
                 const Vec3& p_WA, const Vec3& p_WB);

/// Where a body will be at the end of the step, as it moves now.
Pose pose_at_end(const World& world, BodyId i);

/// Along the paths to the end of the step: exact for free bodies, by the end velocity for carried.
void move(World& world);

/// Takes overlaps back without adding speed.
void push_apart(World& world);

/// Islands that have been still for long enough are left out from now on.
void fall_asleep(World& world);

/// Free and awake: forces move it.
inline bool is_mover(const World& world, BodyId i) {
  return world.bodies[i].kind == Kind::free && world.asleep[i] == 0;
}

/// A body at time `t` of the step, on the path it now has: exact where nothing touches it.
State state_at(const World& world, BodyId i, double t);

/// What gravity does to the velocity of a body on its way to the next impact [m/s^2].
inline Vec3 pull_on(const World& world, BodyId i) {
  return world.scratch.falls[i] ? world.parameters.gravity_W : Vec3::Zero();
}
inline Vec3 position_at(const World& world, BodyId i, double t) {
  const State& s = world.states[i];
  const double passed = t - world.scratch.clock[i];
  if (passed == 0.0) return s.X_WB.p;
  return s.X_WB.p + passed * s.v_WB + 0.5 * passed * passed * pull_on(world, i);
}

/// Notes bounds on how fast the body's points move, now.
inline void note_speed(World& world, BodyId i) {
  const State& s = world.states[i];
  world.scratch.swing[i] = s.w_WB.norm() * world.bodies[i].shape->bounding_radius;
  world.scratch.top_speed[i] = s.v_WB.norm() + world.scratch.swing[i];
}

/// Energy of motion of a body, per mass [m^2/s^2].
inline double energy_per_mass(const World& world, BodyId i, const State& s) {
  return 0.5 * s.v_WB.squaredNorm() +
         turning_energy(world.inertias[i], s.X_WB.q, s.w_WB) / world.bodies[i].mass;
}
/// The same of a hoop that rolls at a speed: nothing that rolls or is thrown turns with more.
inline double hoop_energy(double speed) {
  return speed * speed;
}

/// Overlap that is deep for two bodies: a fiftieth of the smaller one [m].
inline double deep_for(const World& world, BodyId a, BodyId b) {
  return 0.02 *
         std::min(world.bodies[a].shape->bounding_radius, world.bodies[b].shape->bounding_radius);
}

/// What approaches faster is followed to where it meets within the step: impacts, and lasting
/// contacts that would go deep before the step's end.
inline double followed_speed(const World& world, BodyId a, BodyId b) {
  return std::min(world.scratch.lasting_speed, deep_for(world, a, b) * world.parameters.rate_hz);
}

/// How far two bodies may be apart and yet meet within the step, as they move now [m]. What an
/// impact within the step makes of it is seen in the next one.
double reach(const World& world, BodyId a, BodyId b);

/// Key of a pair: half-spaces first, then bounded bodies; by the smaller, then the larger number.
inline std::uint64_t key_of(bool both_bounded, BodyId a, BodyId b) {
  return std::uint64_t{both_bounded} << 63 | std::uint64_t{a} << 32 | b;
}

/// Whether a body is one of the two.
inline bool concerns(std::uint64_t key, BodyId body) {
  return (key >> 32 & 0x7fff'ffffu) == body || (key & 0xffff'ffffu) == body;
}

/// Looks for contact points of a candidate at time `t` of the step; appends the touch if there are
/// any.
bool add_touch(World& world, std::uint32_t candidate, double t);

/// Appends contact points of two posed bodies, with the normals kept for them.
int contacts_of(World& world, const Candidate& c, const Pose& X_WA, const Pose& X_WB,
                double margin);

/// Makes the touch's normals point from its A, which may be the candidate's B.
void turn_normals(Scratch& s, const Touch& touch);

/// Follows both paths within the step to where the surfaces meet faster than `threshold`.
///
/// At the start of the step they may be centimetres apart, and the normal some degrees off.
/// @param touch  with points of the start of the step; gets those of the meeting
/// @return       null when they pass each other, or meet more slowly or later
struct Meeting {
  ContactPoint point;
  double time = 0.0;      ///< from the start of the step [s]
  double approach = 0.0;  ///< [m/s]
};
std::optional<Meeting> find_meeting(World& world, Touch& touch, double threshold);

/// Tells which of the step's events are the first between two bodies; drops lasting touches of
/// bodies that had met before.
void note_meetings(World& world);

/// Whether the touch carried anything in the last step.
bool was_loaded(const Scratch& s, const Touch& touch);

/// Representative of a body's island: the smallest number in it.
BodyId island_root(std::vector<BodyId>& parent, BodyId i);

inline Vec3 velocity_at(const State& s, const Vec3& r_W) {
  return s.v_WB + s.w_WB.cross(r_W);
}

}  // namespace headpin::engine::detail
