#pragma once

#include "engine/paths.h"

/// The stages of a step, in their order: each takes what those before it gave. For step.cpp; users
/// call `step`.
namespace headpin::engine::detail {

/// Pairs that are close enough to meet within the step, with their contact points at its start, all
/// bodies being there (`Workspace::flight`). A sleeping body that something moving touches is woken.
Touches& find_touches(World& world, Workspace& w);

/// Impulses where bodies meet within the step, one after the other as they happen, until no pair
/// approaches. A body that is struck is brought to where that happens.
///
/// @param touches  points as they are after the last impact; none where two pass each other
/// @return         null when a sleeping body was hit: it is awake now, all bodies are back at the
///   start of the step, and touches must be found again
const Flight* resolve_impacts(World& world, Touches& touches, Workspace& w);

/// Lasting contacts: elasticity 0, impulses accumulated and clamped, island by island.
Solved& sustain(World& world, const Touches& touches, const Flight& flight, Workspace& w);

/// What turns far within a step may swing deep into what it lies on, by points that were not near
/// when its contacts were found: those are stopped, without elasticity.
void stop_swings(World& world, const Touches& touches, const Flight& flight, Solved& solved,
                 Workspace& w);

/// Along the paths to the end of the step: exact for free bodies, by the end velocity for carried.
void move(World& world, const Flight& flight, const Solved& solved);

/// Takes overlaps back without adding speed.
void push_apart(World& world, const Touches& touches, const Flight& flight, const Solved& solved,
                Workspace& w);

/// Islands that have been still for long enough are left out from now on.
void fall_asleep(World& world, const Touches& touches, const Flight& flight, Solved& solved);

/// Keeps the contacts of this step as the start of the next one's, and tells which of the step's
/// events are the first between two bodies; drops lasting touches of bodies that had met before.
void remember(World& world, Touches& touches, const Flight& flight, Solved& solved);

}  // namespace headpin::engine::detail
