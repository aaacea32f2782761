#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "scene/scenario/text.h"

namespace headpin::scene {

/// Checks that the values of a scenario fit together.
///
/// @param where  name of the text, for messages
/// @throws std::invalid_argument  naming text, line, key, what was found and what is allowed
void check(const Scenario& scenario, std::string_view where, const Lines& lines);

/// Refuses a scenario for the value of a key.
///
/// @param what    what is allowed and what was found: "must be 0 to 1, found 2"
/// @param others  keys with which it does not agree; the user may have set one of them instead
/// @throws std::invalid_argument  always, naming the line of the first of these keys that has one
[[noreturn]] void refuse_key(std::string_view where, const Lines& lines, const std::string& key,
                             const std::string& what, std::vector<std::string> others = {});

}  // namespace headpin::scene
