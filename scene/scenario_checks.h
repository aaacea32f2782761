#pragma once

#include <map>
#include <string>
#include <string_view>

#include "scene/scenario.h"

namespace headpin::scene {

/// On which line of a text a key stands: "ball.mass" -> 3; "rack.spots[2]" is the second of an
/// array.
using Lines = std::map<std::string, int>;

/// What no single value can tell: whether the things of a scenario fit each other and the room.
///
/// @param where  name of the text, for messages
/// @throws std::invalid_argument  naming text, line, key, what was found and what is allowed
void check(const Scenario& scenario, std::string_view where, const Lines& lines);

/// What nobody chooses on purpose, but what recorded trials may have run under: sensors that are one,
/// bonuses for frames of more than two balls. As `check`, and not for trials.
void check_chosen(const Scenario& scenario, std::string_view where, const Lines& lines);

}  // namespace headpin::scene
