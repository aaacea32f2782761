#pragma once

#include "engine/paths.h"

/// The stages of a step, in their order; each uses the results of the earlier ones. They are for
/// step.cpp; users call `step`.
namespace headpin::engine::detail {

/// Finds pairs of bodies that are close enough to meet within the step, their contact points at the
/// start of the step, and when each pair may have its first impact. Wakes sleeping bodies that a moving
/// body touches.
Touches& find_touches(World& world, Workspace& w);

/// Applies impulses where bodies meet within the step, in order of time, until no pair approaches.
/// A body that is struck is moved to the time of its impact.
///
/// @param touches  gets the points after the last impact; none where two bodies pass each other
/// @return         null if a sleeping body was hit: it is awake now, all bodies are back at the
///   start of the step, and touches must be found again
const Flight* resolve_impacts(World& world, Touches& touches, Workspace& w);

/// Solves lasting contacts island by island: restitution 0, impulses accumulated and clamped.
Solved& sustain(World& world, const Touches& touches, const Flight& flight, Workspace& w);

/// A body that turns far within a step may swing deep into its support with points that were not
/// near when contacts were found. Stops such bodies, without restitution.
void stop_swings(World& world, const Touches& touches, const Flight& flight, Solved& solved,
                 Workspace& w);

/// Moves bodies to the end of the step: free bodies exactly, carried ones by their end velocity.
void move(World& world, const Flight& flight, const Solved& solved, Workspace& w);

/// Corrects overlaps without adding speed.
void push_apart(World& world, const Touches& touches, const Flight& flight, const Solved& solved,
                Workspace& w);

/// Puts islands to sleep that have been at rest for long enough.
void fall_asleep(World& world, const Touches& touches, const Flight& flight, Solved& solved);

/// Stores the contacts of this step for the warm start of the next one, and marks the events that
/// are the first between two bodies. Drops lasting touches of bodies that had met before.
void remember(World& world, Touches& touches, const Flight& flight, Solved& solved, Workspace& w);

}  // namespace headpin::engine::detail
