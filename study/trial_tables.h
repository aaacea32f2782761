#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scene/record/trial.h"

/// Reads trials back from the tables that `headpin export` writes, also after people or programs have changed
/// them.
namespace headpin::study {

/// The texts of the files; nothing for a file that is not there.
struct TrialTexts {
  std::string trackers;                         ///< trackers.csv
  std::optional<std::string> buttons, events;   ///< buttons.csv, events.csv
  std::optional<std::string> scenario, header;  ///< scenario.toml, trial.json
};

struct TablesTrial {
  scene::TrialHeader header;
  std::vector<devices::Sample> samples;  ///< in the order in which a session may use them
  std::vector<scene::Event>
      events;  ///< those outside the simulation: a replay makes the others again
  std::vector<std::string> notes;  ///< what was completed
  Time end{};                      ///< of the session; 0 if trial.json does not tell
  bool complete = true;            ///< false: the trial was not when it was exported
};

/// Whether these are names of the columns of trackers.csv: a station, a time and a pose in each row.
bool is_trackers_table(const std::string& first_line);

/// Columns are found by their names and may stand in any order. A time, a station and a pose are required;
/// other columns may be missing, and have the values of a good sample that never crossed a wire.
///
/// @param folder  of the files, for messages
/// @throws std::invalid_argument  naming file and line: what is no number, a quaternion that is no rotation, a
///                                frame that is not the transmitter's, no samples, no scenario
TablesTrial trial_of_tables(const TrialTexts& texts, const std::string& folder);

}  // namespace headpin::study
