#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "engine/body.h"
#include "engine/broad_phase.h"
#include "engine/contacts.h"
#include "engine/response.h"

/// Memory of a step, for the stages behind world.h. Users need none of it.
namespace headpin::engine {

using BodyId = std::uint32_t;

namespace detail {

/// What the step needs of a body beside its state.
struct Mobility {
  double inv_mass = 0.0;  ///< zero unless free and awake
  Mat3 inv_inertia_W = Mat3::Zero();
};

/// A pair of bodies close enough to meet within the step. A is free and awake.
///
/// `find_contacts` makes it, from `key` to `sliding`; `resolve_impacts` moves its points to the
/// time of the last impact of its bodies, takes them away where the two pass each other, and uses
/// `due` and `next`; `sustain_contacts` adds rows and block, and leaves loads, deep rows and
/// friction: the rows go with their island, the rest becomes a `PastTouch`.
struct Touch {
  std::uint64_t key = 0;  ///< touches are in the order of their keys
  BodyId a = 0, b = 0;
  bool b_moves = false;         ///< B is free and awake too
  bool fresh = false;           ///< not there in the last step
  bool met = false;             ///< the two have met before
  bool struck = false;          ///< it has brought an impact in this step
  bool pressed = false;         ///< its driven body threw or carried the other in the last step
  bool insists = false;         ///< its driven body presses what cannot give way
  bool swings = false;          ///< its points say little about the end of the step
  std::uint32_t candidate = 0;  ///< whose normals it uses
  std::uint32_t last = 0;       ///< the same touch in the last step, unless fresh
  std::uint32_t first_point = 0, points = 0;
  std::uint32_t first_row = 0, rows = 0;  ///< while its island is solved
  std::uint32_t block = 0;       ///< of its rows in `blocks`, when it has 2 to 4 that differ
  std::uint32_t first_load = 0;  ///< of its rows in `loads`, once they are solved
  std::uint32_t first_deep = 0, deep = 0;  ///< those of its rows that are in `deep_rows`
  double depth = 0.0;                      ///< of its deepest point, once its rows are solved [m]
  double time = 0.0;                       ///< within the step, when its points are right [s]
  Vec3 w_WA = Vec3::Zero(),
       w_WB = Vec3::Zero();             ///< turn of A and B then, if that is not their clock
  double due = 0.0;                     ///< when it brings an impact next, infinity: never
  std::array<std::uint32_t, 2> next{};  ///< touch of A, and of B, in the lists of theirs
  Coefficients pair;
  Sliding sliding;
  Vec3 friction_W = Vec3::Zero();  ///< impulse on A of the last step, to start from
  double twist = 0.0;
  Vec3 roll = Vec3::Zero();
};

/// What a touch leaves to the same touch of the next step.
struct PastTouch {
  std::uint64_t key = 0;  ///< they are in the order of their keys
  bool met = false, struck = false;
  std::uint32_t first_load = 0, loads = 0;  ///< in `last_loads`
  double friction = 0.0;
  Sliding sliding;          ///< for that friction
  Vec3 friction_W, roll_W;  ///< impulses on A
  double twist = 0.0;
};

/// What a contact point carried: an impulse [kg m/s].
struct Load {
  double impulse = 0.0;
  std::uint32_t feature = 0;
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

/// The row of a contact point that is deeper than the slop.
struct DeepRow {
  NormalRow row;
  std::uint32_t point = 0;
};

/// Inverse of what the n = 2 to 4 normal rows of a touch do to each other: its first n x n entries.
using Block = Eigen::Matrix4d;

/// One body in the friction of a pair: levers of the tangents, and how unit impulses turn it.
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
  bool held = false;  ///< its limit goes by `load`, not by what the normals carry at the moment
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

/// Flat memory of a step, kept from step to step.
struct Scratch {
  bool stale = true;                       // who moves has changed
  std::vector<BodyId> movers, driven;      // free and awake; driven
  std::vector<BodyId> unbounded, bounded;  // fixed half-spaces; all others
  std::vector<Capsule> bounds_W;           // of `bounded`
  std::vector<std::uint8_t> moving;
  BroadPhase broad_phase;
  std::vector<Candidate> candidates, last_candidates;
  std::vector<Vec3> normals, last_normals, kept_normals;
  std::vector<Touch> touches;
  std::vector<PastTouch> last_touches;
  std::vector<ContactPoint> points, end_points;
  std::vector<NormalRow> rows;  // of the island that is being solved,
  std::vector<Block> blocks;    // likewise,
  std::vector<FrictionRows> friction;
  std::vector<Load> loads, last_loads;
  std::vector<DeepRow> deep_rows;
  std::vector<std::uint32_t> met_now;        // touches that carry and whose bodies had not met
  std::vector<double> before, along;         // impulses of an island: last pass, way of the passes
  std::vector<BodyId> island_bodies;         // of one that its passes did not solve,
  std::vector<State> unsolved;               // and what they made of them
  std::vector<BodyId> parent;                // islands, as a union-find forest
  std::vector<std::uint32_t> island_number;  // of a root
  std::vector<std::int32_t> island_calm;     // likewise: least number of still steps
  std::vector<std::uint32_t> island_of, island_start, order;
  std::vector<Mobility> mobility;
  std::vector<double> swing, top_speed;  // of any point of a body: by its spin; in all [m/s]
  double lasting_speed = 0.0;            // up to which an approach is a lasting contact [m/s]
  double fall = 0.0;                // what gravity adds to its way within the step [m], at most
  std::vector<double> clock;        // time within the step at which a body's state holds [s]
  std::vector<std::uint8_t> falls;  // gravity moves it until then: nothing carries it
  std::vector<int> impacts_of;      // how many a body has had in this step
  std::vector<std::pair<BodyId, State>> struck;          // what they were before the first
  std::vector<std::uint32_t> place_struck;               // of a body in `struck`, once it is there
  std::vector<std::pair<double, std::uint32_t>> coming;  // impacts by time, and their touches
  std::vector<std::uint32_t> first_touch;                // of a body, in a list through `next`
  std::vector<double> sought;       // how far from its start a body has been sought for pairs [m]
  std::vector<std::uint32_t> near;  // bounded bodies near one that is faster than that
  std::size_t early_candidates = 0, early_touches = 0;  // those in order, of the start of the step
  std::vector<std::pair<BodyId, State>> pressed;   // of an island, as it was before it was solved,
  std::vector<std::pair<BodyId, State>> pressing;  // and the driven bodies that touch it
  std::vector<double> carried;          // part of its weight that lasting contacts carry, 0 to 1
  std::vector<std::uint8_t> supported;  // by half at least, and it does not rise
  std::vector<Vec3> nudge_p, nudge_w;
  std::vector<BodyId> nudged, pinned;  // pushed apart; held and pressed far in
};

}  // namespace detail

}  // namespace headpin::engine
