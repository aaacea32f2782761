#pragma once

#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "scene/record/trial.h"

namespace headpin::apps {

struct TrialPage {
  std::string trial;
  std::optional<std::string> other, output, video, page;
  std::optional<int> whatif;  ///< number of the throw whose other releases are shown
  double longest_gap = seconds(devices::kLongestGap);
  bool force = false, json = false;
};

/// Writes the page of a trial, like `headpin report`.
///
/// @return  what --json prints
/// @throws  UsageError, std::runtime_error  as `headpin report` says them
nlohmann::ordered_json write_page(const TrialPage& options);

}  // namespace headpin::apps
