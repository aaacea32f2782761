#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/command.h"
#include "apps/condition.h"
#include "scene/record/trial.h"
#include "sweep/whatif_report.h"

namespace headpin::apps {

/// A question about the releases of a throw. Axes are "FROM:TO:STEPS" or one value.
struct WhatIfQuestion {
  std::vector<std::string> trials;  ///< the throw is one of the first trial
  int number = 1;                   ///< of the throw, from 1
  std::string option = "--throw";   ///< that gives the number, for messages
  double within_ms = 150.0, step_ms = 1.0;
  std::string speed = "0.8:1.2:9", direction = "-4:4:17", height = "-0.1:0.1:3";
  static constexpr const char* kSpin = "-10:10:3";
  std::optional<std::string> spin;  ///< by default kSpin; 0 where the ball leaves the hand at rest
  std::string board = "0", revs = "1", rotation = "0";
  std::optional<std::int64_t> success;
  bool costs = false;
  int jobs = 1;
  double longest_gap = seconds(devices::kLongestGap);
  Condition condition;
};

/// Simulates all releases, with progress on a terminal.
///
/// @param command  its name, for messages about incomplete trials; empty if these were printed
/// @throws UsageError          for an axis that is none, a throw that the trial does not have, and a spin
///   about the direction of a ball at rest
/// @throws std::runtime_error  for trials that cannot be read or have no throw, and as check_stop
sweep::WhatIf ask_what_if(const WhatIfQuestion& question, std::string_view command);

/// The answer in short: release, window, shares, costs.
nlohmann::ordered_json to_json(const sweep::WhatIf& whatif);
/// The same for people, one line each: {"window of success", "-12 to 23 ms ..."}.
std::vector<std::pair<std::string, std::string>> in_lines(const sweep::WhatIf& whatif);

}  // namespace headpin::apps
