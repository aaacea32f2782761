#pragma once

#include <string>

#include "scene/scenario/scenario.h"
#include "scene/stage/read_scenario.h"
#include "tests/support/folder.h"

namespace headpin::scene {

/// What a scenario of that text is refused for; empty when it is not.
inline std::string refusal(const std::string& toml) {
  return complaint([&] { parse_scenario(toml, "lane.toml"); });
}

}  // namespace headpin::scene
