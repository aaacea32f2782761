#pragma once

#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "devices/trial/file.h"
#include "scene/play/release_timing.h"

/// What a trial contains, as `headpin info` tells it.
namespace headpin::apps {

double rate_hz(const devices::DeviceSummary& device);

/// Time from the first to the last entry of the trial that has a time.
Time duration(const devices::TrialSummary& trial);

/// Receivers by station, then the mouse.
std::vector<std::pair<devices::Device, devices::DeviceSummary>> in_order(
    const devices::TrialSummary& trial);

/// Release timings of a trial with a complete scenario; empty otherwise.
std::vector<scene::ReleaseTiming> timings_of(const devices::TrialFile& file,
                                             const std::string& path);

/// All keys of `headpin info --json`.
nlohmann::ordered_json info_json(const std::string& path, const devices::TrialFile& file);

}  // namespace headpin::apps
