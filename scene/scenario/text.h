#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "scene/scenario/scenario.h"

/// Reads the values of a scenario from text and checks each one separately. Checks of values
/// together, and reading of files, are in scene/stage/read_scenario.h.
namespace headpin::scene {

/// The line of each key in a text: "ball.mass" -> 3; "rack.spots[2]" is the second of an array.
using Lines = std::map<std::string, int>;

/// A text that a scenario is read from.
struct ScenarioText {
  std::string where;                  ///< its name, for messages
  bool one_line = false;              ///< as on the command line: messages name no line
  bool whole = false;                 ///< it must have every key, as that of a trial
  std::filesystem::path folder = {};  ///< that the files it names are from
  Lines lines = {};                   ///< of the keys it has, once it is read

  /// For messages: "lane.toml:12".
  std::string place(int line) const;
  std::string place(const std::string& key) const;
  bool has(const std::string& key) const { return lines.contains(key); }
  /// Whether it has a key of this section.
  bool names(std::string_view section) const;
};

/// Sets the values that a text has; others stay unchanged.
///
/// @throws std::invalid_argument  naming text, line, key, what was found and what is allowed, for
///         unknown keys, wrong types, values out of range, text that is not TOML, and, where it must
///         be whole, keys that are missing
void read_text(Scenario& scenario, std::string_view toml, ScenarioText& text);

/// The same for one value, as on the command line: `ball.mass=5`, `collision.shape=ellipsoid`.
void read_assignment(Scenario& scenario, std::string_view assignment, ScenarioText& text);

}  // namespace headpin::scene
