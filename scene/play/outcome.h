#pragma once

#include <span>
#include <string>

#include "scene/record/trial.h"

namespace headpin::scene {

/// Whether this event says that a ball, not the hand, felled skittles: one leaned too far, or some
/// were counted, which may also stand upright away from their spots.
bool says_that_some_fell(const Event& event);

/// The reason why no skittle fell, from the events of a session: the ball was not grabbed, not
/// released, missed, or was too slow, or the hand took skittles only. One sentence; empty if a skittle fell.
std::string why_nothing_fell(std::span<const Event> events);

}  // namespace headpin::scene
