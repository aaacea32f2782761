#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "engine/body.h"
#include "engine/broad_phase.h"
#include "engine/contacts.h"
#include "engine/free_motion.h"
#include "engine/ledger.h"
#include "engine/response.h"

/// Bodies that stand, roll, fall and collide at a fixed rate, and repeat to the bit.
///
///     World world = make_world({.rate_hz = 240});
///     const BodyId lane = add_body(world, {.name = "lane", .shape = floor, .kind = Kind::fixed});
///     const BodyId ball = add_body(world, ball_body, {.X_WB = X_WB, .v_WB = {0, 6, 0}});
///     while (world.tick < 5 * 240) step(world);
namespace headpin::engine {

using BodyId = std::uint32_t;

struct Parameters {
  int rate_hz = 240;                    ///< steps a second
  Vec3 gravity_W{0.0, 0.0, -9.81};      ///< [m/s^2]
  std::string_view response = "paper";  ///< see `responses()`
  Query query = {};                     ///< how collisions are detected; its margin is ours to set
  double friction_tau = 1.0 / 60.0;  ///< time in which a lasting contact applies its rate once [s]
  double impact_speed = 0.15;        ///< slower approaches are lasting contacts [m/s]
  int impact_sweeps = 8;             ///< most passes over the impacts of a step
  int solver_iterations = 60;        ///< most passes over the lasting contacts of an island
  double solver_residual = 1e-6;     ///< stop when no velocity changed by more in a pass [m/s]
  double slop = 5e-5;                ///< overlap that is left alone [m]
  double push = 0.2;                 ///< part of the rest taken back each 1/240 s
  bool sleep = true;                 ///< still islands are left out until something touches them
  double sleep_speed = 0.01;         ///< [m/s]
  double sleep_spin = 0.03;          ///< [rad/s]
  double sleep_after = 0.25;         ///< [s]
  bool keep_ledger = false;          ///< `World::ledger`; costs about a tenth of a step
  /// Reads a clock [ns] for `Statistics::phase_ns`. Never reaches the state. Null: no timing.
  std::int64_t (*clock)() = nullptr;
};

/// The stages of a step, in order; `phase_names` has their names.
enum class Phase {
  find_pairs,
  find_contacts,
  resolve_impacts,
  apply_gravity,
  sustain_contacts,
  move,
  push_apart,
  fall_asleep,
};
inline constexpr std::array<std::string_view, 8> phase_names{
    "find_pairs",       "find_contacts", "resolve_impacts", "apply_gravity",
    "sustain_contacts", "move",          "push_apart",      "fall_asleep"};

/// One step in numbers, or the sum of many (largest values stay the largest).
struct Statistics {
  std::int64_t steps = 0;
  std::int64_t pairs = 0;               ///< pairs of bodies whose bounds met
  std::int64_t contacts = 0;            ///< contact points
  QueryCounts queries;                  ///< of parts; `capped` among them
  std::int64_t impacts = 0;             ///< impulses given
  std::int64_t impact_sweeps = 0;       ///< passes that gave any
  std::int64_t unfinished_impacts = 0;  ///< steps that still had some after the last pass
  std::int64_t pulls = 0;               ///< impulses that would have pulled, replaced by F00
  std::int64_t islands = 0;
  std::int64_t solver_iterations = 0;
  std::int64_t unsolved = 0;     ///< islands stopped by their number of passes
  double residual = 0.0;         ///< largest change of a velocity in a last pass [m/s]
  double deepest_overlap = 0.0;  ///< [m]
  std::int64_t awake = 0;        ///< free bodies awake at the end of the step
  std::array<std::int64_t, phase_names.size()> phase_ns{};

  Statistics& operator+=(const Statistics& other);
};

/// Two bodies met: an impact, or the first touch of two that had never met.
struct ContactEvent {
  BodyId a = 0, b = 0;
  Vec3 p_W = Vec3::Zero();
  Vec3 n_AB_W = Vec3::UnitZ();
  Vec3 impulse_W = Vec3::Zero();  ///< on A [N s]
  double approach_speed = 0.0;    ///< [m/s]
  bool first = false;             ///< these two had not met before
};

namespace detail {

/// What the step needs of a body beside its state.
struct Mobility {
  double inv_mass = 0.0;  ///< zero unless free and awake
  Mat3 inv_inertia_W = Mat3::Zero();
};

/// How an impact within the step bends the path of a body: positions go by v t - lag.
struct Kink {
  double time = 0.0;          ///< of the last impact within the step [s]
  Vec3 lag_v = Vec3::Zero();  ///< sum of velocity change times its time [m]
  Vec3 lag_w = Vec3::Zero();  ///< [rad]
};

/// A pair of bodies close enough to meet within the step. A is free and awake.
struct Touch {
  std::uint64_t key = 0;  ///< touches are in the order of their keys
  BodyId a = 0, b = 0;
  bool b_moves = false;         ///< B is free and awake too
  bool fresh = false;           ///< not there in the last step
  bool met = false;             ///< the two have met before
  std::uint32_t candidate = 0;  ///< whose normals it uses
  std::uint32_t last = 0;       ///< the same touch in the last step, unless fresh
  std::uint32_t first_point = 0, points = 0;
  std::uint32_t first_row = 0, rows = 0;
  std::uint32_t block = 0;  ///< of its rows in `blocks`, when it has 2 to 4
  double time = 0.0;        ///< of its impact within the step [s]: when its points are right
  Coefficients pair;
  Sliding sliding;
  Vec3 friction_W = Vec3::Zero();  ///< impulse on A of the last step, to start from
  double twist = 0.0, roll = 0.0;
};

/// Last normals of the pairs of parts of two bodies whose bounds met.
struct Candidate {
  std::uint64_t key = 0;
  BodyId a = 0, b = 0;
  std::uint32_t first_normal = 0, normals = 0;
};

/// One contact point in the solver: approach along n at most `allowed`, impulse at least 0.
struct NormalRow {
  NormalRow() {}  // NOLINT: `= default` would have emplace_back clear it first

  Vec3 n, ra_n, rb_n, ia, ib;
  double mass = 0.0, allowed = 0.0, impulse = 0.0;
  std::uint32_t feature = 0;
};

/// Inverse of what the n = 2 to 4 normal rows of a touch do to each other: its first n x n entries.
using Block = Eigen::Matrix4d;

/// One body in the friction of a pair: levers of the tangents, and how unit impulses turn it.
struct FrictionSide {
  std::array<Vec3, 2> r_t, i;
  Vec3 twist_i, roll_i;
};

/// Friction of a pair: slip along two tangents, twist about the normal, rolling about A's axis.
struct FrictionRows {
  FrictionRows() {}  // NOLINT: likewise

  std::uint32_t touch = 0;
  bool carries = false;
  int releases = 0;  ///< how often it lost its load within the step
  std::array<Vec3, 2> t;
  FrictionSide a, b;
  Eigen::Matrix2d inverse;   ///< of the softened 2 x 2 block
  Eigen::Matrix2d softness;  ///< by which the block is softened
  Vec2 impulse;
  double reach = 0.0;  ///< limit of the twist over load [m]
  Vec3 n;
  double twist_mass = 0.0, twist_softness = 0.0, twist = 0.0;
  Vec3 axis;
  double roll_mass = 0.0, roll_arm = 0.0, roll = 0.0;
};

/// Flat memory of a step, kept from step to step.
struct Scratch {
  bool stale = true;                       // who moves has changed
  std::vector<BodyId> movers, driven;      // free and awake; driven
  std::vector<BodyId> unbounded, bounded;  // fixed half-spaces; all others
  std::vector<Capsule> bounds_W;           // of `bounded`
  std::vector<std::uint8_t> moving;
  BroadPhase broad_phase;
  std::vector<Candidate> candidates, last_candidates;
  std::vector<Vec3> normals, last_normals;
  std::vector<Touch> touches, last_touches;
  std::vector<ContactPoint> points;
  std::vector<NormalRow> rows, last_rows;
  std::vector<Block> blocks;
  std::vector<FrictionRows> friction;
  std::vector<BodyId> parent;                // islands, as a union-find forest
  std::vector<std::uint32_t> island_number;  // of a root
  std::vector<std::int32_t> island_calm;     // likewise: least number of still steps
  std::vector<std::uint32_t> island_of, island_start, order;
  std::vector<Mobility> mobility;
  std::vector<double> swing, top_speed;  // of any point of a body: by its spin; in all [m/s]
  double fall = 0.0;         // what gravity adds to its way within the step [m], at most
  std::vector<Twist> start;  // velocities at the start of the step
  std::vector<Kink> kinks;
  std::vector<std::pair<double, std::uint32_t>> coming;  // impacts by time, and their touches
  std::vector<std::uint8_t> supported;  // a lasting contact carried it in this step
  std::vector<Vec3> nudge_p, nudge_w;
  std::vector<BodyId> nudged;
};

}  // namespace detail

/// Plain data; a copy goes on like the original. Change it between steps by the functions below.
struct World {
  Parameters parameters;
  std::int64_t tick = 0;
  std::vector<Body> bodies;
  std::vector<State> states;         ///< of the bodies, same numbers
  std::vector<std::uint8_t> asleep;  ///< 1 where a free body sleeps
  std::vector<ContactEvent> events;  ///< of the last step, in the order they happened
  Statistics statistics;             ///< of the last step
  Ledger ledger;                     ///< since the start, when kept

  const Response* response = nullptr;
  std::vector<Inertia> inertias;
  std::vector<std::int32_t> still;  ///< steps for which a body has been still
  std::vector<BodyId> sleeps_with;  ///< ring of bodies that fell asleep as one island
  std::vector<std::uint64_t> met;   ///< sorted pairs that have met
  Balance balance;                  ///< at the end of the last step, when the ledger is kept
  Balance struck, pushed;           ///< of the step's impacts; of driven bodies in a phase
  detail::Scratch scratch;
};

/// An empty world.
///
/// @throws std::invalid_argument  naming the parameter, what it is and what it may be
World make_world(const Parameters& parameters);

/// @return  its number: bodies are counted from 0
/// @throws std::invalid_argument  naming the body and the value that cannot be: mass or inertia not
///   finite and positive, coefficient outside 0 to 1, pose or velocity not finite, half-space that
///   is not fixed, fixed body with a velocity
BodyId add_body(World& world, Body body, const State& state = {});

/// Puts a body somewhere, as a hand does. A free body wakes with those that sleep beside it.
///
/// @throws std::invalid_argument  for a body that is not there, a fixed one, or a state not finite
void set_state(World& world, BodyId body, const State& state);

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

/// One step of 1 / rate_hz.
///
/// @throws std::runtime_error  when a state turns not finite, naming tick and body
void step(World& world);

/// Energy, momentum and angular momentum of the free bodies, height from the origin of W.
Balance balance(const World& world);

/// FNV-1a of the bits of tick, poses, velocities and sleep flags: 64 bits that two equal runs
/// share.
std::uint64_t state_hash(const World& world);

inline double step_seconds(const World& world) {
  return 1.0 / world.parameters.rate_hz;
}

}  // namespace headpin::engine
