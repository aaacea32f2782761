#include "scene/watch/recorded.h"

#include <algorithm>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

#include "scene/play/game_hash.h"
#include "scene/play/player.h"
#include "scene/stage/read_scenario.h"

namespace headpin::scene {

namespace {

Recorded read(TrialFile file, const std::string& name, Time longest_gap) {
  file.require_trial(longest_gap);
  Scenario scenario = scenario_of_trial(file.summary().header.scenario, name);
  if (file.summary().sample_count == 0) {
    throw std::runtime_error(name + ": expected samples of a tracker, found none");
  }
  const std::int64_t recorded_hz = scenario.rates.physics_hz;
  return {std::move(file), std::move(scenario), recorded_hz};
}

}  // namespace

Recorded load_trial(const std::string& path, Time longest_gap) {
  return read(TrialFile(path), path, longest_gap);
}

Recorded load_trial(std::span<const std::uint8_t> bytes, const std::string& name,
                    Time longest_gap) {
  TrialFile file(bytes);
  if (file.summary().channels.empty()) {
    throw std::runtime_error(name + ": " + why_without_events(file.summary(), bytes.size()));
  }
  return read(std::move(file), name, longest_gap);
}

std::int64_t ticks_until(Time end, std::int64_t rate_hz) {
  std::int64_t ticks = std::max(Time{}, end).count() / 1'000'000 * rate_hz;
  while (tick_time(ticks, rate_hz) < end) ++ticks;
  return ticks;
}

namespace {

/// The last tick that a recording tells. That of a session may be later than its last sample; one
/// that is much later is damage.
std::int64_t last_told(const TrialSummary& trial, std::int64_t rate_hz) {
  constexpr Time kPlausible{1'000'000};
  const std::optional<SaidGameHash> said = said_game_hash(trial);
  const bool plausible = said && said->tick <= ticks_until(trial.end + kPlausible, rate_hz);
  return std::max(trial.last_tick, plausible ? said->tick : 0);
}

}  // namespace

std::int64_t tick_count(const TrialSummary& trial, std::int64_t rate_hz, std::int64_t recorded_hz) {
  const std::int64_t told = last_told(trial, recorded_hz);
  const Time end = std::max(trial.end, trial.session_end);  // longest_gap has what is between
  if (rate_hz == recorded_hz) return std::max(ticks_until(end, rate_hz), told);
  return ticks_until(std::max(end, tick_time(told, recorded_hz)), rate_hz);
}

std::int64_t tick_count(const TrialSummary& trial, std::int64_t rate_hz) {
  return tick_count(trial, rate_hz, rate_hz);
}

std::int64_t Recorded::ticks(std::int64_t rate_hz) const {
  return tick_count(file.summary(), rate_hz, recorded_hz);
}

Time end_of(const TrialSummary& trial, std::int64_t recorded_hz) {
  constexpr std::int64_t kMost = 3'000'000'000;  // s; a damaged state may have any tick
  return tick_time(std::min(tick_count(trial, recorded_hz), kMost * recorded_hz), recorded_hz);
}

std::vector<Stamped<Vec3>> walk_of(const TrialFile& trial, const Scenario& scenario) {
  std::vector<Stamped<Vec3>> walk = {{Time{}, Vec3::Zero()}};
  const std::int64_t ticks = tick_count(trial.summary(), scenario.rates.physics_hz);
  TrialPlayer source(trial);
  Player player;
  std::vector<devices::Sample> samples;
  for (std::int64_t tick = 1; tick <= ticks; ++tick) {
    const Time time = tick_time(tick, scenario.rates.physics_hz);
    const Time measured = time - microseconds(scenario.rig.delay_s);
    samples.clear();
    source.poll(time, samples);
    follow(player, samples, scenario, measured);
    forget(player, measured);
    if (player.walk.p_WP != walk.back().value) walk.push_back({time, player.walk.p_WP});
  }
  return walk;
}

std::function<std::optional<Vec3>(Time)> walk_in_time(const TrialFile& trial,
                                                      const std::string& path) {
  std::vector<Stamped<Vec3>> walk;
  try {
    walk = walk_of(trial, scenario_of_trial(trial.summary().header.scenario, path));
  } catch (const std::invalid_argument&) {  // the scenario of a damaged trial
  }
  return [walk = std::move(walk)](Time time) -> std::optional<Vec3> {
    const auto later = std::ranges::upper_bound(walk, time, {}, &Stamped<Vec3>::time);
    return later == walk.begin() ? std::nullopt : std::optional(std::prev(later)->value);
  };
}

std::int64_t first_tick_with_head(const TrialFile& trial, const Scenario& scenario) {
  const std::int64_t ticks = tick_count(trial.summary(), scenario.rates.physics_hz);
  TrialPlayer source(trial);
  Player player;
  std::vector<devices::Sample> samples;
  std::int64_t tick = 1;
  for (; tick <= ticks; ++tick) {
    const Time time = tick_time(tick, scenario.rates.physics_hz);
    samples.clear();
    source.poll(time, samples);
    follow(player, samples, scenario, time - microseconds(scenario.rig.delay_s));
    if (player.head.at(time)) break;
  }
  return tick;
}

Pose first_head_pose(const TrialFile& trial, const Rig& rig) {
  std::optional<Pose> X_WD;
  trial.walk([&](const TrialFile::Item& item) {
    const auto* sample = std::get_if<devices::Sample>(&item);
    const auto* tracker = sample ? std::get_if<devices::TrackerSample>(sample) : nullptr;
    if (tracker && tracker->station == rig.head_station && tracker->good()) {
      X_WD = sensor_in_space(*tracker, rig) * rig.X_SD;
    }
    return !X_WD;
  });
  if (X_WD) return *X_WD;
  throw std::runtime_error(
      fmt::format("expected samples of the head (station {}), found none", rig.head_station));
}

}  // namespace headpin::scene
