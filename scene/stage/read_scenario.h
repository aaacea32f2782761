#pragma once

#include <string>
#include <string_view>

#include "scene/scenario/scenario.h"

/// Scenarios as they are used: read, with the files that they name, and checked.
namespace headpin::scene {

/// Reads a scenario; what the text leaves out keeps its default.
///
/// Mesh files that it names are read, from the folder of `where`; their hashes, and the corners of
/// those that collide, are part of the scenario from then on.
///
/// @param toml   the text
/// @param where  name of the file, for messages
/// @throws std::invalid_argument  naming file, line, key, what was found and what is allowed, for
///         unknown keys, wrong types, values out of range, text that is not TOML, and mesh files
///         that are none or have another hash than the one that is given
Scenario parse_scenario(std::string_view toml, std::string_view where);

/// The scenario that a trial carries, whole: a key that is missing is refused, or has the value
/// that trials ran under before there was such a key. So no default of today changes an old replay.
///
/// No mesh file is needed: what collides is in the text. Those that the eyes see are looked for
/// under their names, beside the trial, and among the program's own (seen_mesh.h).
///
/// @param trial  name of its file, for messages
/// @throws std::invalid_argument  as parse_scenario, and for a key that is missing
Scenario scenario_of_trial(std::string_view toml, std::string_view trial);

/// The text of that scenario, whole; as a file it means what the trial ran under, whatever the
/// defaults are today.
/// @throws std::invalid_argument  as scenario_of_trial
std::string whole_scenario(std::string_view toml, std::string_view trial);

/// parse_scenario() of a file, or of one that comes with the program, by its name
/// (scenario_files.h).
/// @throws std::runtime_error  where it cannot be read
Scenario load_scenario(const std::string& name_or_file);

/// Whether what stands in a scenario fits together: skittles beside each other and inside the room,
/// parts without gaps, the ball in no wall. Whatever reads a scenario has checked it.
///
/// @param where  its name, for messages
/// @throws std::invalid_argument  naming the key, what was found and what is allowed
void check(const Scenario& scenario, std::string_view where);

/// Changes one value, written as on the command line: `ball.mass=5`, `collision.shape=ellipsoid`.
///
/// @throws std::invalid_argument  as parse_scenario
void set(Scenario& scenario, std::string_view assignment);

}  // namespace headpin::scene
