#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

/// Many replays of recorded trials under many conditions.
namespace headpin::sweep {

/// Most rows of one sweep.
inline constexpr std::int64_t kMostRows = 10'000'000;

/// A key of the scenario and the values that it takes, one after the other.
struct Axis {
  std::string key;  ///< "elasticity", "ball.mass", ...
  std::vector<std::string> values;
  int line = 0;  ///< of the design's file
};

/// A key of the scenario and the range from which its values are drawn.
struct Range {
  std::string key;
  double from = 0.0, to = 1.0;
  int line = 0;
};

/// The content of sweep.toml: every combination of the grid's values, with every draw and every
/// trial.
struct Design {
  std::vector<std::string> trials;  ///< names of files, as they are written
  std::vector<Axis> grid;           ///< the last one changes fastest
  std::vector<Range> drawn;
  bool latin_hypercube = true;  ///< each range is cut into `draws` parts and each part drawn once
  std::int64_t draws = 1;       ///< for each point of the grid; 1 where nothing is drawn
  std::uint64_t seed = 1;
};

/// What a design is read for. That of a sweep which is there may have been planned before an empty table for a
/// key, and a range with steps that are the same within 12 digits, were refused.
enum class DesignOf { new_sweep, planned_sweep };

/// @param where  name of the file, for messages
/// @throws std::invalid_argument  "FILE:LINE: KEY must be EXPECTED, found FOUND"; which keys there are
///   is checked by plan()
Design parse_design(std::string_view text, const std::string& where,
                    DesignOf of = DesignOf::new_sweep);

/// Refuses a key of which other keys leave nothing: keys of a scenario go before those of options. It would
/// stand in the tables with values that no row has. For new sweeps; one that is there keeps its design.
///
/// @param versions  every row has a red and a blue version, whose values go before those for both
/// @throws std::invalid_argument  "FILE: KEY sets KEYS, ..."
void require_effects(const Design& design, bool versions, const std::string& where);

/// Trials x points of the grid x draws, at most kMostRows.
std::int64_t row_count(const Design& design);

}  // namespace headpin::sweep
