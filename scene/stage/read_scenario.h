#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "scene/scenario/scenario.h"

/// Reads scenarios with their files, and checks them.
namespace headpin::scene {

/// Reads a scenario; missing keys keep their default, or the value that is given for them.
///
/// Its mesh files are read, relative to the folder of `where`. The scenario then contains their
/// hashes, and the corners of colliding meshes.
///
/// @param toml   the text
/// @param where  name of the file, for messages
/// @throws std::invalid_argument  naming file, line, key, what was found and what is allowed, for
///         unknown keys, wrong types, values out of range, text that is not TOML, and mesh files
///         that are none or have another hash than the one that is given
Scenario parse_scenario(std::string_view toml, std::string_view where,
                        const Scenario& missing = {});

/// Reads the scenario of a trial, which must be complete: a missing key is refused, or gets the
/// value of trials from before the key existed. So today's defaults do not change old replays.
///
/// No mesh file is needed for collisions. Meshes that are drawn are searched at their path, next to
/// the trial, and among the bundled ones (seen_mesh.h).
///
/// @param trial  name of its file, for messages
/// @throws std::invalid_argument  as parse_scenario, and for a key that is missing
Scenario scenario_of_trial(std::string_view toml, std::string_view trial);

/// The complete text of that scenario; as a file it has the trial's values, independent of today's
/// defaults.
/// @throws std::invalid_argument  as scenario_of_trial
std::string whole_scenario(std::string_view toml, std::string_view trial);

/// parse_scenario() of a file, or of a bundled scenario by its name.
/// @throws std::runtime_error  where it cannot be read
Scenario load_scenario(const std::string& name_or_file, const Scenario& missing = {});

/// Checks that the values of a scenario fit together: skittles do not overlap and are inside the
/// room, parts have no gaps, the ball is not in a wall. All functions that read a scenario call
/// this.
///
/// @param where  its name, for messages
/// @throws std::invalid_argument  naming the key, what was found and what is allowed
void check(const Scenario& scenario, std::string_view where);

/// Changes one value, written as on the command line: `ball.mass=5`, `collision.shape=ellipsoid`.
///
/// @throws std::invalid_argument  as parse_scenario
void set(Scenario& scenario, std::string_view assignment);

/// @param where  what messages begin with in place of "ball.mass=5"
void set(Scenario& scenario, std::string_view assignment, std::string_view where);

/// One value, and what messages about it begin with.
struct Assignment {
  std::string text, where;
};
/// Changes values in their order. Only together must they fit.
/// @throws std::invalid_argument  as parse_scenario
void set(Scenario& scenario, const std::vector<Assignment>& assignments);

}  // namespace headpin::scene
