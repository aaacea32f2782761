#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/command.h"
#include "scene/scenario/scenario.h"

namespace headpin::apps {

/// The options that change the condition of a recorded trial.
struct Condition {
  std::optional<double> elasticity, friction;
  std::optional<std::string> shape, response, detection;
  std::optional<std::int64_t> iterations;
  std::optional<bool> warm;
  std::optional<std::string> look;
  std::vector<std::string> set;
};

/// Adds --elasticity, --friction, --shape, --response, --detection, --iterations, --warm, --look and
/// --set.
void add_condition_options(CLI::App& command, Condition& condition);

/// --look alone.
CLI::Option* add_look(CLI::App& command, std::optional<std::string>& value);

/// Elasticity, friction and shape apply to every version of the game; `--set
/// version.red.friction=0` to one.
///
/// @throws UsageError  for a value out of range, a key that does not exist, or the material of one
///                     object where versions have one for all
void apply(const Condition& condition, scene::Scenario& scenario);

}  // namespace headpin::apps
