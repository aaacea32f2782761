#pragma once

#include <limits>
#include <string_view>
#include <vector>

#include "engine/response.h"
#include "render/data/hmd.h"
#include "scene/scenario/choices.h"
#include "scene/scenario/scenario.h"

/// Every key of a scenario, with its range, its meaning and the source of its default.
namespace headpin::scene {

struct Range {
  double low, high;
};
inline constexpr Range kAny{-std::numeric_limits<double>::max(),
                            std::numeric_limits<double>::max()};
inline constexpr Range kUnit{0.0, 1.0};

using NameList = std::vector<std::string_view>;

inline NameList response_names() {
  NameList names;
  for (const engine::Response& response : engine::responses()) names.push_back(response.name);
  return names;
}

// The fields, listed once: read, written and checked by the same list. A visitor takes
// field(key, value, allowed, meaning, source) and section(key, meaning, part). The meaning is true
// of any value, the source of the default alone.

template <typename V>
void visit(V& v, Rates& r) {
  v.field("physics_hz", r.physics_hz, Range{120, 99'960}, "steps per second, a multiple of 120");
  v.field("frame_hz", r.frame_hz, Range{1, 1000}, "pictures of each eye per second");
}

template <typename V>
void visit(V& v, MeshFile& m) {
  v.field(
      "file", m.file, kAny,
      "file in glTF, OBJ, PLY, STL or OFF format, relative to the scenario's folder; empty: none");
  v.field("unit", m.unit, Range{1e-6, 1e3}, "metres per unit of the file");
  v.field("axes", m.axes, kAny,
          "directions of its +x, +y, +z: R right, L left, A ahead, P back, S up, I down");
  v.field("sha256", m.sha256, kAny,
          "SHA-256 of the file; checked if given, else filled in when the file is read");
}

template <typename V>
void visit(V& v, Room& r) {
  v.field("width", r.width, Range{1, 100},
          "distance between the side walls; the lane is in the middle");
  v.field("height", r.height, Range{1, 100}, "distance from floor to ceiling");
  v.field("behind", r.behind, Range{0.5, 100},
          "distance from the foul line to the wall behind the player");
  v.field("ahead", r.ahead, Range{1, 100},
          "distance from the foul line to the wall behind the skittles");
  v.field("solid_ceiling", r.solid_ceiling, kAny,
          "true: bodies bounce off the ceiling; false: they fly through it");
  v.section("mesh", "mesh that is drawn instead of walls and ceiling, in world coordinates",
            r.mesh);
}

template <typename V>
void visit(V& v, OilZone& z) {
  constexpr Range kOnLane{1, kBoards};
  v.field("first_board", z.first_board, kOnLane,
          "number of its first board; board 1 is at the right gutter, 20 in the middle");
  v.field("last_board", z.last_board, kOnLane, "number of its last board");
  v.field("from", z.from, Range{0, 50}, "distance of its near end from the foul line");
  v.field("to", z.to, Range{0, 50}, "distance of its far end from the foul line");
  v.field("friction", z.friction, kUnit,
          "friction of whatever touches the lane there, in place of the product of both "
          "materials: Coulomb's coefficient, or the paper's rate with collision.response 'paper'");
}

template <typename V>
void visit(V& v, Oil& o) {
  v.field("zones", o.zones, kAny,
          "zones of the oil pattern: they do not overlap and leave no hole; empty: no oil");
  v.field("dry", o.dry, kUnit,
          "friction of whatever touches the lane where a pattern has no oil, from the foul line to "
          "the skittles; without zones it has no effect",
          "Frohlich 2004");
  v.field("mirrored", o.mirrored, kAny,
          "true: the boards of the zones count from the left gutter, for left-handed players");
  v.field("wear", o.wear, kUnit,
          "part of the oil that a thrown ball takes off each board and foot that it touches; the "
          "next throw feels it; 0: the pattern stays as it is");
  v.field("carry_down", o.carry_down, kUnit,
          "part of the oil taken that the ball lays down on dry boards; without wear it has no "
          "effect");
}

template <typename V>
void visit(V& v, Lane& l) {
  v.field("width", l.width, Range{0.2, 20}, "", "41.5 in: USBC");
  v.field("head_pin", l.head_pin, Range{0.5, 50},
          "distance from the foul line to the head pin; regulation: 18.288 (60 ft: USBC)");
  v.field("masking_panel", l.masking_panel, kAny,
          "solid panel that hangs in front of the skittles; the paper does not mention one");
  v.field("kick_backs", l.kick_backs, kAny,
          "solid walls beside the skittles; the paper does not mention them");
  v.field("gutter_width", l.gutter_width, Range{0, 2},
          "width of each gutter beside the lane; usual: 0.235 (9.25 in); the paper does not "
          "mention gutters");
  v.field("gutter_depth", l.gutter_depth, Range{0, 0.5},
          "0: the gutters are only painted on a flat floor; usual: 0.048 (1 7/8 in)");
  v.section("oil", "oil on the lane; the paper does not mention any", l.oil);
}

template <typename V>
void visit(V& v, Rack& r) {
  v.field("spots", r.spots, kAny, "place of each skittle, [x right, y away] from the head pin",
          "12 in apart in a triangle: USBC");
}

template <typename V>
void visit(V& v, SkittlePart& p) {
  v.field("shape", p.shape, kNames<PartShape>, "");
  if (p.shape == PartShape::polyhedron) {
    visit(v, p.mesh);
    v.field("corners", p.corners, Range{-2, 2},
            "[x, y, z] from the middle of the base; without corners the file is used");
    v.field("faces", p.faces, kAny,
            "corner numbers of each face, from 0, counterclockwise seen from outside");
    return;
  }
  v.field("radius", p.radius, Range{1e-3, 1}, "largest radius across the axis");
  v.field("low", p.low, Range{0, 2}, "height of its lower end above the base");
  v.field("high", p.high, Range{0, 2}, "height of its upper end above the base");
}

template <typename V>
void visit(V& v, Skittle& s) {
  v.field("height", s.height, Range{0.05, 2}, "", "15.000 in: USBC");
  v.field("mass", s.mass, Range{0.01, 100}, "", "3 lb 8 oz: USBC");
  v.field("rolling_arm", s.rolling_arm, Range{0, 0.1},
          "rolling resistance: lever arm by which the load acts ahead of the contact; brings a "
          "skittle on its side to rest");
  v.field("parts", s.parts, kAny, "parts of its true collision shape, from the base upwards");
  v.field("profile", s.profile, kAny, "profile that is drawn: [height above the base, radius]",
          "USBC, necks from pin drawings");
  v.field("seen", s.seen, kNames<SeenSkittle>,
          "shape that is drawn: true (the profile) or collider (the collision shape); none of six "
          "participants noticed a change of the collision shape (table 4)");
  v.field("weighed", s.weighed, kNames<Weighed>,
          "source of centre of mass and inertia: the profile that is drawn, or the parts of the "
          "collision shape");
  v.field("ellipsoid_weighed", s.ellipsoid_weighed, kNames<WeighedEllipsoid>,
          "mass properties of a skittle that collides as an ellipsoid. alike: those of the true "
          "shape, so that the paper's factor S changes only the accuracy of collisions; itself: "
          "those of the ellipsoid, as in older trials");
  v.section("mesh",
            "mesh that is drawn instead of the profile; its origin is the middle of the base",
            s.mesh);
}

template <typename V>
void visit(V& v, Ball& b) {
  v.field("radius", b.radius, Range{0.01, 1}, "USBC allows diameters of 8.500 to 8.595 in",
          "8.54 in");
  v.field("mass", b.mass, Range{0.01, 100}, "USBC allows 16 lb", "15 lb");
  v.field("home", b.home, Range{-100, 100}, "place of its centre on the stand, in the world");
  v.field("rg", b.rg, Range{0, 1},
          "radius of gyration of its core about the pin axis, the smallest one; 0: even density; "
          "USBC allows 2.46 to 2.80 in (0.0625 to 0.0711)");
  v.field("differential", b.differential, Range{0, 0.1},
          "largest radius of gyration less rg; USBC allows 0.060 in (0.0015)");
  v.field(
      "intermediate", b.intermediate, Range{0, 0.1},
      "largest radius of gyration less that about the mass bias; 0: as large, a symmetric core");
  v.field("pin", b.pin, Range{-1, 1},
          "direction from the centre to the pin while the ball is on its stand; any length");
  v.field("mass_bias", b.mass_bias, Range{-1, 1},
          "direction from the centre to the mass bias, across the pin axis");
  v.field(
      "rings", b.rings, kAny,
      "true: eyes and pages show a ring on the ball for each revolution of its last throw on oil; "
      "on a lane without oil, for each on the lane");
  v.section("mesh", "mesh that is drawn instead; its origin is the ball's centre", b.mesh);
}

template <typename V>
void visit(V& v, Coefficients& m) {
  v.field("elasticity", m.elasticity, kUnit,
          "coefficient of restitution (the paper: elasticity); two bodies in contact: the product",
          "Uno & Slater 1997, table 1");
  v.field("friction", m.friction, kUnit,
          "friction as in the paper; two bodies in contact: the product",
          "Uno & Slater 1997, table 1");
}

template <typename V>
void visit(V& v, Materials& m) {
  v.section("skittle", "", m.skittle);
  v.section("ball", "", m.ball);
  v.section("lane", "", m.lane);
  v.section("wall", "", m.wall);
}

template <typename V>
void visit(V& v, Collision& c) {
  v.field("shape", c.shape, kNames<SkittleShape>, "collision shape of the skittles (table 1)");
  v.field(
      "detection", c.detection, kNames<Detection>,
      "paper: the iteration stops at a cap, as in 1997; converged: it goes on until it converges");
  v.field("iterations", c.iterations, Range{5, 20},
          "cap on the iterations of a query; 20 in the paper");
  v.field("warm", c.warm, kAny,
          "warm start: a query of paper detection starts from the last normal; not in the paper");
  v.field("answer", c.answer, kNames<PlaneAtCap>,
          "result of a query of paper detection at its cap. best: the best plane that it tested; "
          "last: the last plane, as in older trials");
  v.field("response", c.response, response_names(), "collision response");
  v.field("friction_tau_s", c.friction_tau_s, Range{1e-4, 10},
          "time in which a lasting contact applies the paper's friction once");
  v.field("gravity", c.gravity, Range{0, 1000}, "acceleration of gravity [m/s2]");
  v.field("sleep", c.sleep, kAny,
          "sleeping: bodies at rest are not simulated until something touches them. Skittles begin "
          "asleep; without sleeping they stay awake from their first touch on");
  v.field("rules", c.rules, Range{1, 17},
          "rules of the simulation step and the game; see docs/rules.md");
}

template <typename V>
void visit(V& v, GameRules& g) {
  v.field("rules", g.rules, kNames<GameKind>,
          "rules of the game; one-throw: no game, so nothing is counted, swept or set again");
  v.field("frames", g.frames, Range{1, 100}, "frames per game; the paper does not say how many");
  v.field("balls", g.balls, Range{1, 10}, "balls per frame");
  v.field("ball_back_s", g.ball_back_s, Range{1, 600},
          "the ball comes back and the fallen skittles are counted when all bodies are at rest, or "
          "this long after the release");
  v.field("off_spot", g.off_spot, Range{0, 10},
          "an upright skittle further from its spot than this counts as fallen");
  v.field("ends", g.ends, kNames<BallEnds>,
          "when a ball ends. rest: when all bodies are at rest and stay so; slow: at the first "
          "tick at which all are slow, even if one is at the top of its flight or in the hand");
  v.field("hand_fells", g.hand_fells, kNames<HandFells>,
          "skittles that the hand, or what it carries, knocks down. apart: removed without "
          "counting; counted: counted for the ball");
  v.field(
      "stray_fells", g.stray_fells, kNames<StrayFells>,
      "skittles that a stray ball knocks down: one that left the lane before the skittles, or that "
      "came back from behind them. apart: set up again without "
      "counting; counted: counted for the ball",
      "USBC rules, illegal pinfall");
  v.field("foul", g.foul, kNames<FoulBall>,
          "ball that is released beyond the foul line. note: there is a foul event, and the ball "
          "counts; zero: there is a foul event, and the ball counts 0; count: no event, and the "
          "ball counts",
          "the paper is silent");
  v.field("show_score", g.show_score, kAny,
          "true: a score board hangs in the room; only pictures change");
  v.field("not_stored", g.not_stored, kNames<NotStored>,
          "a game that is played in a page, when the browser cannot store it (the disk is full, or "
          "there is none). goes-on: it is kept in memory, and the player is told; ends: it ends "
          "there, or does not begin");
}

template <typename V>
void visit(V& v, Version& version) {
  v.field("button", version.button, Range{-100, 100},
          "centre of the button that starts this version");
  v.field("elasticity", version.elasticity, kUnit,
          "coefficient of restitution (the paper: elasticity) of skittles, ball, lane and walls",
          "Uno & Slater 1997, table 1");
  v.field("friction", version.friction, kUnit, "friction of skittles, ball, lane and walls",
          "Uno & Slater 1997, table 1");
  v.field("shape", version.shape, kNames<SkittleShape>, "collision shape of the skittles");
  v.field("detection", version.detection, kNames<std::optional<Detection>>,
          "collision: as in collision.detection");
  v.field("iterations", version.iterations, Range{0, 20},
          "cap on the iterations of a query, 5 to 20 (the paper's pilot study: 5 and 20); 0: as in "
          "collision.iterations");
}

template <typename V>
void visit(V& v, Versions& versions) {
  v.field("buttons", versions.buttons, kAny,
          "true: there are a red and a blue button, which the virtual hand touches");
  v.field("radius", versions.radius, Range{0.01, 0.5}, "radius of a button");
  v.section("red", "", versions.red);
  v.section("blue", "", versions.blue);
}

template <typename V>
void visit(V& v, Hand& h) {
  v.field("reach", h.reach, Range{0, 10},
          "largest distance to the surface of a body that it can grab");
  v.field("takes_skittles", h.takes_skittles, kAny,
          "true: it can grab skittles too; false: only balls");
  v.field("grip", h.grip, Range{-1, 1}, "centre of the carried ball in the frame of the hand");
  v.field("spin", h.spin, Range{-200, 200},
          "spin that the fingers add to a released ball, in the frame of the hand [rad/s]: no "
          "receiver on the back of a hand can measure it");
  v.field("solid", h.solid, kAny,
          "true: it pushes the bodies that it touches, except while it carries one");
  v.field("elasticity", h.elasticity, kUnit,
          "coefficient of restitution of a solid hand; two bodies in contact: the product");
  v.field("friction", h.friction, kUnit,
          "friction of a solid hand; two bodies in contact: the product");
  v.field("release_at", h.release_at, kNames<ReleaseAt>,
          "velocity and spin of a released ball. trigger: those of the hand at the moment of the "
          "trigger, from samples before and after it; sample: those at the last sample before it, "
          "and the ball is carried one tick ahead of the hand, as until 2026");
  v.field("release_window_s", h.release_window_s, Range{0.01, 1},
          "velocity and spin are the slope of a cubic (sample: of a parabola) that is fitted to "
          "the samples of this time before the release");
  v.field(
      "release_window_most_s", h.release_window_most_s, Range{0.01, 1},
      "longest time for that fit, if the tracker is noisy and `release_window_s` is not longer");
  v.field("release_accuracy", h.release_accuracy, Range{0, 1000},
          "the time for the fit grows while the standard error of the velocity is above this");
  v.field("falls_at_once", h.falls_at_once, kAny,
          "true: a body that is released between two ticks falls from that moment, not from the "
          "start of its tick, so that the result depends less on the times of the ticks");
  v.section("mesh",
            "mesh that is drawn instead of the open and the gripping hand; its origin is the "
            "middle of the palm, the fingers point ahead",
            h.mesh);
}

template <typename V>
void visit(V& v, ReleaseChange& r) {
  v.field("speed", r.speed, Range{0, 10}, "factor of its velocity");
  v.field("direction_deg", r.direction_deg, Range{-180, 180}, "turn of its velocity to the right");
  v.field("height", r.height, Range{-2, 2},
          "it is released so much higher; a ball below the floor is put on it");
  v.field("boards", r.boards, Range{-kBoards, kBoards},
          "it is released so many boards further to the left");
  v.field("revs", r.revs, Range{0, 100}, "factor of its spin");
  v.field("rotation_deg", r.rotation_deg, Range{-180, 180},
          "turn of the axis of its spin to the left, seen from above: more axis rotation");
  v.field("spin", r.spin, Range{-1000, 1000},
          "spin about the level direction of the throw that is then added [rad/s]; with friction, "
          "the ball curves to the right; 0 with speed 0, because a ball at rest has no direction");
}

template <typename V>
void visit(V& v, Walking& w) {
  v.field("along", w.along, kNames<WalkAlong>,
          "direction of walking: gaze (of the head) or hand; the paper names only the buttons");
  v.field("speed", w.speed, Range{0, 10}, "walking speed with the thumb buttons", "an easy walk");
  v.field("acceleration", w.acceleration, Range{0.1, 1000},
          "acceleration to the walking speed and back to rest");
  v.field("clearance", w.clearance, Range{0, 1},
          "smallest distance of the head from a wall when walking");
}

template <typename V>
void visit(V& v, Rig& r) {
  v.field("head_station", r.head_station, Range{1, 64}, "station of the receiver on the head");
  v.field("hand_station", r.hand_station, Range{1, 64},
          "station of the receiver on the 3D mouse in the hand");
  v.field("X_WT", r.X_WT, kAny,
          "pose of the transmitter in the world, before any walk; q is w, x, y, z");
  v.field("X_SD", r.X_SD, kAny, "pose of the display in the frame of the head's receiver");
  v.field("X_SH", r.X_SH, kAny, "pose of the virtual hand in the frame of the hand's receiver");
  v.field("delay_s", r.delay_s, Range{0, 1},
          "poses are interpolated this long before the present; 0: the last sample is used");
  v.field("predicted_s", r.predicted_s, Range{0, 1},
          "the device predicts: it tells poses at least this long before the time that they are "
          "for; a release uses them up to then");
  v.field("away_after_s", r.away_after_s, Range{0, 10},
          "a hand that nothing has shown for longer is nowhere; 0: it stays at its last pose");
}

template <typename V>
void visit(V& v, Hmd& h) {
  v.field("profile", h, kAny,
          "one of " + render::hmd_profile_names() + "; the values below override it");
  render::Optics& o = h.optics;
  v.field("width", o.width, Range{1, 16384}, "pixels per eye", "Uno & Slater 1997, section 3");
  v.field("height", o.height, Range{1, 16384}, "");
  v.field("horizontal_fov_deg", o.horizontal_fov_deg, Range{1, 170},
          "horizontal field of view of an eye");
  v.field("vertical_fov_deg", o.vertical_fov_deg, Range{1, 170},
          "vertical field of view of an eye");
  constexpr Range kEdge{0, 85};
  v.field("outer_deg", o.outer_deg, kEdge,
          "angle from an eye's axis to the edge at the temple; 0: half of horizontal_fov_deg");
  v.field("inner_deg", o.inner_deg, kEdge,
          "angle from an eye's axis to the edge at the nose; 0: half of horizontal_fov_deg");
  v.field("up_deg", o.up_deg, kEdge,
          "angle from an eye's axis to the upper edge; 0: half of vertical_fov_deg");
  v.field("down_deg", o.down_deg, kEdge,
          "angle from an eye's axis to the lower edge; 0: half of vertical_fov_deg");
  v.field("eye_distance", o.eye_distance, Range{0, 1}, "distance between the eyes",
          "64 mm between the LEEP lenses' axes");
  v.field("outward_deg", o.outward_deg, Range{-60, 60},
          "angle by which each eye's axis is turned outward");
  v.field(
      "relay_width", o.relay_width, Range{0, 4096},
      "width of the picture that is drawn and then scaled to the display; 0: that of the display");
  v.field("relay_height", o.relay_height, Range{0, 4096},
          "height of that picture; 0: that of the display");
  v.field("lens_k1", o.lens_k1, Range{0, 2},
          "distortion of the lens: it shows the point s in the direction s (1 + k1 s^2 + k2 s^4), "
          "with s = 1 at the outer edge; the pictures are drawn with the inverse");
  v.field("lens_k2", o.lens_k2, Range{0, 2}, "second coefficient of that distortion");
}

template <typename V>
void visit(V& v, render::Quality& q) {
  v.field(
      "samples", q.samples, Range{1, 8},
      "anti-aliasing: a pixel is the mean light of N^2 + 1 samples, or of one sample with N = 1");
  v.field("contact", q.contact, kAny,
          "contact shadows: floors are darker beneath and beside bodies");
  v.field("shadow", q.shadow, kAny, "bodies cast shadows on floors and bodies");
  v.field("mirror", q.mirror, kAny, "polished floors reflect what stands on them");
  v.field("light", q.light, kNames<render::LightPer>,
          "where the light of the lamps is computed: per pixel or per vertex");
}

template <typename V>
void visit(V& v, Sound& s) {
  v.field(
      "on", s.on, kAny,
      "true: balls, skittles and lane sound when they collide, and a ball when it rolls: in the "
      "videos of `headpin frames` and in the page of `headpin play`");
}

template <typename V>
void visit(V& v, Scenario& s) {
  v.field("name", s.name, kAny, "");
  v.section("rates", "", s.rates);
  v.section("room", "metre, kilogram, second unless a name says otherwise", s.room);
  v.section("lane", "", s.lane);
  v.section("rack", "", s.rack);
  v.section("skittle", "", s.skittle);
  v.section("ball", "", s.ball);
  v.section("material", "", s.material);
  v.section("collision", "", s.collision);
  v.section("game", "", s.game);
  v.section("version", "", s.version);
  v.section("hand", "", s.hand);
  v.section("release", "what if a ball left the hand differently from how the hand moved",
            s.release);
  v.section("walk", "", s.walk);
  v.section("rig", "", s.rig);
  v.section("hmd", "", s.hmd);
  v.section("look", "rendering quality of the pictures", s.look);
  v.section("sound", "", s.sound);
}

}  // namespace headpin::scene
