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

/// Bodies that stand, roll, fall and collide at a fixed rate, and repeat to the bit.
///
///     World world = make_world({.rate_hz = 240});
///     const BodyId lane = add_body(world, {.name = "lane", .shape = floor, .kind = Kind::fixed});
///     const BodyId ball = add_body(world, ball_body, {.X_WB = X_WB, .v_WB = {0, 6, 0}});
///     Workspace workspace;  // engine/workspace.h
///     while (world.tick < 5 * 240) step(world, workspace);
///
/// What a world is and what it remembers are in `World`; what a step borrows is a `Workspace`.
///
/// Time within a step: between steps all poses and velocities are those of `tick`. Within one,
/// bodies that approach fast are followed along their paths to where they meet and get their
/// impulses there, soonest first; each body that is struck then stands at the time of its last
/// impact, the others still at the step's start. Lasting contacts are solved for the velocities at
/// the end, from the points as they are by then; last, every body goes the rest of its way.
namespace headpin::engine {

struct Parameters {
  int rate_hz = 240;                    ///< steps a second
  Vec3 gravity_W{0.0, 0.0, -9.81};      ///< [m/s^2]
  std::string_view response = "paper";  ///< see `responses()`
  Query query = {};                     ///< how collisions are detected; its margin is ours to set
  double friction_tau = 1.0 / 60.0;  ///< time in which a lasting contact applies its rate once [s]
  double impact_speed = 0.15;        ///< slower approaches are lasting contacts [m/s]
  int impacts = 64;                  ///< most impacts of one body within a step
  int solver_iterations = 200;       ///< most passes over the lasting contacts of an island; four
                                     ///< times as many more, more softly, where they do not do
  double solver_residual = 1e-6;     ///< stop when no velocity changed by more in a pass [m/s]
  double slop = 5e-5;                ///< overlap that is left alone [m]
  double push = 0.2;                 ///< part of the rest taken back each 1/240 s
  bool sleep = true;                 ///< still islands are left out until something touches them
  double sleep_speed = 0.01;         ///< [m/s]
  double sleep_spin = 0.03;          ///< [rad/s]
  double sleep_after = 0.25;         ///< [s]
  int rules = 2;                     ///< 1: as before what is squeezed by driven bodies, lands just
                                     ///< behind a step's end or sleeps uncarried was looked at
  bool keep_ledger = false;          ///< `World::ledger`; costs about a tenth of a step
};

/// One step in numbers, or the sum of many (largest values stay the largest).
struct Statistics {
  std::int64_t steps = 0;
  std::int64_t pairs = 0;               ///< pairs of bodies whose bounds met
  std::int64_t contacts = 0;            ///< contact points
  QueryCounts queries;                  ///< of parts; `capped` among them
  std::int64_t impacts = 0;             ///< impulses given
  std::int64_t unfinished_impacts = 0;  ///< steps in which a body had more than it may have
  std::int64_t pulls = 0;               ///< impulses that would have pulled, replaced by F00
  std::int64_t islands = 0;
  std::int64_t solver_iterations = 0;
  std::int64_t unsolved = 0;     ///< islands stopped by their number of passes
  double residual = 0.0;         ///< largest change of a velocity in a last pass [m/s]
  double deepest_overlap = 0.0;  ///< [m]
  std::int64_t awake = 0;        ///< free bodies awake at the end of the step

  Statistics& operator+=(const Statistics& other);
};

/// Two bodies met: an impact, or the first touch of two that had never met or were made to forget.
struct ContactEvent {
  BodyId a = 0, b = 0;
  Vec3 p_W = Vec3::Zero();
  Vec3 n_AB_W = Vec3::UnitZ();
  Vec3 impulse_W = Vec3::Zero();  ///< on A [N s]
  double approach_speed = 0.0;    ///< [m/s]
  bool first = false;             ///< these two had not met before
};

namespace detail {

/// Who takes part in a step: made of kinds, shapes and sleep when `made` does not hold.
struct Roll {
  bool made = false;
  std::vector<BodyId> movers, driven;      ///< free and awake; driven
  std::vector<BodyId> unbounded, bounded;  ///< fixed half-spaces; all others
  std::vector<Capsule> bounds_W;           ///< of `bounded`: those at rest where they are
  std::vector<std::uint8_t> moving;        ///< of `bounded`: free and awake, or driven
};

}  // namespace detail

/// Plain data; a copy goes on like the original, to the bit. Change it between steps by the
/// functions below.
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

  // Made of the above.
  const Response* response = nullptr;
  std::vector<Inertia> inertias;
  detail::Roll roll;
};

/// Buffers of a step (engine/workspace.h).
struct Workspace;

/// A type that is the library's own for whoever sees the same layouts, and unknown to it otherwise:
/// then make_world() does not link. Flags like -D_GLIBCXX_DEBUG change them.
template <std::size_t... layout>
struct CompiledWithTheFlagsOf_pkg_config_cflags_headpin_engine {};
using SameLayout = CompiledWithTheFlagsOf_pkg_config_cflags_headpin_engine<
    sizeof(World), alignof(World), sizeof(Body), sizeof(State), sizeof(Compound), sizeof(Shape),
    sizeof(Memory), sizeof(Ledger), sizeof(ContactEvent)>;

/// An empty world.
///
/// @throws std::invalid_argument  naming the parameter, what it is and what it may be
World make_world(const Parameters& parameters, SameLayout = {});

/// @return  its number: bodies are counted from 0
/// @throws std::invalid_argument  naming the body and the value that cannot be: mass or inertia not
///   finite and positive, coefficient outside 0 to 1, pose or velocity not finite, half-space that
///   is not fixed, fixed body with a velocity
BodyId add_body(World& world, Body body, const State& state = {});

/// Puts a body somewhere, as a hand does. It wakes with its island and with what rests on it.
///
/// @throws std::invalid_argument  for a body that is not there, a fixed one, or a state not finite
void set_state(World& world, BodyId body, const State& state);

/// The state nearest to a wanted one that a body can be carried to from where it is: outside
/// everything fixed, and without speed into it. Nothing moves; hand the result to `set_state`.
///
/// The body goes straight from its place towards the wanted one, already turned as it shall be,
/// and slides along what it meets.
/// @throws std::invalid_argument  for a body that is not there or a state not finite
State outside_fixed(const World& world, BodyId body, const State& wanted);

/// Takes a free body in hand (`driven`) or lets it go (`free`) with the state it has.
///
/// @throws std::invalid_argument  for a body that is not there, or to or from `fixed`
void set_kind(World& world, BodyId body, Kind kind);

void wake(World& world, BodyId body);
/// Lets a free body sleep where it is until something moving touches it.
void put_to_sleep(World& world, BodyId body);
inline bool is_asleep(const World& world, BodyId body) {
  return world.asleep[body] != 0;
}

/// Lets a body meet all others for the first time again, as when it is set up anew.
///
/// @throws std::invalid_argument  for a body that is not there
void forget_meetings(World& world, BodyId body);

/// Lets bodies go on from where those of another world are, which are as many and the same but for
/// shapes, masses and materials: states, kinds, sleep, who has met, tick and ledger. Impulses and
/// normals are not taken over: they belong to the other shapes.
void take_over(World& world, const World& from);

/// One step of 1 / rate_hz.
///
/// @param workspace  of whoever steps; any will do, and one that is kept saves allocations
/// @throws std::runtime_error  when a state turns not finite, naming tick and body
void step(World& world, Workspace& workspace);
void step(World& world);

/// Energy, momentum and angular momentum of the free bodies, height from the origin of W.
Balance balance(const World& world);
/// What a free body has of it.
Balance balance_of(const World& world, BodyId body);

/// FNV-1a of the bits of tick, poses, velocities and sleep flags: 64 bits that two equal runs
/// share. `World::memory` is not in it; where that differs, the next states will.
std::uint64_t state_hash(const World& world);

inline double step_seconds(const World& world) {
  return 1.0 / world.parameters.rate_hz;
}

}  // namespace headpin::engine
