#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

/// What comes with the program: scenarios, by name.
namespace headpin::scene {

/// Where the running program is.
std::filesystem::path program_folder();

/// Where share/headpin may be, the likeliest first: beside `bin` once installed, and beside the
/// program in its build folder.
std::vector<std::filesystem::path> data_folders();

/// Names of the scenarios that are found, in order; empty where the program stands alone.
///
/// They are NAME.toml in share/headpin/scenarios, beside the running program in its build folder
/// and beside its `bin` once installed, wherever that is.
std::vector<std::string> scenario_names();

/// The file that is meant by what a user wrote.
///
/// @param name_or_file  a name when it has neither dot nor slash (`german-ninepins`); else a file,
///                      given back as it is
/// @throws std::invalid_argument  for a name that is not there, with those that are
std::string scenario_path(std::string_view name_or_file);

}  // namespace headpin::scene
