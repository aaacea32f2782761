#pragma once

#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "scene/play/release_timing.h"
#include "scene/record/file.h"

/// What a trial contains, as `headpin info` tells it.
namespace headpin::apps {

double rate_hz(const scene::DeviceSummary& device);

/// Time from the first to the last entry of the trial that has a time.
Time duration(const scene::TrialSummary& trial);

/// Receivers by station, then the mouse.
std::vector<std::pair<devices::Device, scene::DeviceSummary>> in_order(
    const scene::TrialSummary& trial);

/// Release timings of a trial with a complete scenario; empty otherwise.
std::vector<scene::ReleaseTiming> timings_of(const scene::TrialFile& file, const std::string& path);

/// All keys of `headpin info --json`.
nlohmann::ordered_json info_json(const std::string& path, const scene::TrialFile& file);

}  // namespace headpin::apps
