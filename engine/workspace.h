#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "engine/body.h"
#include "engine/broad_phase.h"
#include "engine/contacts.h"
#include "engine/crew.h"
#include "engine/memory.h"
#include "engine/world.h"

/// Buffers of a step. Users who step often keep a `Workspace` and need nothing inside it.
namespace headpin::engine {

namespace detail {

inline constexpr std::uint32_t kNone = ~std::uint32_t{0};  ///< not a valid number

// Results of finding touches.

/// A pair of bodies close enough to meet within the step. A is free and awake.
struct Touch {
  std::uint64_t key = 0;
  std::uint32_t part = 0;  ///< of B, where its parts are touched each on its own
  BodyId a = 0, b = 0;
  bool b_moves = false;         ///< B is free and awake too
  bool b_driven = false;        ///< B is a driven body
  bool fresh = false;           ///< not there in the last step
  bool met = false;             ///< the two have met before
  bool pressed = false;         ///< its driven body threw or carried the other in the last step
  std::uint32_t candidate = 0;  ///< the one whose normals it uses
  std::uint32_t last = 0;       ///< the same touch in the last step, unless fresh
  std::uint32_t first_point = 0, points = 0;
  double time = 0.0;  ///< time within the step for which its points were found [s]
  Vec3 w_WA = Vec3::Zero(),
       w_WB = Vec3::Zero();  ///< angular velocities of A and B at that time
  Coefficients pair;
  Sliding sliding;
};

/// Candidates, and the normals of their pairs of parts.
struct Pairs {
  std::vector<Candidate> candidates;
  std::vector<KeptNormal> normals;
  std::size_t early = 0;  ///< number of candidates from the start of the step, sorted
};

/// Touches in the order of their keys and parts, with their points. Impacts move points to the
/// time of the last impact of their bodies, remove points of bodies that pass each other, and
/// append the touches of bodies that got faster. The appended touches are not sorted.
struct Touches {
  Pairs* pairs = nullptr;
  std::vector<Touch> all;
  std::vector<ContactPoint> points;
  std::size_t early = 0;        ///< number from the start of the step, sorted
  std::vector<double> due;      ///< of these, the time of the next possible impact; infinity: never
  std::vector<Touch> sleeping;  ///< those of sleeping bodies, which they may wake
  QueryCounts queries;
};

// Results of moving to the impacts.

/// A body on its way through the step.
struct Flyer {
  double clock = 0.0;                        ///< time within the step at which its state holds [s]
  double spin_speed = 0.0, top_speed = 0.0;  ///< bounds for its points: by spin; in all [m/s]
  double sought = 0.0;  ///< distance from its start that was searched for pairs [m]
  int impacts = 0;
  std::uint32_t place_struck = 0;  ///< in `Flight::struck`, once it is there
  std::uint32_t first_touch = 0;   ///< in a list through `QueuedTouch::next`
  bool falls = false;              ///< gravity moves it: nothing carries it
  bool strays = false;             ///< it can leave the bounds of the search for pairs
};

/// Inverse mass and inertia of a free and awake body.
struct Mobility {
  double inv_mass = 0.0;
  Mat3 inv_inertia_W = Mat3::Zero();  ///< at its clock
};

/// Data of a touch in the queue of impacts.
struct QueuedTouch {
  double due = 0.0;                     ///< time of its next possible impact; infinity: never
  std::array<std::uint32_t, 2> next{};  ///< next touch in the list of A, and in that of B
  bool struck = false;                  ///< it has brought an impact in this step
  bool insists = false;                 ///< its driven body presses what cannot give way
};

struct Flight {
  std::vector<Flyer> bodies;
  std::vector<Mobility> mobility;                ///< of the bodies; meaningless if they do not move
  std::vector<QueuedTouch> touches;              ///< of the touches, same numbers
  std::vector<std::pair<BodyId, State>> struck;  ///< states before the first impact
  double lasting_speed = 0.0;  ///< largest approach speed of a lasting contact [m/s]
  double fall = 0.0;           ///< most that gravity adds to a distance within the step [m]
};

// Results of solving lasting contacts.

/// One contact point in the solver: approach along n at most `allowed`, impulse at least 0.
struct NormalRow {
  NormalRow() {}  // NOLINT: `= default` would have emplace_back clear it first

  Vec3 n, ra_n, rb_n, ia, ib;
  double mass = 0.0, allowed = 0.0, impulse = 0.0;
  std::uint32_t feature = 0;
};

/// The row of a contact point that is deeper than the slop.
struct DeepRow {
  NormalRow row;
  std::uint32_t point = 0;
};

/// Inverse of the matrix that couples the n = 2 to 4 normal rows of a touch: its first n x n
/// entries.
using Block = Eigen::Matrix4d;

/// One body in the friction of a pair: lever arms of the tangents, and turns by unit impulses.
struct FrictionSide {
  std::array<Vec3, 2> r_t, i;
  Vec3 twist_i;
};

/// Friction of a pair: slip along two tangents, twist about the normal, and rolling.
struct FrictionRows {
  FrictionRows() {}  // NOLINT: likewise

  std::uint32_t touch = 0;
  bool carries = false;
  int releases = 0;   ///< how often it lost its load within the step
  bool held = false;  ///< its limit uses `load`, not the present loads of the normals
  double load = 0.0;
  std::array<Vec3, 2> t;
  FrictionSide a, b;
  Eigen::Matrix2d inverse;   ///< of the softened 2 x 2 block
  Eigen::Matrix2d softness;  ///< by which the block is softened
  double kept = 0.0;         ///< part of the slip that is left
  Vec2 impulse;
  double reach = 0.0;  ///< limit of the twist over load [m]
  Vec3 n;
  double twist_mass = 0.0, twist_softness = 0.0, twist = 0.0;
  Vec3 axis;  // of a lying body, unless it is a ball, which rolls about any
  bool rolls_any = false;
  double roll_mass = 0.0, roll_arm = 0.0;
  Vec3 roll;
  double yields = 0.0;  // mean of the velocity that a unit impulse along a tangent brings [1/kg]

  void hold(double by) {
    held = true;
    load = by;
    releases = 0;
  }
};

/// Results of a touch. Its rows are valid only while its island is solved.
struct SolvedTouch {
  std::uint32_t first_row = 0, rows = 0;
  std::uint32_t block = 0;                 ///< index in `blocks`, if it has 2 to 4 independent rows
  std::uint32_t first_load = 0;            ///< of its rows
  std::uint32_t first_deep = 0, deep = 0;  ///< those of its rows that are in `deep_rows`
  bool met = false;                        ///< the two have met before, or now
  bool insists = false;                    ///< its driven body presses what cannot give way
  bool swings = false;                     ///< its points may be wrong at the end of the step
  double depth = 0.0;                      ///< of its deepest point [m]
  Vec3 friction_W = Vec3::Zero();          ///< impulse on A
  double twist = 0.0;
  Vec3 roll = Vec3::Zero();
};

/// Free and awake bodies joined by touches.
struct Islands {
  std::vector<BodyId> parent;          ///< of a body, in a union-find forest
  std::vector<std::uint32_t> number;   ///< of a root: that of its island
  std::vector<std::int32_t> calm;      ///< likewise: least number of still steps
  std::vector<std::uint32_t> order;    ///< touches by island, each island's in their own order
  std::vector<std::uint32_t> end, of;  ///< of each island in `order`; the island of a touch
};

struct Solved {
  std::vector<SolvedTouch> touches;  ///< of the touches, same numbers
  std::vector<double> carried;       ///< part of a body's weight that contacts carry, 0 to 1
  std::vector<Vec3>
      slowed;  ///< what friction adds to a body's velocity where it slides on a level surface [m/s]
  Islands islands;
  std::vector<Load> loads;
  std::vector<DeepRow> deep_rows;
};

// Buffers.

using Vec6 = Eigen::Matrix<double, 6, 1>;  ///< linear, then angular
using Mat6 = Eigen::Matrix<double, 6, 6>;

/// A row of the direct solution: an impulse, and the velocity that it resists.
struct DirectRow {
  /// A normal; the first and the second of two rows with a common limit; a row with its own limit.
  enum Kind : std::uint8_t { normal, pair, second, single } kind = normal;
  std::uint32_t a = 0, b = 0;        ///< numbers of the bodies; kNone if B does not move
  Vec6 ja, jb;                       ///< velocity = ja . v_A + jb . v_B
  double velocity = 0.0;             ///< now
  double change = 0.0;               ///< by the step that Newton's method is about to take
  double compliance = 0.0;           ///< velocity over change of the impulse
  Vec2 softness = Vec2::Zero();      ///< velocity over impulse; of a pair: over both impulses
  double before = 0.0, limit = 0.0;  ///< impulse before; largest impulse
  double impulse = 0.0;              ///< now
  int directions = 0;                ///< along which it resists a change: 0, 1, of a pair up to 2
  Vec2 direction = Vec2::Zero();     ///< one of them, times the root of its stiffness
};

struct DirectMass {
  double mass = 0.0;
  Mat3 inertia_W = Mat3::Zero();
};

/// A body is eliminated; its neighbours `later[first]` to `later[first + count - 1]` are eliminated
/// after it.
struct DirectElimination {
  std::uint32_t body = 0, first = 0, count = 0;
};

/// Buffers for the direct solution of an island.
struct Direct {
  std::vector<BodyId> bodies;  ///< of the island, sorted; elsewhere they are known by numbers in it
  std::vector<std::uint32_t> place, neighbours;  ///< place among the eliminations; how many left
  std::vector<std::uint32_t> block_of;  ///< index of a row's and a column's block, in a table
  std::vector<DirectElimination> eliminations;
  std::vector<std::uint32_t> later;
  std::vector<Mat6> blocks;
  std::vector<DirectMass> masses;
  std::vector<DirectRow> rows;
  std::vector<Vec6> changes, step;  ///< of velocities: up to now; by Newton's method
};

/// An island as it was before passes that may not solve it.
struct RowsBefore {
  std::vector<double> loads;  ///< of its normal rows
  std::vector<FrictionRows> friction;
  std::vector<State> states;  ///< of its bodies
};

/// Buffers for the solution of an island.
struct Rows {
  std::vector<NormalRow> normals;
  std::vector<Block> blocks;
  std::vector<FrictionRows> friction;
  std::vector<double> before, along;  ///< impulses: before a pass; see Acceleration
  Direct direct;
  RowsBefore start;
  std::vector<BodyId> bodies;                      ///< of an island that its passes did not solve
  std::vector<Vec3> pushed;                        ///< change of a body's velocity by its contacts
  std::vector<State> unsolved;                     ///< states of these bodies after the passes
  std::vector<std::pair<BodyId, State>> pressed;   ///< states of an island before it is solved
  std::vector<std::pair<BodyId, State>> pressing;  ///< states of driven bodies that touch it
};

/// Buffers for contacts at the end of the step.
struct AtEnd {
  std::vector<KeptNormal> normals;
  std::vector<ContactPoint> points;
  QueryCounts queries;
};

/// Islands that one thread solves, and what it finds.
struct IslandPart {
  std::uint32_t begin = 0, end = 0;  ///< numbers of islands
  std::uint32_t first_load = 0;
  std::vector<DeepRow> deep_rows;
  std::vector<std::uint32_t> met_now;  ///< touches with a load whose bodies had not met before
  Statistics statistics;
};

/// Buffers that each thread has for itself.
struct ThreadBuffers {
  Rows rows;
  AtEnd at_end;
};

struct Nudge {
  Vec3 p = Vec3::Zero(), w = Vec3::Zero();
};

/// A body's part of the balance, and the state for which it was computed.
struct Booked {
  bool known = false;
  State state;
  Balance part;
};

}  // namespace detail

/// Buffers of a step. Their content has no meaning between steps; any workspace works for any
/// world.
struct Workspace {
  detail::Pairs pairs;
  detail::Touches touches;
  detail::Flight flight;
  detail::Solved solved;
  std::vector<detail::Booked> booked;  ///< of the ledger, by body
  Balance by_impacts, by_driven;  ///< gains by the impacts of a step; by driven bodies in a stage
  BroadPhase broad_phase;
  Crew crew;
  std::size_t parts = 1;                     ///< in which touches are found
  std::vector<detail::Touches> touch_parts;  ///< before they are joined, if there are several
  std::vector<detail::IslandPart> island_parts;
  std::vector<detail::ThreadBuffers> each_thread = std::vector<detail::ThreadBuffers>(1);
  std::vector<std::uint32_t> known;  ///< touches that a pair has already
  std::vector<std::uint32_t> near;   ///< bounded bodies near a body that an impact made faster
  std::vector<std::pair<double, std::uint32_t>> coming;  ///< impacts by time, and their touches
  std::vector<BodyId> halted;                            ///< bodies at the limit of impacts
  std::vector<BodyId> strays;          ///< bodies that left the bounds of the search for pairs
  std::vector<std::uint32_t> met_now;  ///< touches with a load whose bodies had not met before
  std::vector<detail::Nudge> nudges;   ///< of bodies
  std::vector<BodyId> nudged, pinned;  ///< pushed apart; held by a driven body, far in

  detail::Touches& part_of(std::size_t k) { return parts == 1 ? touches : touch_parts[k]; }
};

}  // namespace headpin::engine
