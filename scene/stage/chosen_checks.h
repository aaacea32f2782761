#pragma once

#include "scene/scenario/text.h"

namespace headpin::scene {

/// Checks that values which a person chose fit together, in the sections of which the text has keys.
///
/// Not for the whole scenario of a trial: old trials may have one station for head and hand, bonuses
/// for frames of more than two balls, a spin without a direction to be about, a picture without
/// width, and buttons above the ceiling.
///
/// @throws std::invalid_argument  naming text, line, key, what was found and what is allowed
void check_chosen(const Scenario& scenario, const ScenarioText& text);

}  // namespace headpin::scene
