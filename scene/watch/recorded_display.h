#pragma once

#include <span>
#include <string>
#include <vector>

#include "scene/record/trial.h"

namespace headpin::scene {

/// The display of the headset that a session was played with, from its event `played_with`: keys of a
/// scenario, "hmd.KEY=VALUE". Both eyes get the mean of their angles. Of a headset that did not tell
/// its pixels, they are square, and 1000 lie along the longer side.
///
/// @throws std::invalid_argument  when no event tells of the views of both eyes, or with impossible
///                                numbers
std::vector<std::string> recorded_display(std::span<const Event> events);

}  // namespace headpin::scene
