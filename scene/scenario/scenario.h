#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/math.h"
#include "devices/base/sample.h"
#include "render/data/optics.h"
#include "render/data/quality.h"
#include "scene/scenario/choices.h"

/// The data of a session: room, skittles, ball, collision response, rates, rig and display. It is
/// one TOML file; a trial contains all of it.
///
/// Metre, kilogram, second unless a name says otherwise. The defaults are the paper's room. The
/// comments that `to_toml` writes have the sources of the measures.
namespace headpin::scene {

/// A mesh file (scene/stage/mesh_file.h).
struct MeshFile {
  std::string file;  ///< where it is; none for none
  double unit = 1.0;
  std::string axes = "RAS";
  std::string sha256;  ///< of its bytes
};

/// A part of a skittle, measured from its base: a primitive on the skittle's axis, or a convex
/// polyhedron whose corners come from a file once and are kept here from then on.
struct SkittlePart {
  PartShape shape = PartShape::ellipsoid;
  double radius = 0.05;            ///< largest radius across the axis
  double low = 0.0;                ///< where it begins, above the base
  double high = 0.1;               ///< where it ends; a cone has its tip there
  MeshFile mesh = {};              ///< where a polyhedron is from
  std::vector<Vec3> corners = {};  ///< of a polyhedron; of it, the three measures above
                                   ///< follow from these
  std::vector<std::vector<std::uint32_t>> faces = {};  ///< counterclockwise from outside
};

/// Of a lane, side by side across its width (USBC).
inline constexpr int kBoards = 39;

struct Rates {
  std::int64_t physics_hz = 240;
  std::int64_t frame_hz = 60;
};

struct Room {
  double width = 4.5;   ///< the lane lies in the middle
  double height = 2.8;  ///<
  double behind = 3.0;  ///< from the foul line back to the wall behind the player
  double ahead = 7.6;   ///< from the foul line to the wall behind the skittles
  bool solid_ceiling = true;
  MeshFile mesh;  ///< seen in place of the walls and the ceiling
};

/// A rectangle of the lane with oil. Boards count from the right gutter, 1 to 39; both ends belong to
/// it.
struct OilZone {
  std::int64_t first_board = 1, last_board = kBoards;
  double from = 0.0, to = 1.0;  ///< from the foul line
  double friction = 0.04;       ///< between the lane there and what touches it
};

/// The oil on the lane: none without zones.
struct Oil {
  std::vector<OilZone> zones;
  double dry = 0.2;         ///< friction where the lane before the skittles has none
  bool mirrored = false;    ///< boards count from the left gutter, for a left-handed player
  double wear = 0.0;        ///< part of the oil that a ball takes where it touches the lane
  double carry_down = 0.1;  ///< part of this that it lays down on dry boards
};

/// The paper mentions only a room and a game of bowling. So other parts of an alley exist only if a
/// scenario has them.
struct Lane {
  double width = 1.0541;
  double head_pin = 6.0;       ///< from the foul line to the head pin's spot
  bool masking_panel = false;  ///< hangs before the skittles, from wall to wall of the kick-backs
  bool kick_backs = false;     ///< walls beside the skittles
  double gutter_width = 0.0;   ///< of each; 0 for none
  double gutter_depth = 0.0;   ///< 0: painted on the floor
  Oil oil;
};

inline constexpr std::size_t kMostSkittles = 10'000;

struct Rack {
  std::vector<Vec2> spots;  ///< from the head pin's spot: x right, y away from the player
};

struct Skittle {
  double height = 0.381;
  double mass = 1.588;
  double rolling_arm = 0.008;      ///< what brings a skittle on its side to rest
  std::vector<SkittlePart> parts;  ///< its true shape, as the collisions see it
  std::vector<Vec2> profile;       ///< (height above the base, radius), as the eyes see it
  SeenSkittle seen = SeenSkittle::profile;
  Weighed weighed = Weighed::profile;
  WeighedEllipsoid ellipsoid_weighed = WeighedEllipsoid::alike;
  MeshFile mesh;  ///< seen in place of the profile
};

struct Ball {
  double radius = 0.1085;
  double mass = 6.8;
  Vec3 home = Vec3(0.35, -0.25, 0.85);  ///< p_WB of the ball on its stand
  double rg = 0.0;  ///< radius of gyration about the pin axis; 0 for a ball without a core
  double differential = 0.0;       ///< the largest one is so much more
  double intermediate = 0.0;       ///< and that about the mass bias so much less than the largest
  Vec3 pin = Vec3::UnitZ();        ///< direction of the pin from the centre, in B
  Vec3 mass_bias = Vec3::UnitX();  ///< and of the mass bias; its part across the pin axis counts
  bool rings = false;              ///< the eyes see the rings of oil of its last throw
  MeshFile mesh;                   ///< seen in place of the marbled one
};

/// Restitution and friction of each object (Uno & Slater 1997, table 1). Two bodies in contact have
/// the product.
struct Coefficients {
  double elasticity = 0.7;
  double friction = 0.7;
};

struct Materials {
  Coefficients skittle, ball, lane, wall;
};

struct Collision {
  SkittleShape shape = SkittleShape::parts;
  Detection detection = Detection::converged;
  std::int64_t iterations = 20;  ///< cap on a query's iterations, 5..20
  bool warm = false;             ///< paper detection starts from the last normal: ours, not of 1997
  PlaneAtCap answer = PlaneAtCap::best;
  std::string response = "paper";      ///< name of one of engine::responses()
  double friction_tau_s = 1.0 / 60.0;  ///< in which a lasting contact applies its friction once
  double gravity = 9.81;
  bool sleep = true;
  std::int64_t rules = 17;  ///< of the step, see `engine::Parameters`
};

struct Hand {
  double reach = 0.18;                   ///< what has its surface nearer than this is grabbed
  Vec3 grip = Vec3(0.0, -0.03, -0.115);  ///< p_HB of the carried ball
  Vec3 spin = Vec3::Zero();              ///< what the fingers add to a ball's as it leaves [rad/s]
  bool takes_skittles = true;            ///< or balls alone
  bool solid = true;                     ///< a body that pushes what it touches
  double elasticity = 0.0;               ///< soft: it pushes and does not bat
  double friction = 0.7;
  ReleaseAt release_at = ReleaseAt::trigger;
  double release_window_s = 0.120;       ///< the release velocity is fitted over this
  double release_window_most_s = 0.240;  ///< and over up to this where the tracker is noisy
  double release_accuracy = 0.3;         ///< that is, while it is known worse than this [m/s]
  bool falls_at_once = false;            ///< what is let go between two ticks falls from then on
  MeshFile mesh;                         ///< seen in place of ours, open and gripping
};

/// How the release of a ball differs from the hand's own: "what if". All else stays as the hand has it.
struct ReleaseChange {
  double speed = 1.0;          ///< factor of the ball's velocity
  double direction_deg = 0.0;  ///< turn of the velocity to the right, seen from above
  double height = 0.0;         ///< the ball is this much higher [m]
  double boards = 0.0;         ///< and so many boards further to the left
  double revs = 1.0;           ///< factor of the ball's spin
  double rotation_deg = 0.0;   ///< turn of the spin's axis to the left, seen from above
  /// Then added to the spin about the level direction of the throw [rad/s]; with friction, the ball
  /// curves to the right.
  double spin = 0.0;

  bool operator==(const ReleaseChange&) const = default;
};

/// The game that is played: see scene/scenario/rules.h.
struct GameRules {
  GameKind rules = GameKind::one_throw;
  std::int64_t frames = 5;
  std::int64_t balls = 2;    ///< of a frame
  double ball_back_s = 8.0;  ///< it comes back so long after it was let go, at the latest
  double off_spot = 0.2;     ///< an upright skittle further from its spot is down
  BallEnds ends = BallEnds::rest;
  HandFells hand_fells = HandFells::apart;
  StrayFells stray_fells = StrayFells::apart;
  FoulBall foul = FoulBall::note;
  bool show_score = false;  ///< a score board hangs in the room
  NotStored not_stored = NotStored::goes_on;
};

/// One of two versions of the game, which its button starts (Uno & Slater 1997, section 3).
struct Version {
  Vec3 button = Vec3(-0.55, 0.0, 1.1);      ///< its centre
  double elasticity = 0.7, friction = 0.7;  ///< of skittles, ball, lane and walls
  SkittleShape shape = SkittleShape::parts;
  std::optional<Detection> detection =
      std::nullopt;             ///< collision.detection where it has none of its own
  std::int64_t iterations = 0;  ///< as collision.iterations, or that one's own
};

struct Versions {
  bool buttons = false;  ///< there are any
  double radius = 0.06;  ///< of a button
  Version red, blue{.button = Vec3(-0.85, 0.0, 1.1)};
};

/// Walking with the thumb buttons.
struct Walking {
  WalkAlong along = WalkAlong::gaze;
  double speed = 1.2;
  double acceleration = 3.0;
  double clearance = 0.3;  ///< of the head from walls
};

/// The mounting of the tracker and its receivers.
struct Rig {
  std::int64_t head_station = devices::kHeadStation;  ///< of the tracker's sensor on the head
  std::int64_t hand_station =
      devices::kHandStation;  ///< of the one on the 3D mouse in the right hand
  Pose X_WT;                  ///< transmitter in the world, until somebody walks
  Pose X_SD;                  ///< head's receiver -> display
  Pose X_SH;                  ///< hand's receiver -> virtual hand
  double delay_s = 0.0;       ///< poses are read this long before now; 0 holds the last sample
  double predicted_s = 0.0;   ///< poses are told at least this long before their time
  double away_after_s = 0.0;  ///< a hand not seen for longer is nowhere; 0: its last pose stays
};

/// The display: a profile of render/data/hmd.h, and its values where nothing else is asked for.
struct Hmd {
  std::string profile;
  render::Optics optics;
};

/// @throws std::invalid_argument  naming the profiles there are
Hmd hmd_of_profile(std::string_view name);

/// What the participant hears. The paper mentions no sound.
struct Sound {
  bool on = false;
};

struct Scenario {
  std::string name = "paper-room";
  Rates rates;
  Room room;
  Lane lane;
  Rack rack;
  Skittle skittle;
  Ball ball;
  Materials material;
  Collision collision;
  GameRules game;
  Versions version;
  Hand hand;
  ReleaseChange release;
  Walking walk;
  Rig rig;
  Hmd hmd;
  render::Quality look;
  Sound sound;

  Scenario();  ///< ten pins as in assets/scenarios/paper-room.toml
};

/// The whole scenario as TOML, with comments; parse_scenario reads it back to the same bits.
std::string to_toml(const Scenario& scenario);

/// Gives every object the same elasticity or friction.
void set_elasticity(Materials& materials, double elasticity);
void set_friction(Materials& materials, double friction);

// The same of a whole scenario, in every version that it has, as `--elasticity`, `--friction` and
// `--shape` do.
void set_elasticity(Scenario& scenario, double elasticity);
void set_friction(Scenario& scenario, double friction);
void set_shape(Scenario& scenario, SkittleShape shape);

/// The scenario with the values of one of its versions.
Scenario under(Scenario scenario, const Version& version);

/// A key whose value differs between two scenarios, with both values as TOML.
struct KeyDifference {
  std::string key, a, b;
};
/// All of them, in the order of to_toml.
std::vector<KeyDifference> differences(const Scenario& a, const Scenario& b);

}  // namespace headpin::scene
