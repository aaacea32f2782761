#include "apps/python/open_trial.h"

#include <filesystem>

#include <unistd.h>

#include "apps/python/errors.h"
#include "scene/stage/read_scenario.h"
#include "scene/watch/recorded.h"

namespace headpin::python {

namespace {

devices::TrialFile opened(const std::string& path) {
  try {
    return devices::TrialFile(path);
  } catch (const std::runtime_error& error) {
    std::error_code none;
    if (!std::filesystem::exists(path, none)) throw FileMissing(error.what());
    if (access(path.c_str(), R_OK) != 0) throw NotPermitted(error.what());
    throw DamagedTrial(error.what());
  }
}

}  // namespace

OpenTrial::OpenTrial(const std::string& path, Time longest_gap) : path_(path), file_(opened(path)) {
  try {
    file_.require_trial(longest_gap);
  } catch (const std::runtime_error& error) {
    throw DamagedTrial(error.what());
  }
}

const scene::Scenario& OpenTrial::scenario() {
  if (!scenario_) scenario_ = scene::scenario_of_trial(summary().header.scenario, path_);
  return *scenario_;
}

Run::Run(const OpenTrial& trial, const scene::Scenario& scenario,
         devices::TrialPlayer::Beside beside)
    : session(scene::make_session(scenario)),
      source(trial.file(), beside),
      ticks(scene::tick_count(trial.summary(), scenario.rates.physics_hz)) {
  if (trial.summary().sample_count > 0) return;
  throw DamagedTrial(trial.path() + ": expected samples of a tracker, found none");
}

void Run::go(std::span<scene::Observer* const> seen_by, const std::function<bool()>& enough) {
  Interrupts interrupts;
  scene::NoPace pace;
  scene::run(session, source, pace, seen_by, [&](const scene::Session& s) {
    interrupts.check();
    return s.tick >= ticks || (enough && enough());
  });
}

}  // namespace headpin::python
