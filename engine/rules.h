#pragma once

#include "engine/world.h"

/// What the step does since which number of its rules (Parameters::rules).
///
/// A trial keeps the rules that it was recorded under, so that its replay has the same bits. All
/// that is done for older rules alone is behind one of these questions.
namespace headpin::engine::detail {

// Since rules 2: squeezed, just landed and sleeping bodies.

/// A body that a driven one presses gets no more speed and energy than a throw would give it.
inline bool bounds_squeezes(const Parameters& p) {
  return p.rules >= 2;
}

/// A point that will meet just after the end of the step is an impact of the next step.
inline bool leaves_late_landings(const Parameters& p) {
  return p.rules >= 2;
}

/// Only a body that is carried falls asleep, and only on a body that does not move.
inline bool sleepers_are_carried(const Parameters& p) {
  return p.rules >= 2;
}

// Since rules 3: bodies that turn far within a step.

/// The path of a body that turns far is followed until the end of the step, and back.
inline bool follows_far_turns(const Parameters& p) {
  return p.rules >= 3;
}

// Since rules 4: lasting contacts.

/// After a few passes an island is solved directly; its residual follows from what it carries.
inline bool solves_directly(const Parameters& p) {
  return p.rules >= 4;
}

/// Friction at its limit is opposite to the slip; before, only nearly.
inline bool opposes_slip(const Parameters& p) {
  return p.rules >= 4;
}

/// A point that is new under its number starts from the load that was in its place.
inline bool keeps_loads_in_place(const Parameters& p) {
  return p.rules >= 4;
}

// Since rules 6: what slides, and bodies beside a flat one.

/// Bodies that slide on a level surface at Coulomb's limit move with the mean of their velocities.
inline bool moves_with_the_mean(const Parameters& p) {
  return p.rules >= 6;
}

/// A fixed body of flat faces is a candidate only for bodies that its box meets.
inline bool bounds_flat_bodies(const Parameters& p) {
  return p.rules >= 6;
}

// Since rules 7: rooms that are no half-spaces.

/// Detection against an exact body converges also in the paper's mode, whose iterations end far from the
/// answer between a ball and a lane.
inline bool keeps_rooms_exact(const Parameters& p) {
  return p.rules >= 7;
}

// Since rules 8: Coulomb's law where bodies meet without a slip. See response_under() in response.h.

// Since rules 9: how the bodies of a scene are made. See skittle_body() in scene/stage/bodies.cpp.
// Since rules 14: how overlapping parts of a skittle are weighed. See rods_of() there.

// Since rules 10: floors and walls of several parts.

/// What touches several parts of a fixed body touches each of them, as if they were bodies of their own.
/// In one touch, a part far away may push what another part carries, and friction has one plane for all.
inline bool touches_each_part(const Parameters& p) {
  return p.rules >= 10;
}

/// Where flat faces of fixed parts join to one plane, nothing meets the edges between them.
inline bool joins_faces(const Parameters& p) {
  return p.rules >= 10;
}

/// The arm of twisting friction is measured across its normal: in a groove it is none.
inline bool spreads_across(const Parameters& p) {
  return p.rules >= 10;
}

// Since rules 11: what is slow or far does not hide what is fast.

/// A search for an impact leaves lasting contacts of the same two bodies out, and leaves them as they are.
inline bool leaves_out_what_lasts(const Parameters& p) {
  return p.rules >= 11;
}

/// Under the paper's detection bodies that are apart have no contact points; those that are about to meet are
/// followed to the end of the step.
inline bool looks_ahead(const Parameters& p) {
  return p.rules >= 11 && p.query.mode == Query::paper;
}

/// Friction of the paper's law, which does not depend on the load, does not act by a load of rounding alone.
inline bool rounds_loads(const Parameters& p) {
  return p.rules >= 11;
}

// Since rules 13: how ellipsoids are drawn. See drawn_centres() in scene/looks/looks.cpp.

// Since rules 14: what turns fast on a floor, at a low rate or where it is small.

/// What gravity alone presses together within a step stays a lasting contact, also where that overlap is deep
/// for the bodies. As an impact in each step it had next to no friction, and no rolling resistance.
inline bool rests_under_gravity(const Parameters& p) {
  return p.rules >= 14;
}

// Since rules 15: what turns back within a step, and what only grazes.

/// After each of its impacts a body is searched for all bodies on its new path, also where it is no faster, and
/// also for those that an impact made faster.
inline bool seeks_after_each_turn(const Parameters& p) {
  return p.rules >= 15;
}

/// Under the paper's detection, bodies that overlap in the middle of a step alone meet there.
inline bool looks_often(const Parameters& p) {
  return p.rules >= 15;
}

// Since rules 16: how lasting contacts are solved.

/// An island gets accelerated passes before it is solved directly, which is for stacks and not for piles, and ends
/// where it comes no closer. A crowd in motion is solved to a part of what its contacts change. Passes are
/// accelerated by another method.
inline bool speeds_up_first(const Parameters& p) {
  return p.rules >= 16;
}

// Since rules 17: lasting contacts that are carried, twisted or on each other.

/// What one driven body alone holds may move with it, at any speed. Elsewhere, what it carries has the speed of a throw
/// without elasticity, and rounding makes no throw of it.
inline bool knows_carried(const Parameters& p) {
  return p.rules >= 17;
}

/// A pass that changes twist or rolling has not solved an island either.
inline bool counts_turning(const Parameters& p) {
  return p.rules >= 17;
}

/// A crowd of slow bodies is solved more exactly than one in motion.
inline bool keeps_crowds_standing(const Parameters& p) {
  return p.rules >= 17;
}

/// Friction of the last step is stored as that on the first body of the key. Which of two bodies is A changes where
/// one becomes free or driven, sleeps or wakes: friction then began with the wrong sign.
inline bool keeps_sides(const Parameters& p) {
  return p.rules >= 17;
}

/// The query with what older rules lack switched off.
inline Query query_under(const Parameters& p) {
  Query query = p.query;
  query.steady = query.steady && p.rules >= 4;  // numbers of points stay the same
  query.faces = query.faces && p.rules >= 5;    // single faces carry like half-spaces
  query.boxes = query.boxes && p.rules >= 6;    // parts are left out by their boxes
  return query;
}

}  // namespace headpin::engine::detail
