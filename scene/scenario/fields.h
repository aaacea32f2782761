#pragma once

#include <limits>
#include <string_view>
#include <vector>

#include "engine/response.h"
#include "render/data/hmd.h"
#include "scene/scenario/rules.h"
#include "scene/scenario/scenario.h"

/// Every key of a scenario, with its range, its meaning and the source of its default.
namespace headpin::scene {

struct Range {
  double low, high;
};
inline constexpr Range kAny{-std::numeric_limits<double>::max(),
                            std::numeric_limits<double>::max()};
inline constexpr Range kUnit{0.0, 1.0};

using Choices = std::vector<std::string_view>;

inline Choices response_names() {
  Choices names;
  for (const engine::Response& response : engine::responses()) names.push_back(response.name);
  return names;
}

inline Choices rules_names() {
  Choices names;
  for (const Rules& rules : all_rules()) names.push_back(rules.name);
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
  v.field("file", m.file, kAny,
          "glTF, OBJ, PLY, STL or OFF, named from the scenario's folder; empty: none");
  v.field("unit", m.unit, Range{1e-6, 1e3}, "metres per unit of the file");
  v.field("axes", m.axes, kAny,
          "where its +x, +y, +z point: R right, L left, A ahead, P back, S up, I down");
  v.field("sha256", m.sha256, kAny, "of the file; found when it is read, checked where given");
}

template <typename V>
void visit(V& v, Room& r) {
  v.field("width", r.width, Range{1, 100}, "wall to wall, the lane in the middle");
  v.field("height", r.height, Range{1, 100}, "floor to ceiling");
  v.field("behind", r.behind, Range{0.5, 100}, "foul line to the wall behind the player");
  v.field("ahead", r.ahead, Range{1, 100}, "foul line to the wall behind the skittles");
  v.field("solid_ceiling", r.solid_ceiling, kAny, "what flies up comes back; false: it flies on");
  v.section("mesh", "seen in place of walls and ceiling, in the world", r.mesh);
}

template <typename V>
void visit(V& v, Lane& l) {
  v.field("width", l.width, Range{0.2, 20}, "", "41.5 in: USBC");
  v.field("head_pin", l.head_pin, Range{0.5, 50},
          "foul line to head pin; 18.288 is regulation (60 ft: USBC)");
  v.field("masking_panel", l.masking_panel, kAny,
          "solid, hangs before the skittles; the paper tells of none");
  v.field("kick_backs", l.kick_backs, kAny,
          "solid walls beside the skittles; the paper tells of none");
  v.field("gutter_width", l.gutter_width, Range{0, 2},
          "of each, beside the lane; 0.235 is usual (9.25 in); the paper tells of none");
  v.field("gutter_depth", l.gutter_depth, Range{0, 0.5},
          "0: painted on the floor, which is flat then; 0.048 is usual (1 7/8 in)");
}

template <typename V>
void visit(V& v, Rack& r) {
  v.field("spots", r.spots, kAny, "[x right, y away] from the head pin's spot",
          "12 in apart in a triangle: USBC");
}

template <typename V>
void visit(V& v, SkittlePart& p) {
  v.field("shape", p.shape, Choices{"ellipsoid", "cylinder", "cone", "polyhedron"}, "");
  if (p.shape == "polyhedron") {
    visit(v, p.mesh);
    v.field("corners", p.corners, Range{-2, 2},
            "[x, y, z] from the middle of the base; from the file where there are none");
    v.field("faces", p.faces, kAny, "corners of each, counted from 0, counterclockwise outside");
    return;
  }
  v.field("radius", p.radius, Range{1e-3, 1}, "across the axis");
  v.field("low", p.low, Range{0, 2}, "above the base");
  v.field("high", p.high, Range{0, 2}, "above the base");
}

template <typename V>
void visit(V& v, Skittle& s) {
  v.field("height", s.height, Range{0.05, 2}, "", "15.000 in: USBC");
  v.field("mass", s.mass, Range{0.01, 100}, "", "3 lb 8 oz: USBC");
  v.field("rolling_arm", s.rolling_arm, Range{0, 0.1},
          "rolling resistance: its load acts this far ahead; brings a skittle on its side to rest");
  v.field("parts", s.parts, kAny, "its true shape as collisions see it, base upwards");
  v.field("profile", s.profile, kAny, "[height above the base, radius] as eyes see it",
          "USBC, necks from pin drawings");
  v.field("seen", s.seen, Choices{"true", "collider"},
          "what the eyes see: the profile, or what it collides as; none of six "
          "noticed a change of the shape that collides (table 4)");
  v.field("weighed", s.weighed, Choices{"profile", "parts"},
          "whose centre of mass and inertia it has: of what is seen, or of its parts");
  v.field(
      "ellipsoid_weighed", s.ellipsoid_weighed, Choices{"alike", "itself"},
      "alike: an ellipsoid has mass, centre and inertia of the true shape, so that the paper's S "
      "is the accuracy of collisions alone; itself: its own, as trials were recorded before");
  v.section("mesh", "seen in place of the profile, from the middle of the base", s.mesh);
}

template <typename V>
void visit(V& v, Ball& b) {
  v.field("radius", b.radius, Range{0.01, 1}, "USBC allows 8.500 to 8.595 in across", "8.54 in");
  v.field("mass", b.mass, Range{0.01, 100}, "USBC allows 16 lb", "15 lb");
  v.field("home", b.home, Range{-100, 100}, "its centre on the stand, in the world");
  v.section("mesh", "seen in its place, from its centre", b.mesh);
}

template <typename V>
void visit(V& v, Coefficients& m) {
  v.field("elasticity", m.elasticity, kUnit, "a pair takes the product",
          "Uno & Slater 1997, table 1");
  v.field("friction", m.friction, kUnit, "a pair takes the product", "Uno & Slater 1997, table 1");
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
  v.field("shape", c.shape, Choices{"true", "ellipsoid"}, "table 1");
  v.field("detection", c.detection, Choices{"converged", "paper"},
          "paper: the iteration stops at the cap, as in 1997");
  v.field("iterations", c.iterations, Range{5, 20}, "cap of a query; 20 in the paper");
  v.field("warm", c.warm, kAny, "paper detection starts from the last normal; not so in 1997");
  v.field("answer", c.answer, Choices{"best", "last"},
          "paper detection answers from the best plane that it looked at, as it turns to it; last: "
          "as trials were recorded before");
  v.field("response", c.response, response_names(), "");
  v.field("friction_tau_s", c.friction_tau_s, Range{1e-4, 10},
          "a lasting contact applies the paper's friction once in this time");
  v.field("gravity", c.gravity, Range{0, 1000}, "");
  v.field("sleep", c.sleep, kAny, "bodies at rest are left alone until touched");
  v.field("rules", c.rules, Range{1, 2},
          "of the step; 1: as in trials of before this key, with what it then did wrong of things "
          "squeezed, landing just behind a step's end, or asleep uncarried");
}

template <typename V>
void visit(V& v, GameRules& g) {
  v.field("rules", g.rules, rules_names(), "one-throw: nothing is counted, swept or set again");
  v.field("frames", g.frames, Range{1, 100}, "of a game; the paper does not say how many");
  v.field("balls", g.balls, Range{1, 10}, "of a frame");
  v.field(
      "ball_back_s", g.ball_back_s, Range{1, 600},
      "the ball comes back, and what is down counts, when all is at rest or so long after it was "
      "let go");
  v.field("off_spot", g.off_spot, Range{0, 10},
          "an upright skittle further from its spot than this is down too");
  v.field("ends", g.ends, Choices{"rest", "slow"},
          "a ball is over when all is at rest and stays so; slow: as soon as all is slow at one "
          "tick, be it at the top of its flight or in the hand");
  v.field("hand_fells", g.hand_fells, Choices{"apart", "counted"},
          "what the hand fells, or what it carries, is set aside; counted: it is the ball's");
  v.field("foul", g.foul, Choices{"note", "zero", "count"},
          "a ball let go beyond the foul line: noted and counted; zero: noted and counted as none; "
          "count: not even noted",
          "the paper is silent");
}

template <typename V>
void visit(V& v, Version& version) {
  v.field("button", version.button, Range{-100, 100}, "centre of the button that starts it");
  v.field("elasticity", version.elasticity, kUnit, "of skittles, ball, lane and walls",
          "Uno & Slater 1997, table 1");
  v.field("friction", version.friction, kUnit, "of skittles, ball, lane and walls",
          "Uno & Slater 1997, table 1");
  v.field("shape", version.shape, Choices{"true", "ellipsoid"}, "of the skittles, as they collide");
  v.field("detection", version.detection, Choices{"collision", "converged", "paper"},
          "collision: as collision.detection");
  v.field("iterations", version.iterations, Range{0, 20},
          "cap of a query, 5 to 20 (the paper's pilot: 5 against 20); 0: as collision.iterations");
}

template <typename V>
void visit(V& v, Versions& versions) {
  v.field("buttons", versions.buttons, kAny, "a red and a blue one, which the hand touches");
  v.field("radius", versions.radius, Range{0.01, 0.5}, "of a button");
  v.section("red", "", versions.red);
  v.section("blue", "", versions.blue);
}

template <typename V>
void visit(V& v, Hand& h) {
  v.field("reach", h.reach, Range{0, 10}, "grabs what has its surface this near");
  v.field("takes_skittles", h.takes_skittles, kAny, "grabs skittles too, not balls alone");
  v.field("grip", h.grip, Range{-1, 1}, "centre of the carried ball in the hand");
  v.field("solid", h.solid, kAny, "pushes what it touches; away while it carries something");
  v.field("elasticity", h.elasticity, kUnit, "of a solid hand; a pair takes the product");
  v.field("friction", h.friction, kUnit, "likewise");
  v.field(
      "release_at", h.release_at, Choices{"trigger", "sample"},
      "the ball gets the velocity and spin that the hand has as the trigger goes up, by samples "
      "of before and after; or had at the last sample before, and is carried a tick ahead of "
      "the hand, as until 2026");
  v.field("release_window_s", h.release_window_s, Range{0.01, 1},
          "they are the slope of a cubic fitted over so long before (sample: of a parabola)");
  v.field("release_window_most_s", h.release_window_most_s, Range{0.01, 1},
          "and over up to this where the tracker is noisy");
  v.field("release_accuracy", h.release_accuracy, Range{0, 1000},
          "that is, while the fit knows it worse than this");
  v.field(
      "falls_at_once", h.falls_at_once, kAny,
      "what is let go between two ticks falls from that moment on, not from the next tick: where "
      "the ticks are matters less then");
  v.section("mesh", "seen in its place, open and gripping; the palm's middle, fingers ahead",
            h.mesh);
}

template <typename V>
void visit(V& v, Walking& w) {
  v.field(
      "along", w.along, Choices{"gaze", "hand"},
      "which way forward is: where the head looks or where the hand points; ours, the paper says "
      "only by which buttons");
  v.field("speed", w.speed, Range{0, 10}, "of a walk by the thumbs", "an easy walk");
  v.field("acceleration", w.acceleration, Range{0.1, 1000}, "up to it and back to rest");
  v.field("clearance", w.clearance, Range{0, 1}, "a walk brings the head no nearer to a wall");
}

template <typename V>
void visit(V& v, Rig& r) {
  v.field("head_station", r.head_station, Range{1, 4}, "of the sensor worn on the head");
  v.field("hand_station", r.hand_station, Range{1, 4}, "of the one on the 3D mouse in the hand");
  v.field("X_WT", r.X_WT, kAny, "transmitter in the world, until somebody walks; q is w, x, y, z");
  v.field("X_SD", r.X_SD, kAny, "head's receiver to display");
  v.field("X_SH", r.X_SH, kAny, "hand's receiver to virtual hand");
  v.field("delay_s", r.delay_s, Range{0, 1},
          "poses are read this long before now, between two samples; 0 holds the last");
}

template <typename V>
void visit(V& v, Hmd& h) {
  v.field("profile", h, kAny,
          "one of " + render::hmd_profile_names() + "; values given here override it");
  render::Optics& o = h.optics;
  v.field("width", o.width, Range{1, 16384}, "pixels of an eye", "Uno & Slater 1997, section 3");
  v.field("height", o.height, Range{1, 16384}, "");
  v.field("horizontal_fov_deg", o.horizontal_fov_deg, Range{1, 170}, "of an eye");
  v.field("vertical_fov_deg", o.vertical_fov_deg, Range{1, 170}, "of an eye");
  constexpr Range kEdge{0, 85};
  v.field("outer_deg", o.outer_deg, kEdge,
          "an eye's axis to the edge at the temple; 0: half of horizontal_fov_deg");
  v.field("inner_deg", o.inner_deg, kEdge, "to the edge at the nose; likewise");
  v.field("up_deg", o.up_deg, kEdge, "to the upper edge; 0: half of vertical_fov_deg");
  v.field("down_deg", o.down_deg, kEdge, "to the lower edge; likewise");
  v.field("eye_distance", o.eye_distance, Range{0, 1}, "between the eyes",
          "64 mm between the LEEP lenses' axes");
  v.field("outward_deg", o.outward_deg, Range{-60, 60}, "each eye's axis turned outward");
  v.field("relay_width", o.relay_width, Range{0, 4096},
          "pixels that are drawn and relayed to those of the display; 0: its own");
  v.field("relay_height", o.relay_height, Range{0, 4096}, "likewise");
  v.field(
      "lens_k1", o.lens_k1, Range{0, 2},
      "a lens shows s in the direction s (1 + k1 s^2 + k2 s^4), s = 1 at the outer edge; pictures "
      "are drawn against that");
  v.field("lens_k2", o.lens_k2, Range{0, 2}, "likewise");
}

template <typename V>
void visit(V& v, render::Quality& q) {
  v.field("samples", q.samples, Range{1, 8},
          "a pixel is the mean light of so many, squared, and one; 1 is one");
  v.field("contact", q.contact, kAny, "floors darken beneath and beside bodies");
  v.field("shadow", q.shadow, kAny, "bodies cast shadows on floors and bodies");
  v.field("mirror", q.mirror, kAny, "polished floors mirror what stands on them");
  v.field("light", q.light, Choices{"pixel", "vertex"}, "where lamps light bodies");
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
  v.section("walk", "", s.walk);
  v.section("rig", "", s.rig);
  v.section("hmd", "", s.hmd);
  v.section("look", "what is spent on a picture", s.look);
}

}  // namespace headpin::scene
