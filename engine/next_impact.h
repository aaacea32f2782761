#pragma once

#include "engine/meeting.h"

/// The next possible impact of a touch; and what lasts of it, if there is none. Private to the engine.
namespace headpin::engine::detail {

/// Approach speed above which a touch is followed [m/s]. A body that turns fast meets with one point after
/// the other; slow meetings must not use up its number of impacts.
double threshold_of(const World& world, const Flight& flight, const Touches& touches,
                    const Touch& touch);

/// Time of the next possible impact of a touch, from its present contact points; kNever without any [s].
/// Then the points that are no lasting contacts are removed.
double next_impact(const World& world, const Flight& flight, Touches& touches, Touch& touch);

/// Removes the points of a touch, which has no impact, that are no lasting contacts.
void leave_what_lasts(const World& world, const Flight& flight, Touches& touches, Touch& touch);

/// Notes the next possible impacts of all touches in `Touches::due`.
void note_next_impacts(const World& world, const Flight& flight, Touches& touches);

}  // namespace headpin::engine::detail
