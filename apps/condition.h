#pragma once

#include <optional>
#include <string>

#include "apps/command.h"
#include "scene/stage/condition.h"

namespace headpin::apps {

using scene::Condition;

/// Adds --elasticity, --friction, --shape, --response, --detection, --iterations, --warm, --look and
/// --set.
void add_condition_options(CLI::App& command, Condition& condition);

/// --look alone.
CLI::Option* add_look(CLI::App& command, std::optional<std::string>& value);

/// As scene::apply.
/// @throws UsageError  where that throws
void apply_condition(Condition condition, scene::Scenario& scenario);

}  // namespace headpin::apps
