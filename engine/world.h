#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "engine/body.h"
#include "engine/broad_phase.h"
#include "engine/contacts.h"
#include "engine/free_motion.h"
#include "engine/ledger.h"
#include "engine/memory.h"
#include "engine/response.h"

/// Rigid bodies that stand, roll, fall and collide, simulated at a fixed rate with reproducible bits.
///
///     World world = make_world({.rate_hz = 240});
///     const BodyId lane = add_body(world, {.name = "lane", .shape = floor, .kind = Kind::fixed});
///     const BodyId ball = add_body(world, ball_body, {.X_WB = X_WB, .v_WB = {0, 6, 0}});
///     Workspace workspace;  // engine/workspace.h
///     while (world.tick < 5 * 240) step(world, workspace);
///
/// `World` has the state and what the next step needs from the last one. `Workspace` has buffers.
///
/// Between steps, all poses and velocities are those of `tick`. Within a step, impacts come first:
/// bodies that approach fast are moved along their paths to the time of impact and get their
/// impulses there, in order of time. A body that was struck is then at the time of its last impact,
/// all others are still at the start of the step. Then lasting contacts are solved: the solver
/// finds the velocities at the end of the step. At last, every body moves to the end of the step.
namespace headpin::engine {

inline constexpr int kMostThreads = 256;  ///< that share a step

struct Parameters {
  int rate_hz = 240;                    ///< steps a second
  Vec3 gravity_W{0.0, 0.0, -9.81};      ///< [m/s^2]
  std::string_view response = "paper";  ///< name of one of `responses()`
  Query query = {};                     ///< how collisions are detected; the step sets its margin
  double friction_tau = 1.0 / 60.0;  ///< time in which a lasting contact applies its rate once [s]
  double impact_speed = 0.15;        ///< slower approaches are solved as lasting contacts [m/s]
  int impacts = 64;                  ///< most impacts of one body within a step
  int solver_iterations = 200;       ///< most passes over the lasting contacts of an island; if
                                     ///< not solved then, up to four times as many more with softer
                                     ///< friction
  double solver_residual = 1e-6;     ///< solved when no velocity changes by more in a pass [m/s];
                                     ///< for crowds a part of what gravity and contacts add
  double slop = 5e-5;                ///< overlap that is not corrected [m]
  double push = 0.2;          ///< part of the remaining overlap that is corrected each 1/240 s
  bool sleep = true;          ///< islands at rest sleep until a moving body touches them
  double sleep_speed = 0.01;  ///< [m/s]
  double sleep_spin = 0.03;   ///< [rad/s]
  double sleep_after = 0.25;  ///< [s]
  int rules = 17;             ///< 1 to 16 are those of older trials; what they lack is in rules.h
  bool keep_ledger = false;   ///< `World::ledger`; costs about a tenth of a step
  int threads = 1;            ///< that share a step of many bodies, 1 to kMostThreads; the bits are
                              ///< the same. They belong to the workspace: step() without one makes
                              ///< them in each step
};

/// Statistics of one step, or sums over many steps (largest values: the largest of all).
struct Statistics {
  std::int64_t steps = 0;
  std::int64_t pairs = 0;               ///< pairs of bodies whose bounds met
  std::int64_t contacts = 0;            ///< contact points
  QueryCounts queries;                  ///< queries between parts of bodies
  std::int64_t impacts = 0;             ///< impulses given
  std::int64_t unfinished_impacts = 0;  ///< steps in which a body reached the limit of impacts
  std::int64_t pulls = 0;               ///< attracting impulses, which were replaced by F00
  std::int64_t islands = 0;
  std::int64_t solver_iterations = 0;
  std::int64_t unsolved = 0;     ///< islands stopped by their number of passes
  double residual = 0.0;         ///< largest change of a velocity in a last pass [m/s]
  double deepest_overlap = 0.0;  ///< [m]
  std::int64_t awake = 0;        ///< free bodies awake at the end of the step

  Statistics& operator+=(const Statistics& other);
};

/// Two bodies met: an impact, or the first touch of two bodies that had not met before.
struct ContactEvent {
  BodyId a = 0, b = 0;
  Vec3 p_W = Vec3::Zero();
  Vec3 n_AB_W = Vec3::UnitZ();
  Vec3 impulse_W = Vec3::Zero();  ///< on A [N s]
  double approach_speed = 0.0;    ///< [m/s]
  bool first = false;             ///< these two had not met before
};

namespace detail {

/// The surface of a half-space: normal, unit, out of the solid, and height over the origin along it.
struct Plane {
  Vec3 up;
  double height;  ///< [m]; infinite for a body of more parts, which then is never out of reach
};

/// The bodies that take part in a step, from their kinds, shapes and sleep; made when not `made`.
struct Roll {
  bool made = false;
  std::vector<BodyId> movers, driven;      ///< free and awake; driven
  std::vector<BodyId> unbounded, bounded;  ///< fixed half-spaces; all others
  std::vector<Capsule> bounds_W;           ///< of `bounded`: valid for bodies that do not move
  std::vector<std::uint8_t> moving;        ///< of `bounded`: free and awake, or driven
  std::vector<Box> limits_W;    ///< of `bounded`, for the broad phase; empty under older rules
  std::vector<Plane> planes_W;  ///< of `unbounded`
};

/// Part of an edge of a face of a fixed polyhedron, behind which another fixed part goes on in the plane
/// of the face.
struct Seam {
  BodyId body;
  std::uint32_t part;
  Vec3 up_W;  ///< normal of the face, unit, outward
  double height;
  Vec3 out_W;  ///< in the plane of the face, out of it, unit
  double side;
  Vec3 along_W;     ///< along the edge, unit
  double from, to;  ///< [m]
};

/// The seams of all fixed bodies, by body and part; found when not `made`.
struct Seams {
  bool made = false;
  std::vector<Seam> all;
};

}  // namespace detail

/// Plain data: a copy continues with the same bits as the original. Between steps, change it only
/// with the functions below.
struct World {
  Parameters parameters;
  std::int64_t tick = 0;
  std::vector<Body> bodies;
  std::vector<State> states;         ///< of the bodies, same numbers
  std::vector<std::uint8_t> asleep;  ///< 1 where a free body sleeps
  Ledger ledger;                     ///< since the start, when kept
  Memory memory;                     ///< what the next step starts from

  std::vector<ContactEvent> events;  ///< of the last step, in the order they happened
  Statistics statistics;             ///< of the last step

  // Derived from the above.
  const Response* response = nullptr;
  std::vector<Inertia> inertias;
  detail::Roll roll;
  detail::Seams seams;
};

/// Buffers of a step (engine/workspace.h).
struct Workspace;

/// A type that depends on the layouts of the types. A program that was compiled with other layouts
/// does not link with make_world(). Flags like -D_GLIBCXX_DEBUG change the layouts.
template <std::size_t... layout>
struct CompiledWithTheFlagsOf_pkg_config_cflags_headpin_engine {};
using SameLayout = CompiledWithTheFlagsOf_pkg_config_cflags_headpin_engine<
    sizeof(World), alignof(World), sizeof(Body), sizeof(State), sizeof(Compound), sizeof(Shape),
    sizeof(Memory), sizeof(Ledger), sizeof(ContactEvent)>;

/// An empty world.
///
/// @throws std::invalid_argument  naming the parameter, its value and the allowed range
World make_world(const Parameters& parameters, SameLayout = {});

/// @return  the number of the body, from 0
/// @throws std::invalid_argument  naming the body and the invalid value: mass or inertia not
///   finite and positive, coefficient outside 0 to 1, pose or velocity not finite, half-space that
///   is not fixed, fixed body with a velocity
BodyId add_body(World& world, Body body, const State& state = {});

/// Sets pose and velocity of a body. It wakes up, with its island and with bodies that rest on it.
///
/// @throws std::invalid_argument  for an unknown or fixed body, or a state that is not finite
void set_state(World& world, BodyId body, const State& state);

/// The reachable state that is nearest to a wanted one: outside of all fixed bodies and without
/// velocity into them. It changes nothing; pass the result to `set_state`.
///
/// The body moves straight from its current position towards the wanted one, with the wanted
/// orientation, and slides along fixed bodies.
/// @throws std::invalid_argument  for an unknown body or a state that is not finite
State outside_fixed(const World& world, BodyId body, const State& wanted);

/// Makes a free body driven or a driven body free; its state stays the same.
///
/// @throws std::invalid_argument  for an unknown body, or if one of the kinds is `fixed`
void set_kind(World& world, BodyId body, Kind kind);

void wake(World& world, BodyId body);
/// Puts a free body to sleep until a moving body touches it.
void put_to_sleep(World& world, BodyId body);
inline bool is_asleep(const World& world, BodyId body) {
  return world.asleep[body] != 0;
}

/// Gives the world a law of response of one's own, from the next step on, also where bodies touch by now. `parameters.response` then
/// has its name; a saved world can be restored only into worlds with a law of that name.
///
/// @param response  must outlive the world and its copies
void set_response(World& world, const Response& response);

/// Forgets which bodies a body has met: its next touch with each is the first one again.
///
/// @throws std::invalid_argument  for an unknown body
void forget_meetings(World& world, BodyId body);

/// Gives a fixed body another table of friction, from the next step on; none removes it.
///
/// @throws std::invalid_argument  for an unknown or a movable body, and for a table that is none
void set_friction(World& world, BodyId body, std::shared_ptr<const FrictionTable> table);

/// Copies states, kinds, sleep, meetings, tick and ledger from another world with the same bodies,
/// which may have other shapes, masses and materials. Impulses and normals for the warm start are
/// not copied, because they belong to the other shapes.
/// @throws std::invalid_argument  for another number of bodies
void take_over(World& world, const World& from);

/// One step of 1 / rate_hz.
///
/// @param workspace  buffers; reuse one to save allocations, its content has no effect
/// @throws std::runtime_error  when a state becomes non-finite, naming tick and body
void step(World& world, Workspace& workspace);
void step(World& world);

/// Appends the contact points of two bodies, not both fixed, where they are now, as a step finds them:
/// unlike find_contacts(), none at an edge where flat faces of fixed parts join to one.
///
/// @param margin  points with a gap up to this are included, with negative depth [m]
/// @throws std::invalid_argument  for an unknown body
void contacts_now(World& world, BodyId a, BodyId b, double margin, std::vector<ContactPoint>& out);

/// Energy, momentum and angular momentum of the free bodies; height is from the origin of W.
Balance balance(const World& world);
/// The part of one free body.
Balance balance_of(const World& world, BodyId body);

/// FNV-1a hash (64 bits) of tick, poses, velocities and sleep flags. Equal runs have equal hashes.
/// `World::memory` is not included; if it differs, the hashes of the next steps differ.
std::uint64_t state_hash(const World& world);

inline double step_seconds(const World& world) {
  return 1.0 / world.parameters.rate_hz;
}

}  // namespace headpin::engine
