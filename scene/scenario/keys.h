#pragma once

#include <string>
#include <vector>

#include "scene/scenario/scenario.h"

namespace headpin::scene {

/// One key of a scenario, for documentation.
struct ScenarioKey {
  std::string key;       ///< as it is written: "ball.mass"; `[]` stands for an entry of a list
  std::string kind;      ///< of its value; "table" for a section that has something to say
  std::string allowed;   ///< range or choices; empty where anything of the kind goes
  std::string fallback;  ///< value where the scenario leaves it out; empty for lists
  std::string meaning;   ///< empty where the name says it
  std::string source;    ///< of the default, where it has one
};

/// All keys, in the order of to_toml.
std::vector<ScenarioKey> scenario_keys();

}  // namespace headpin::scene
