#pragma once

#include <string_view>

#include "scene/scenario/text.h"

namespace headpin::scene {

/// What no single value can tell: whether the things of a scenario fit each other and the room.
///
/// @param where  name of the text, for messages
/// @throws std::invalid_argument  naming text, line, key, what was found and what is allowed
void check(const Scenario& scenario, std::string_view where, const Lines& lines);

/// What nobody chooses on purpose, but what recorded trials may have run under: sensors that are one,
/// bonuses for frames of more than two balls. As `check`, and not for trials.
void check_chosen(const Scenario& scenario, std::string_view where, const Lines& lines);

}  // namespace headpin::scene
