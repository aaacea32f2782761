#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

/// Bundled scenarios, by name.
namespace headpin::scene {

/// The path of the running program.
std::filesystem::path program_folder();

/// Possible places of share/headpin, the most likely first: next to `bin` after installation, and
/// next to the program in a build folder. If another program has loaded this code as a module, its
/// places come first.
std::vector<std::filesystem::path> data_folders();

/// Names of the scenarios that are found, in order; empty where the program stands alone.
///
/// They are NAME.toml in share/headpin/scenarios, beside the running program in its build folder
/// and beside its `bin` once installed, wherever that is.
std::vector<std::string> scenario_names();

/// The file that a user means.
///
/// @param name_or_file  a name when it has neither dot nor slash (`german-ninepins`); else a file,
///                      given back as it is
/// @throws std::invalid_argument  for an unknown name, with the known ones
std::string scenario_path(std::string_view name_or_file);

}  // namespace headpin::scene
