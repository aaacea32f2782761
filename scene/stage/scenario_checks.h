#pragma once

#include <string_view>

#include "scene/scenario/text.h"

namespace headpin::scene {

/// Checks that the values of a scenario fit together.
///
/// @param where  name of the text, for messages
/// @throws std::invalid_argument  naming text, line, key, what was found and what is allowed
void check(const Scenario& scenario, std::string_view where, const Lines& lines);

/// Further checks that are not made for trials, because old trials may have such values: one
/// station for head and hand, bonuses for frames of more than two balls.
void check_chosen(const Scenario& scenario, std::string_view where, const Lines& lines);

}  // namespace headpin::scene
