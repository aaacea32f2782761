#include "apps/info_json.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "scene/page/trouble_json.h"
#include "scene/play/outcome.h"
#include "scene/play/presence.h"
#include "scene/play/score.h"
#include "scene/record/events.h"
#include "scene/stage/read_scenario.h"
#include "scene/stage/stage.h"
#include "scene/watch/totals.h"

namespace headpin::apps {

namespace {

using nlohmann::ordered_json;

ordered_json channels_json(const scene::TrialSummary& trial) {
  ordered_json out = ordered_json::object();
  for (const auto& [name, channel] : trial.channels) {
    out[name] = {{"messages", channel.messages}, {"bytes", channel.bytes}};
  }
  return out;
}

ordered_json devices_json(const scene::TrialSummary& trial) {
  ordered_json out = ordered_json::array();
  for (const auto& [device, of] : in_order(trial)) {
    out.push_back({{"device", devices::device_name(device)},
                   {"samples", of.samples},
                   {"rate_hz", rate_hz(of)},
                   {"longest_gap_s", nearest_seconds(of.longest_gap)},
                   {"lost", of.lost},
                   {"bad", of.bad},
                   {"estimated", of.estimated},
                   {"astray", of.astray}});
  }
  return out;
}

ordered_json events_json(const scene::TrialSummary& trial) {
  ordered_json out = ordered_json::array();
  for (const scene::Event& event : trial.events) {
    out.push_back({{"time_s", nearest_seconds(event.time)},
                   {"tick", event.tick},
                   {"kind", event.kind},
                   {"bodies", event.bodies},
                   {"value", event.value},
                   {"detail", event.detail.text()}});
  }
  return out;
}

/// Adds the details of ledger and kept_pace events, each under a key with the kind of the event.
void add_details(ordered_json& out, const scene::TrialSummary& trial) {
  for (const scene::Event& event : trial.events) {
    if (event.kind != scene::kind::ledger && event.kind != scene::kind::kept_pace) continue;
    const auto detail = scene::stored_json<ordered_json>(event.detail);
    if (detail.is_object()) out[event.kind] = detail;
  }
}

ordered_json result_json(const scene::TrialSummary& trial) {
  const scene::Score r = scene::score(trial);
  const auto skittles = std::ranges::count_if(trial.header.body_names, [](const std::string& name) {
    return scene::role_named(name) == scene::Role::skittle;
  });
  ordered_json out = {{"skittles", skittles},
                      {"skittles_down", r.skittles_down},
                      {"felled_by_hand", r.felled_by_hand},
                      {"games", scene::to_json(r.games)},
                      {"throws", scene::to_json(r.throws)}};
  if (r.release_speed) out["release_speed_mps"] = *r.release_speed;
  if (r.impact_speed) out["impact_speed_mps"] = *r.impact_speed;
  out["approaches"] = scene::approaches_of(trial.events);
  const std::string why = scene::why_nothing_fell(trial.events);
  if (!why.empty()) out["why_nothing_fell"] = why;
  return out;
}

/// Adds the faults of the recording.
void add_trouble(ordered_json& out, const scene::TrialSummary& trial) {
  out["skipped"] = scene::skipped_json<ordered_json>(trial.skipped);
  out["trouble"] = scene::trouble_json<ordered_json>(trial.trouble, nearest_seconds);
  out["backwards"] = trial.backwards;
  out["late"] = trial.late;
  out["longest_gap"] = {{"from_s", nearest_seconds(trial.longest_gap.from)},
                        {"to_s", nearest_seconds(trial.longest_gap.to)}};
}

ordered_json about(const std::string& path, const scene::TrialSummary& trial) {
  ordered_json out{{"trial", path},
                   {"format_version", trial.header.format_version},
                   {"version", trial.header.software_version},
                   {"commit", trial.header.software_commit},
                   {"participant", trial.header.participant},
                   {"condition", trial.header.condition},
                   {"seed", trial.header.seed},
                   {"duration_s", nearest_seconds(duration(trial))},
                   {"complete", trial.complete},
                   {"ticks", trial.state_count},
                   {"frames", trial.frame_count},
                   {"channels", channels_json(trial)},
                   {"devices", devices_json(trial)},
                   {"events", events_json(trial)}};
  add_details(out, trial);
  if (trial.state_count > 0) out["result"] = result_json(trial);
  add_trouble(out, trial);
  return out;
}

ordered_json to_json(const std::vector<scene::ReleaseTiming>& timings) {
  ordered_json all = ordered_json::array();
  for (const scene::ReleaseTiming& t : timings) {
    all.push_back({{"time_s", nearest_seconds(t.release)},
                   {"fastest_s", nearest_seconds(t.fastest)},
                   {"fastest_mps", t.fastest_speed}});
  }
  return all;
}

}  // namespace

double rate_hz(const scene::DeviceSummary& device) {
  return device.last > device.first
             ? static_cast<double>(device.samples - 1) / seconds(device.last - device.first)
             : 0.0;
}

Time duration(const scene::TrialSummary& trial) {
  return trial.first ? *trial.last - *trial.first : Time{};
}

std::vector<std::pair<devices::Device, scene::DeviceSummary>> in_order(
    const scene::TrialSummary& trial) {
  std::vector<std::pair<devices::Device, scene::DeviceSummary>> all(trial.devices.begin(),
                                                                    trial.devices.end());
  std::stable_partition(all.begin(), all.end(),
                        [](const auto& entry) { return entry.first != devices::Device::mouse; });
  return all;
}

std::vector<scene::ReleaseTiming> timings_of(const scene::TrialFile& file,
                                             const std::string& path) {
  if (!file.summary().has_header) return {};
  try {
    return scene::release_timings(file,
                                  scene::scenario_of_trial(file.summary().header.scenario, path));
  } catch (const std::invalid_argument&) {
    return {};
  }
}

ordered_json info_json(const std::string& path, const scene::TrialFile& file) {
  ordered_json all = about(path, file.summary());
  all["releases"] = to_json(timings_of(file, path));
  return all;
}

}  // namespace headpin::apps
