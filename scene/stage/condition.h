#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scene/scenario/scenario.h"

namespace headpin::scene {

/// Another condition than the one that a trial was recorded under. What is not given stays.
struct Condition {
  std::optional<double> elasticity = {},
                        friction = {};  ///< of every object; those of a pair multiply
  std::optional<SkittleShape> shape = {};
  std::optional<std::string> response = {};
  std::optional<Detection> detection = {};
  std::optional<std::int64_t> iterations = {};
  std::optional<bool> warm = {};
  std::optional<std::string> look = {};
  std::vector<std::string> set = {};  ///< any other keys: "KEY=VALUE"
  /// What messages about these begin with; empty: `option`, and then KEY=VALUE.
  std::string where = {}, option = {};

  bool operator==(const Condition&) const = default;
};

/// Puts a scenario under the condition. Elasticity, friction and shape go to every version of the game
/// that the scenario has; `version.red.friction=0` and the like to one.
///
/// @throws std::invalid_argument  for a value out of range, a key that does not exist, or the material
///                                of one object where versions have one for all
void apply(const Condition& condition, Scenario& scenario);

/// Whether the scenario, or a version of its game, has the paper's detection.
bool has_paper_detection(const Scenario& scenario);

}  // namespace headpin::scene
